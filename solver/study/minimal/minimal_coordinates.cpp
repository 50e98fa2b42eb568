#include "study/minimal/minimal_coordinates.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "study/checks/checks.hpp"
#include "study/checks/regularity.hpp"
#include "study/constraints/limits.hpp"
#include "study/minimal/limits.hpp"
#include "study/minimal/polar_frames.hpp"
#include "study/model/modelling.hpp"
#include "system/minimal_copies.hpp"

namespace extremal {
namespace {

using namespace limits::charts;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A chart of the frame q.
Chart chart_of(const Frame& frame) {
  Chart chart;
  const Index n = frame.basis.rows();
  chart.coordinates = static_cast<int>(n);
  for (Index a = 0; a < n; ++a)
    for (Index b = 0; b < n; ++b) chart.basis.push_back(frame.basis(a, b));
  chart.polar = frame.polar;
  return chart;
}

/// The guess between the ends, in whose place fixed ones come, or the point from which a motion starts.
PathPoints points_of(const Problem& problem) {
  PathPoints path;
  const Index n = problem.coordinates();
  if (problem.initial) {
    path.q.emplace_back(Eigen::Map<const VectorXd>(problem.initial->q.data(), n));
    path.times.push_back(0);
    return path;
  }
  const Guess& guess = problem.guess;
  for (std::size_t k = 0; k < guess.tau.size(); ++k) {
    path.q.emplace_back(Eigen::Map<const VectorXd>(guess.q.data() + k * n, n));
    path.times.push_back(guess.tau[k] * problem.duration.value);
  }
  for (const bool at_end : {false, true})
    if (problem.ends.fixes(at_end))
      (at_end ? path.q.back() : path.q.front()) =
          Eigen::Map<const VectorXd>(problem.ends.offset.data() + (at_end ? n : 0), n);
  return path;
}

struct ChosenChart {
  Chart chart;
  double quality;
};

/// Chooses coordinates of the manifold along a guess among those of a frame. All is measured in z scaled by
/// the masses.
class ChartChoice {
 public:
  ChartChoice(const Problem& problem, const PathPoints& path, const Frame& frame)
      : manifold_(*problem.manifold),
        frame_(frame),
        n_(manifold_.coordinates()),
        m_(manifold_.constraints()),
        d_(n_ - m_) {
    const Chart whole = chart_of(frame);
    const MatrixXd by_q = inverse(frame.basis).transpose();
    std::vector<double> near;
    for (const VectorXd& q : path.q) {
      near = whole.coordinates_of({by_q.data(), static_cast<std::size_t>(n_ * n_)}, values_of(q), near);
      all_.push_back(near);
    }
    scale_ = manifold_.metric().diagonal().cwiseSqrt();
    const std::size_t last = path.q.size() - 1, steps = std::min<std::size_t>(last, samples - 1);
    std::vector<std::size_t> taken;
    for (std::size_t i = 0; i <= steps; ++i) taken.push_back(steps ? i * last / steps : 0);
    if (!frame.polar.empty()) scale_ = scale_of(whole, taken);
    for (const std::size_t k : taken) look(whole, path, k);
    if (!problem.periodic && !problem.initial) require_fixed(problem);
  }

  std::optional<ChosenChart> run() {
    if (tangents_.empty() || std::ranges::any_of(tangents_, [](const auto& t) { return t.size() == 0; }))
      return std::nullopt;
    Candidate best = best_subset();
    if (frame_.polar.empty() && best.quality < turned_below && required_.empty())
      if (Candidate turned = principal(); turned.quality > better * best.quality) best = std::move(turned);
    if (best.quality < least_quality) return std::nullopt;
    return factored(best);
  }

 private:
  /// Orthonormal columns of u and of w, in scaled coordinates; quality: the smallest sine at which tangent
  /// spaces meet those of w.
  struct Candidate {
    MatrixXd u, w;
    double quality = 0;
    bool turned = false;
  };

  static std::vector<double> values_of(const VectorXd& q) { return {q.begin(), q.end()}; }

  /// Lengths of z that the masses move like those of q.
  VectorXd scale_of(const Chart& whole, const std::vector<std::size_t>& taken) const {
    VectorXd lengths = VectorXd::Zero(n_);
    for (const std::size_t k : taken) {
      const std::vector<double> rows = whole.slopes(all_[k]);
      const Eigen::Map<const MatrixXd> transposed(rows.data(), n_, n_);
      lengths += (transposed * scale_.cwiseInverse().asDiagonal()).rowwise().norm();
    }
    return static_cast<double>(taken.size()) * lengths.cwiseInverse();
  }

