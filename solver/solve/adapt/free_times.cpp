#include "solve/adapt/free_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "solve/adapt/limits.hpp"

namespace extremal {

using namespace limits::free_times;

FreeTimes::FreeTimes(const Problem& problem, const ElementTables& tables, int elements)
    : problem_(problem), elements_(elements), times_(elements - 1 + problem.duration.free) {
  action_.reset(*problem.lagrangian, tables, elements, true, Condense::nothing);
  action_.give_momenta(problem.boundary.momenta);
  equations_.reset(problem, tables, elements);
  entries_.resize(equations_.rows().size());
  slope_.resize(times_);
}

void FreeTimes::evaluate(const Path& path) {
  equations_.evaluate(action_, path, entries_);
  equations_.evaluate_lengths(action_, path, lengths_);
  const std::vector<double>& by_length = lengths_.slope;
  for (int k = 1; k <= times_; ++k)
    slope_[k - 1] = by_length[k - 1] + (k < elements_ ? -by_length[k] : *problem_.duration.energy);
}

/// What is left of the equations, relative to the largest momentum and to that times the largest velocity.
double FreeTimes::imbalance(const Path& path, double mu) const {
  double force = 0, velocity = 0;
  for (const double g : equations_.gradient()) force = std::max(force, std::abs(g));
  for (int k = 0; k < elements_; ++k)
    for (int a = 0; a < path.coordinates(); ++a) {
      const double way = path.node(k + 1)[a] - path.node(k)[a];
      velocity = std::max(velocity, std::abs(way) / (path.lengths()[k] * path.duration()));
    }
  const double unequal = times_ > 0 ? (slope_ - mu * unequal_).cwiseAbs().maxCoeff() : 0;
  const double momentum = action_.momentum_scale();
  return momentum > 0 && velocity > 0 ? std::max(force, unequal / velocity) / momentum : 0;
}

/// In the unknowns of the path, then in times.
FreeTimes::Sparse FreeTimes::hessian() const {
  const int first = equations_.unknowns(), size = first + times_;
  std::vector<Eigen::Triplet<double>> places;
  const auto add = [&](int row, int column, double value) {
    places.emplace_back(row, column, value);
    if (row != column) places.emplace_back(column, row, value);
  };
  const auto is_unknown = [&](int k) { return k > 0 && k <= times_; };
  for (std::size_t e = 0; e < entries_.size(); ++e)
    add(equations_.rows()[e], equations_.columns()[e], entries_[e]);
  // h_k = t_{k+1} − t_k.
  for (const Triplet& entry : lengths_.entries)
    for (const int end : {0, 1})
      if (const int k = entry.column + end; is_unknown(k))
        add(entry.row, first + k - 1, end ? entry.value : -entry.value);
  for (int k = 0; k < elements_; ++k) {
    const double value = lengths_.corner[k];
    for (const int end : {k, k + 1})
      if (is_unknown(end)) add(first + end - 1, first + end - 1, value);
    if (is_unknown(k) && is_unknown(k + 1)) add(first + k - 1, first + k, -value);
  }
  Sparse matrix(size, size);
  matrix.setFromTriplets(places.begin(), places.end());
  return matrix;
}

/// Steps of the unknowns by steps δx of values at nodes that move with the path, their moves σ_k, and δT:
/// δt_k = σ_k + (t_k/T) δT, δq_k = δx_k + q' σ_k. With c the place of an inner node in its element from a to
/// b, it moves by (1 − c) σ_a + c σ_b, and its deviation from the chord changes by (1 − c)(q' − q'_a) σ_a + c
/// (q' − q'_b) σ_b.
FreeTimes::Sparse FreeTimes::moving_with(const Path& path) const {
  const int n = path.coordinates(), s = path.degree(), first = equations_.unknowns();
  const Basis& basis = lobatto_nodal_basis(s);
  std::vector<double> all(static_cast<std::size_t>(elements_) * (s + 1) * n);
  const auto slopes = [&](int k, int j) {
    return all.data() + (static_cast<std::size_t>(k) * (s + 1) + j) * n;
  };
  for (int k = 0; k < elements_; ++k) path.element_slopes(k, basis.derivative, slopes(k, 0));
  const auto at_node = [&](int k, int a) { return 0.5 * (slopes(k - 1, s)[a] + slopes(k, 0)[a]); };
  std::vector<Eigen::Triplet<double>> places;
  for (int u = 0; u < first + times_; ++u) places.emplace_back(u, u, 1);
  for (int k = 1; k < times_ && times_ == elements_; ++k)
    places.emplace_back(first + k - 1, first + elements_ - 1, path.mesh()[k]);
  for (int k = 1; k < elements_; ++k)
    for (int a = 0; a < n; ++a)
      places.emplace_back(equations_.node_unknown(k, a), first + k - 1, at_node(k, a));
  for (int k = 0; k < elements_; ++k)
    for (int j = 1; j < s; ++j)
      for (int a = 0; a < n; ++a) {
        const double c = basis.points[j], v = slopes(k, j)[a];
        const int u = equations_.inner_unknown(k, (j - 1) * n + a);
        if (k > 0) places.emplace_back(u, first + k - 1, (1 - c) * (v - at_node(k, a)));
        if (k + 1 < elements_) places.emplace_back(u, first + k, c * (v - at_node(k + 1, a)));
      }
  Sparse matrix(first + times_, first + times_);
  matrix.setFromTriplets(places.begin(), places.end());
  return matrix;
}

/// A step of Newton's method.
bool FreeTimes::solve(const Path& path, double mu) {
  if (!action_.finite()) return false;
  const Sparse moving = moving_with(path), matrix = moving.transpose() * hessian() * moving;
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int column = 0; column < matrix.cols(); ++column)
    for (Sparse::InnerIterator entry(matrix, column); entry; ++entry) {
      if (entry.row() < column) continue;
      rows.push_back(static_cast<int>(entry.row()));
      columns.push_back(column);
      values.push_back(entry.value());
    }
  matrix_.pattern(static_cast<int>(matrix.cols()), rows, columns);
  std::copy(values.begin(), values.end(), matrix_.values());
  const std::vector<double>& gradient = equations_.gradient();
  Eigen::VectorXd right(matrix.cols());
  right << -Eigen::Map<const Eigen::VectorXd>(gradient.data(), equations_.unknowns()), mu * unequal_ - slope_;
  step_ = moving.transpose() * right;
  if (!matrix_.factor()) return false;
  matrix_.solve(step_.data(), 1);
  return step_.allFinite();
}