  void look(const Chart& whole, const PathPoints& path, std::size_t k) {
    const ConstraintValues values = manifold_.at(values_of(path.q[k]), path.times[k]);
    times_.push_back(path.times[k]);
    points_.emplace_back(Eigen::Map<const VectorXd>(all_[k].data(), n_));
    const std::vector<double> rows = whole.slopes(all_[k]);
    const MatrixXd by_z = Eigen::Map<const MatrixXd>(rows.data(), n_, n_).transpose();
    slopes_.push_back(values.slopes * by_z * scale_.asDiagonal());
    const SingularValues parts = singular_value_decomposition(slopes_.back());
    const bool regular = parts.values[m_ - 1] > limits::constraints::rank * parts.values[0];
    tangents_.push_back(regular ? parts.v.rightCols(d_) : MatrixXd());
  }

  /// The coordinate of z that is this one of q; −1 where none is.
  int in_frame(int coordinate) const {
    if (frame_.polar.empty()) return coordinate;
    const MatrixXd by_q = inverse(frame_.basis);
    for (Index b = 2 * std::ssize(frame_.polar); b < n_; ++b)
      if ((by_q.row(b) - VectorXd::Unit(n_, coordinate).transpose()).norm() < structural)
        return static_cast<int>(b);
    return -1;
  }

  /// What relations of an end read that they do not fix wholly is to be among u, as far as it is independent.
  void require_fixed(const Problem& problem) {
    for (const int end : {0, 1}) {
      if (problem.ends.fixes(end == 1)) continue;
      const MatrixXd& tangent = end ? tangents_.back() : tangents_.front();
      if (tangent.size() == 0) continue;
      for (const Triplet& entry : problem.boundary.matrix) {
        const int of_q = entry.column - end * static_cast<int>(n_);
        if (of_q < 0 || of_q >= n_) continue;
        const int a = in_frame(of_q);
        if (a < 0 || std::ranges::find(required_, a) != required_.end()) continue;
        std::vector<int> more = required_;
        more.push_back(a);
        const auto count = static_cast<Index>(more.size());
        if (count > d_) continue;
        const MatrixXd rows = tangent(more, Eigen::all);
        if (singular_values(rows)[count - 1] > least_quality) required_ = std::move(more);
      }
    }
  }

  double quality(const MatrixXd& u) const {
    double least = 1;
    for (const MatrixXd& tangent : tangents_)
      least = std::min(least, singular_values(u.transpose() * tangent)[d_ - 1]);
    return least;
  }

  /// Some of the coordinates: those that pivoting takes at some point, or on the mean.
  Candidate best_subset() const {
    Candidate best;
    const auto consider = [&](MatrixXd rows) {  // d × n
      for (const int a : required_) rows.col(a) *= 1e3;
      const Eigen::ColPivHouseholderQR<MatrixXd> pivoted(rows);
      std::vector<char> taken(n_);
      for (Index j = 0; j < d_; ++j) taken[pivoted.colsPermutation().indices()[j]] = 1;
      Candidate found{MatrixXd::Zero(n_, d_), MatrixXd::Zero(n_, m_)};
      for (Index a = 0, j = 0, l = 0; a < n_; ++a) (taken[a] ? found.u(a, j++) : found.w(a, l++)) = 1;
      found.quality = quality(found.u);
      if (found.quality > best.quality) best = std::move(found);
    };
    const std::size_t last = tangents_.size() - 1;
    for (const std::size_t k : {last / 2, std::size_t{0}, last, last / 4, 3 * last / 4})
      consider(tangents_[k].transpose());
    consider(mean_directions().transpose());
    return best;
  }

  /// The d directions that tangent spaces have most in common.
  MatrixXd mean_directions() const { return symmetric_eigen(mean_projector()).vectors.rightCols(d_); }
  MatrixXd mean_projector() const {
    MatrixXd sum = MatrixXd::Zero(n_, n_);
    for (const MatrixXd& tangent : tangents_) sum += tangent * tangent.transpose();
    return sum;
  }

  Candidate principal() const {
    const MatrixXd vectors = symmetric_eigen(mean_projector()).vectors;
    Candidate found{vectors.rightCols(d_), vectors.leftCols(m_)};
    found.quality = quality(found.u);
    found.turned = true;
    return found;
  }