/// False, and the path is not to be used, if an element would become too short or too long for one step.
bool FreeTimes::apply(Path& path) const {
  const int first = equations_.unknowns();
  std::vector<double> moved(elements_ + 1);  // in τ
  for (int k = 1; k < elements_; ++k) moved[k] = step_[first + k - 1] / path.duration();
  if (!path.slide(moved, most_stretch)) return false;
  if (times_ == elements_) path.set_duration(path.duration() + step_[first + times_ - 1]);
  Step step;
  equations_.expand({step_.data(), static_cast<std::size_t>(first)}, step);
  path.add(step.nodes, step.inner, 1);
  path.load_ends();
  return path.duration() > 0;
}

/// Newton's method at one μ, until steps gain nothing more.
bool FreeTimes::correct(Path& path, double mu, const std::function<bool()>& on_step) {
  evaluate(path);
  Path trial;
  for (int k = 0; k < most_steps; ++k) {
    const double before = imbalance(path, mu);
    trial = path;
    if (!solve(path, mu) || !apply(trial)) return false;
    evaluate(trial);
    const double after = action_.finite() ? imbalance(trial, mu) : INFINITY;
    if (before <= roundoff && !(after < before)) return true;
    if (!(after < worst_imbalance)) return false;
    std::swap(path, trial);
    if (!on_step()) return false;
  }
  return imbalance(path, mu) <= roundoff;
}

FreeTimes::Report FreeTimes::find(Path& path, const std::function<bool()>& on_step) {
  evaluate(path);
  unequal_ = slope_;
  if (imbalance(path, 0) <= roundoff) return {true, {}};
  const Path equal = path;
  double mu = 1;
  for (double way = 1; way >= least_way;) {
    Path trial = path;
    const double next = std::max(0.0, mu - way);
    if (correct(trial, next, on_step)) {
      std::swap(path, trial);
      mu = next;
      if (mu == 0) return {true, {}};
      way *= 2;
    } else {
      if (!on_step()) return {false, "the budget is spent before node times are found; raise solve.budget"};
      way /= 2;
    }
  }
  return {false, failure(equal, path)};
}

/// The node beside which lengths have changed most on the way.
std::string FreeTimes::failure(const Path& from, const Path& path) const {
  int node = 1;
  double most = 0;
  for (int k = 0; k < elements_; ++k) {
    const double change = std::abs(std::log(path.lengths()[k] / from.lengths()[k]));
    if (change > most) node = std::max(k, 1);
    most = std::max(most, change);
  }
  return fmt::format(
      "no node times give all elements the same discrete energy: at node {}, t = {:.6g}, the equation of its "
      "time has no solution, as where the energy error of the scheme changes its sign (often at a turning "
      "point); try fewer elements, another scheme, a shorter path, or leave steps out",
      node, path.mesh()[node] * path.duration());
}

}  // namespace extremal