  /// A = ∂g/∂w is factored without pivoting in the order that suits the middle of the guess, if that holds
  /// everywhere.
  std::optional<ChosenChart> factored(const Candidate& choice) const {
    const std::size_t middle = tangents_.size() / 2;
    MatrixXd pattern = MatrixXd::Zero(m_, m_);
    std::vector<MatrixXd> all;
    for (const MatrixXd& slopes : slopes_) {
      all.push_back(slopes * choice.w);
      for (Index k = 0; k < m_; ++k) all.back().row(k) /= slopes.row(k).norm();
      pattern = pattern.cwiseMax(all.back().cwiseAbs());
    }
    std::vector<int> rows, columns;
    if (!order_pivots(all[middle], pattern, rows, columns)) return std::nullopt;
    std::vector<double> signs;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const VectorXd pivots = pivots_of(all[k], rows, columns);
      if (k == 0)
        for (Index l = 0; l < m_; ++l) signs.push_back(pivots[l] > 0 ? 1 : -1);
      for (Index l = 0; l < m_; ++l)
        if (!(signs[l] * pivots[l] > least_pivot)) return std::nullopt;
    }
    return ChosenChart{chosen(choice, rows, columns, std::move(signs), middle), choice.quality};
  }

  /// Markowitz's choice among pivots that are not small.
  bool order_pivots(MatrixXd a, MatrixXd pattern, std::vector<int>& rows, std::vector<int>& columns) const {
    std::vector<char> row_done(m_), column_done(m_);
    const auto filled = [&](Index i, Index j) { return pattern(i, j) > structural; };
    for (Index step = 0; step < m_; ++step) {
      double largest = 0;
      for (Index i = 0; i < m_; ++i)
        for (Index j = 0; j < m_; ++j)
          if (!row_done[i] && !column_done[j]) largest = std::max(largest, std::abs(a(i, j)));
      Index row = -1, column = -1, cheapest = 0;
      for (Index i = 0; i < m_; ++i)
        for (Index j = 0; j < m_; ++j) {
          if (row_done[i] || column_done[j] || std::abs(a(i, j)) < threshold * largest) continue;
          Index in_row = 0, in_column = 0;
          for (Index k = 0; k < m_; ++k) {
            in_row += !column_done[k] && filled(i, k);
            in_column += !row_done[k] && filled(k, j);
          }
          const Index cost = (in_row - 1) * (in_column - 1);
          const bool cheaper = row < 0 || cost < cheapest;
          if (!cheaper && !(cost == cheapest && std::abs(a(i, j)) > std::abs(a(row, column)))) continue;
          row = i;
          column = j;
          cheapest = cost;
        }
      if (row < 0 || !(std::abs(a(row, column)) > 0)) return false;
      rows.push_back(static_cast<int>(row));
      columns.push_back(static_cast<int>(column));
      row_done[row] = column_done[column] = 1;
      for (Index i = 0; i < m_; ++i) {
        if (row_done[i] || !filled(i, column)) continue;
        const double factor = a(i, column) / a(row, column);
        for (Index j = 0; j < m_; ++j)
          if (!column_done[j] && filled(row, j)) {
            a(i, j) -= factor * a(row, j);
            pattern(i, j) = std::max(pattern(i, j), 1.0);
          }
      }
    }
    return true;
  }

  VectorXd pivots_of(const MatrixXd& a, const std::vector<int>& rows, const std::vector<int>& columns) const {
    MatrixXd lu = a(rows, columns);
    for (Index k = 0; k < m_; ++k)
      for (Index i = k + 1; i < m_; ++i) {
        lu(i, k) /= lu(k, k);
        lu.row(i).tail(m_ - k - 1) -= lu(i, k) * lu.row(k).tail(m_ - k - 1);
      }
    return lu.diagonal();
  }

  /// Coordinates that are not turned keep their units.
  Chart chosen(const Candidate& choice, const std::vector<int>& rows, const std::vector<int>& columns,
               std::vector<double> signs, std::size_t middle) const {
    MatrixXd order(n_, n_);
    order << choice.u, choice.w(Eigen::all, columns);
    if (choice.turned) order = scale_.asDiagonal() * order * (1 / scale_.mean());
    Chart chart = chart_of({frame_.basis * order, frame_.polar});
    const auto moved = [&](int b) {
      Index at = 0;
      order.row(b).maxCoeff(&at);
      return static_cast<int>(at);
    };
    for (Polar& pair : chart.polar) {
      pair.angle = moved(pair.angle);
      pair.radius = moved(pair.radius);
    }
    chart.free = static_cast<int>(d_);
    chart.order = rows;
    chart.signs = std::move(signs);
    const VectorXd y = solved(order, points_[middle]);
    chart.point.assign(y.begin(), y.end());
    chart.time = times_[middle];
    for (const VectorXd& z : points_) chart.size = std::max(chart.size, z.lpNorm<Eigen::Infinity>());
    if (!chart.polar.empty()) fit_start(order, chart);
    return chart;
  }

  /// Least squares over the guess, where it has places enough.
  void fit_start(const MatrixXd& order, Chart& chart) const {
    const Index features = chart.features(), places = std::ssize(all_);
    if (places < limits::polar::places_each * features) return;
    MatrixXd by(places, features), w(places, m_);
    VectorXd row(features);
    for (Index k = 0; k < places; ++k) {
      const VectorXd y = order.transpose() * Eigen::Map<const VectorXd>(all_[k].data(), n_);
      chart.put_features({y.data(), static_cast<std::size_t>(d_)},
                         {row.data(), static_cast<std::size_t>(features)});
      by.row(k) = row.transpose();
      w.row(k) = y.tail(m_).transpose();
    }
    // What is left beside the means.
    const VectorXd mean = by.colwise().mean(), mean_w = w.colwise().mean();
    const MatrixXd left = (by.rowwise() - mean.transpose()).rightCols(features - 1);
    const MatrixXd slopes = least_norm(left, w.rowwise() - mean_w.transpose(), limits::polar::fitted_rank);
    for (Index l = 0; l < m_; ++l) {
      chart.start.push_back(mean_w[l] - mean.tail(features - 1).dot(slopes.col(l)));
      for (Index i = 0; i + 1 < features; ++i) chart.start.push_back(slopes(i, l));
    }
  }

  const Manifold& manifold_;
  const Frame& frame_;
  const Index n_, m_, d_;
  VectorXd scale_;
  std::vector<std::vector<double>> all_;  ///< z along the guess
  std::vector<VectorXd> points_;
  std::vector<double> times_;
  std::vector<int> required_;                ///< coordinates that are to be among u
  std::vector<MatrixXd> slopes_, tangents_;  ///< m × n and n × d, scaled; the latter empty where gradients
                                             ///< depend on each other
};

}  // namespace

void put_minimal_coordinates(const SystemTable& table, const System& system, bool only, Problem& problem) {
  if (!problem.manifold || (!problem.initial && !problem.guess.given())) return;
  const ConstrainedGraph graph = make_constrained(table, system);
  const auto kinked = [&](NodeId f) { return has_kinks(graph.graph, f); };
  if (kinked(graph.lagrangian) || std::ranges::any_of(graph.forces, kinked)) return;
  const PathPoints path = points_of(problem);
  std::vector<ChosenChart> charts;
  const auto choose = [&](const Frame& frame) {
    std::optional<ChosenChart> chart = ChartChoice(problem, path, frame).run();
    if (!chart) return;
    if (frame.spatial) chart->quality *= worth_of_spatial;
    charts.push_back(*std::move(chart));
  };
  for (const Frame& frame : polar_frames(*problem.manifold, path)) choose(frame);
  const Index n = problem.coordinates();
  choose({MatrixXd::Identity(n, n), {}});
  std::ranges::stable_sort(charts, std::greater(), &ChosenChart::quality);
  // Extremals between free ends may be a family by a symmetry, which is found where it is affine in u.
  const bool families = problem.ends.free > 0 && !problem.periodic && !problem.initial;
  std::shared_ptr<const MinimalProblem> best;
  std::vector<std::shared_ptr<const MinimalProblem>> others;
  std::size_t most = 0;
  const auto look = [&](const ChosenChart& chosen, double stretch) {
    auto minimal = minimal_problem(problem, minimal_system(graph, chosen.chart), stretch);
    if (!minimal) return;
    const std::size_t found = families ? continuous_symmetries(minimal->problem).size() : 0;
    if (best && found <= most) return others.push_back(std::move(minimal));
    if (best) others.push_back(std::move(best));
    best = std::move(minimal);
    most = found;
  };
  for (const ChosenChart& chosen : charts)
    if (families || std::ssize(others) < most_others) look(chosen, most_stretch);
  // Angles of rods that hang on each other move all that hangs on them.
  for (const ChosenChart& chosen : charts)
    if (const auto pairs = std::ssize(chosen.chart.polar); !best && pairs > 1)
      look(chosen, most_stretch * static_cast<double>(pairs));
  if (!best) return;
  // Each with the next ones, the last one first.
  std::shared_ptr<const MinimalProblem> next;
  others.resize(std::min<std::size_t>(others.size(), most_others));
  others.insert(others.begin(), std::move(best));
  std::ranges::reverse(others);
  for (const auto& chart : others) {
    MinimalProblem linked = *chart;
    linked.next = std::move(next);
    next = std::make_shared<const MinimalProblem>(std::move(linked));
  }
  Manifold::Parts parts = problem.manifold->parts();
  parts.only_minimal = only;
  parts.minimal = std::move(next);
  problem.manifold = std::make_shared<const Manifold>(std::move(parts));
}

bool has_regular_chart(const Problem& problem) {
  const std::shared_ptr<const MinimalProblem>& minimal = problem.manifold->parts().minimal;
  return minimal && is_regular(minimal->problem) && is_finite_on_guess(minimal->problem);
}

}  // namespace extremal
