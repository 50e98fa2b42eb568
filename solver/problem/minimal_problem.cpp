#include "problem/minimal_problem.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <optional>
#include <utility>

#include "linear/dense.hpp"
#include "problem/closing.hpp"
#include "problem/limits.hpp"
#include "problem/manifold.hpp"
#include "problem/point_range.hpp"
#include "system/minimal_copies.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A problem put into the coordinates of a chart.
class InChart {
 public:
  InChart(const Problem& problem, MinimalSystem system)
      : problem_(problem),
        lagrangian_(std::move(system.lagrangian)),
        copies_(std::move(system.copies)),
        chart_(lagrangian_->chart()) {
    const int n = chart_.coordinates;
    basis_ = Eigen::Map<const RowMajor>(chart_.basis.data(), n, n);
    const RowMajor rows = inverse(basis_);
    inverse_.assign(rows.data(), rows.data() + rows.size());
    put_points();
  }

  std::shared_ptr<const MinimalProblem> run(double most_stretch) {
    if (problem_.extension || problem_.inequalities || problem_.infinite || problem_.phase ||
        problem_.duration.where)
      return nullptr;
    MinimalProblem minimal;
    Problem& u = minimal.problem;
    u.lagrangian = lagrangian_;
    u.copies = copies_;
    u.periodic = problem_.periodic;
    u.duration = problem_.duration;
    if (!put_ends(u) || !put_guess(minimal) || !(minimal.stretch <= most_stretch)) return nullptr;
    put_tolerance(minimal);
    try {
      u = make_problem(std::move(u));
    } catch (const std::exception&) {
      return nullptr;
    }
    if (symmetries_of(u) != symmetries_of(problem_)) return nullptr;
    return finished(std::move(minimal));
  }

  std::shared_ptr<const MinimalProblem> run_like(const MinimalProblem& other) {
    MinimalProblem minimal;
    Problem& u = minimal.problem;
    u = other.problem;
    u.lagrangian = lagrangian_;
    u.copies = copies_;
    u.pair = nullptr;
    u.boundary = {};
    u.duration = problem_.duration;
    if (!put_ends(u)) return nullptr;
    try {
      u.ends = solve_relation(u.boundary);
    } catch (const RelationError&) {
      return nullptr;
    }
    minimal.stretch = other.stretch;
    return finished(std::move(minimal));
  }

 private:
  static std::size_t symmetries_of(const Problem& problem) {
    return (problem.pair ? *problem.pair : problem).symmetries.size();
  }

  std::shared_ptr<const MinimalProblem> finished(MinimalProblem minimal) const {
    minimal.lagrangian = lagrangian_;
    minimal.whole = problem_.lagrangian;
    minimal.boundary = problem_.boundary;
    minimal.duration = problem_.duration;
    minimal.guess = problem_.guess;
    return std::make_shared<const MinimalProblem>(std::move(minimal));
  }

  using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

  std::vector<double> in_chart(const double* q, std::span<const double> near) const {
    return chart_.coordinates_of(inverse_, {q, static_cast<std::size_t>(chart_.coordinates)}, near);
  }

  /// The guess, or where a motion starts: angles go on from point to point.
  void put_points() {
    const std::size_t n = chart_.coordinates, samples = problem_.initial ? 1 : problem_.guess.tau.size();
    const double* points = problem_.initial ? problem_.initial->q.data() : problem_.guess.q.data();
    for (std::size_t k = 0; k < samples; ++k)
      points_.push_back(in_chart(points + k * n, k > 0 ? points_.back() : std::vector<double>()));
  }
  const std::vector<double>& near(int end) const { return end ? points_.back() : points_.front(); }

  /// ∂q/∂y at an end of the guess.
  MatrixXd slopes_at(int end) const {
    const std::vector<double> rows = chart_.slopes(near(end));
    return Eigen::Map<const RowMajor>(rows.data(), chart_.coordinates, chart_.coordinates);
  }

  /// Ends that are fixed, free or closed as they are.
  bool put_ends(Problem& u) const {
    const BoundaryRelation& boundary = problem_.boundary;
    u.boundary.coordinates = chart_.free;
    if (!boundary.costs.empty()) return false;
    if (std::ranges::any_of(boundary.momenta, [](double p) { return p != 0; })) return false;
    if (problem_.initial) return put_initial(u);
    if (problem_.periodic) return put_closing(u);
    put_fixed_ends(u);
    return put_relation(u);
  }

  /// u(T) = R u(0) + c. Then w closes too: both ends are in the chart.
  bool put_closing(Problem& u) const {
    const int d = chart_.free;
    std::optional<ClosingMap> map = closing_in_chart();
    if (!map || !small(map->r.topRightCorner(d, lagrangian_->constraints()), 1)) return false;
    for (int a = 0; a < d; ++a) {
      const int row = u.boundary.add_row(map->c[a]);
      u.boundary.add(row, d + a, 1);
      for (int b = 0; b < d; ++b)
        if (!small(map->r.block(a, b, 1, 1), 1)) u.boundary.add(row, b, -map->r(a, b));
    }
    return true;
  }

  /// The map in y: polar pairs are turned or reflected as they are, or become others. Nothing for other maps.
  std::optional<ClosingMap> closing_in_chart() const {
    const int n = chart_.coordinates;
    const ClosingMap in_q = closing_map(problem_);
    const MatrixXd to_z = Eigen::Map<const RowMajor>(inverse_.data(), n, n);
    ClosingMap map{to_z * in_q.r * basis_, to_z * in_q.c};
    const MatrixXd r = map.r;
    std::vector<char> paired(n);
    for (const Polar& p : chart_.polar) paired[p.angle] = paired[p.radius] = 1;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        if (paired[b] && !paired[a] && !small(r.block(a, b, 1, 1), 1)) return std::nullopt;
    for (const Polar& p : chart_.polar) {
      const Polar* const from = source(r, p);
      if (!from || !close_pair(p, *from, r, map)) return std::nullopt;
    }
    return map;
  }

  /// The one pair that this one is made of.
  const Polar* source(const MatrixXd& r, const Polar& p) const {
    for (const Polar& from : chart_.polar) {
      MatrixXd rest(2, chart_.coordinates);
      rest << r.row(p.angle), r.row(p.radius);
      rest.col(from.angle).setZero();
      rest.col(from.radius).setZero();
      if (small(rest, 1)) return &from;
    }
    return nullptr;
  }

  /// φ(T) = ±φ(0) + α, with the turns of the guess.
  bool close_pair(const Polar& p, const Polar& from, const MatrixXd& r, ClosingMap& map) const {
    Eigen::Matrix2d m;
    m << r(p.angle, from.angle), r(p.angle, from.radius), r(p.radius, from.angle), r(p.radius, from.radius);
    const Eigen::Vector2d centre = m * Eigen::Vector2d(from.x, from.y) +
                                   Eigen::Vector2d(map.c[p.angle], map.c[p.radius]) -
                                   Eigen::Vector2d(p.x, p.y);
    const double size = 1 + std::abs(p.x) + std::abs(p.y);
    if (!small(m.transpose() * m - Eigen::Matrix2d::Identity(), 1) || !small(centre, size)) return false;
    const double sign = m.determinant() > 0 ? 1 : -1, whole = 2 * std::numbers::pi;
    const double turned = near(1)[p.angle] / p.unit - sign * near(0)[from.angle] / from.unit;
    double angle = std::atan2(m(1, 0), m(0, 0));
    angle += whole * std::round((turned - angle) / whole);
    map.r.row(p.angle).setZero();
    map.r.row(p.radius).setZero();
    map.r(p.angle, from.angle) = sign * p.unit / from.unit;
    map.r(p.radius, from.radius) = 1;
    map.c[p.angle] = p.unit * angle;
    map.c[p.radius] = 0;
    return true;
  }

  static bool small(const MatrixXd& m, double size) {
    return m.size() == 0 || m.cwiseAbs().maxCoeff() <= limits::minimal::roundoff * size;
  }

  bool fixed(int end) const { return problem_.ends.fixes(end == 1); }

  void put_fixed_ends(Problem& u) const {
    for (const int end : {0, 1}) {
      if (!fixed(end)) continue;
      const std::vector<double> x =
          in_chart(problem_.ends.offset.data() + end * chart_.coordinates, near(end));
      for (int a = 0; a < chart_.free; ++a) u.boundary.fix(a, end == 1, x[a]);
    }
  }

  /// What the other ends satisfy, as far as it is a relation of u; the rest must follow from that.
  bool put_relation(Problem& u) const {
    const BoundaryRelation& given = problem_.boundary;
    const int n = chart_.coordinates, d = chart_.free, m = n - d;
    MatrixXd rows = MatrixXd::Zero(given.rows, 2 * n);
    for (const Triplet& entry : given.matrix) rows(entry.row, entry.column) += entry.value;
    VectorXd value = Eigen::Map<const VectorXd>(given.value.data(), given.rows);
    for (const int end : {0, 1}) {
      auto part = rows.middleCols(end * n, n);
      if (fixed(end)) {
        value -= part * Eigen::Map<const VectorXd>(problem_.ends.offset.data() + end * n, n);
        part.setZero();
      }
      part *= basis_;
    }
    std::vector<int> left;
    MatrixXd kept(0, 2 * d);
    for (int k = 0; k < given.rows; ++k) {
      const double size = rows.row(k).cwiseAbs().maxCoeff();
      if (size == 0) continue;
      if (reads_angles(rows.row(k), size) || !small(rows.block(k, d, 1, m), size) ||
          !small(rows.block(k, n + d, 1, m), size)) {
        left.push_back(k);
        continue;
      }
      const int row = u.boundary.add_row(value[k]);
      kept.conservativeResize(kept.rows() + 1, 2 * d);
      kept.row(kept.rows() - 1) << rows.block(k, 0, 1, d), rows.block(k, n, 1, d);
      for (int e = 0; e < 2 * d; ++e)
        if (const double c = kept(kept.rows() - 1, e); !small(MatrixXd::Constant(1, 1, c), size))
          u.boundary.add(row, e, c);
    }
    return left.empty() || follow(rows(left, Eigen::all), kept);
  }

  /// Whether a row by z of both ends has a part in planes of polar coordinates.
  bool reads_angles(const MatrixXd& row, double size) const {
    const int n = chart_.coordinates;
    return std::ranges::any_of(chart_.polar, [&](const Polar& p) {
      return !small(row(0, {p.angle, p.radius, n + p.angle, n + p.radius}), size);
    });
  }

  /// Whether rows by z of both ends vanish on displacements along the manifold that others leave.
  bool follow(const MatrixXd& rows, const MatrixXd& kept) const {
    const int n = chart_.coordinates, d = chart_.free, m = n - d;
    MatrixXd by_u = MatrixXd::Zero(rows.rows(), 2 * d);
    for (const int end : {0, 1}) {
      if (fixed(end)) continue;
      const Guess& guess = problem_.guess;
      const std::span<const double> q(guess.q.data() + (end ? guess.q.size() - n : 0), n);
      const MatrixXd by_y = slopes_at(end), to_z = solved(basis_, by_y);
      const MatrixXd slopes = problem_.manifold->at(q, end ? problem_.duration.value : 0).slopes * by_y;
      const MatrixXd of_w = -solved(slopes.rightCols(m), slopes.leftCols(d));
      const MatrixXd by_end = rows.middleCols(end * n, n) * to_z;
      by_u.middleCols(end * d, d) = by_end.leftCols(d) + by_end.rightCols(m) * of_w;
    }
    MatrixXd rest = by_u;
    if (kept.rows() > 0) {
      const SingularValues parts = singular_value_decomposition(kept);
      const Index rank = (parts.values.array() > limits::minimal::roundoff).count();
      rest = by_u * parts.v.rightCols(2 * d - rank);
    }
    return rest.size() == 0 || rest.cwiseAbs().maxCoeff() <= limits::minimal::same_point;
  }

  /// p of u is the part of p along the manifold.
  bool put_initial(Problem& u) const {
    const int d = chart_.free, m = lagrangian_->constraints();
    const InitialData& given = *problem_.initial;
    const std::vector<double>& x = near(0);
    for (int a = 0; a < d; ++a) u.boundary.fix(a, false, x[a]);
    const MatrixXd by_y = slopes_at(0), slopes = problem_.manifold->at(given.q, 0).slopes * by_y;
    const VectorXd p = by_y.transpose() * Eigen::Map<const VectorXd>(given.p.data(), d + m);
    const VectorXd by_u =
        p.head(d) - slopes.leftCols(d).transpose() * solved(slopes.rightCols(m).transpose(), p.tail(m));
    u.initial = InitialData{{x.begin(), x.begin() + d}, {by_u.begin(), by_u.end()}, false};
    return by_u.allFinite();
  }

  /// The guess, if the chart has it: its points must be those that are found from u.
  bool put_guess(MinimalProblem& minimal) const {
    const Guess& guess = problem_.guess;
    const std::size_t n = chart_.coordinates, d = chart_.free, samples = points_.size();
    const double* points = problem_.initial ? problem_.initial->q.data() : guess.q.data();
    std::vector<double> u, t;
    double size = 0;
    for (std::size_t k = 0; k < samples; ++k) {
      u.insert(u.end(), points_[k].begin(), points_[k].begin() + static_cast<std::ptrdiff_t>(d));
      t.push_back(problem_.initial ? 0 : guess.tau[k] * problem_.duration.value);
      for (std::size_t a = 0; a < n; ++a) size = std::max(size, std::abs(points[k * n + a]));
    }
    const MinimalLagrangian::Lifted back = lagrangian_->lift(u, {}, t);
    for (std::size_t e = 0; e < samples * n; ++e)
      if (!(std::abs(back.q[e] - points[e]) <= limits::minimal::same_point * size)) return false;
    minimal.stretch = std::max(1.0, *std::ranges::max_element(back.stretch));
    if (!problem_.initial) minimal.problem.guess = {guess.tau, std::move(u), guess.samples_a_step};
    return true;
  }

  /// The tolerance is relative to the largest range: u may go on where q returns.
  void put_tolerance(MinimalProblem& minimal) const {
    if (problem_.initial) return;
    const double range = largest_range(problem_.guess.q, chart_.coordinates);
    const double of_u = largest_range(minimal.problem.guess.q, chart_.free);
    if (range > 0) minimal.stretch *= std::max(1.0, of_u / range);
  }

  const Problem& problem_;
  std::shared_ptr<const MinimalLagrangian> lagrangian_;
  std::shared_ptr<const Lagrangian> copies_;
  const Chart& chart_;
  MatrixXd basis_;
  std::vector<double> inverse_;              ///< of the basis, row-major
  std::vector<std::vector<double>> points_;  ///< y along the guess
};

bool same(const BoundaryRelation& a, const BoundaryRelation& b) {
  const auto equal = [](const Triplet& x, const Triplet& y) {
    return x.row == y.row && x.column == y.column && x.value == y.value;
  };
  return a.value == b.value && a.momenta == b.momenta && a.costs.size() == b.costs.size() &&
         std::ranges::equal(a.matrix, b.matrix, equal);
}

}  // namespace

LiftedPoints lifted(const MinimalProblem& minimal, std::span<const double> u, std::span<const double> du,
                    std::span<const double> t) {
  MinimalLagrangian::Lifted points = minimal.lagrangian->lift(u, du, t);
  return {std::move(points.q), std::move(points.v), std::move(points.stretch)};
}

std::vector<double> covector(const MinimalProblem& minimal, std::span<const double> q,
                             std::span<const double> p) {
  const Chart& chart = minimal.lagrangian->chart();
  const Index n = chart.coordinates;
  const MatrixXd back = inverse(Eigen::Map<const MatrixXd>(chart.basis.data(), n, n));  // of the transpose
  const std::vector<double> y = chart.coordinates_of({back.data(), static_cast<std::size_t>(n * n)}, q, {});
  VectorXd all = VectorXd::Zero(n);
  std::ranges::copy(p, all.begin());
  const std::vector<double> slopes = chart.slopes(y);
  const Eigen::Map<const MatrixXd> transposed(slopes.data(), n, n);
  const VectorXd found = solved(transposed, all);
  return {found.begin(), found.end()};
}

bool describes(const MinimalProblem& minimal, const Problem& problem) {
  const Duration &own = minimal.duration, &other = problem.duration;
  return minimal.whole == problem.lagrangian && own.value == other.value && own.free == other.free &&
         own.energy == other.energy && !other.where && same(minimal.boundary, problem.boundary) &&
         minimal.guess.tau == problem.guess.tau && minimal.guess.q == problem.guess.q;
}

std::shared_ptr<const MinimalProblem> minimal_problem(const Problem& problem, MinimalSystem system,
                                                      double most_stretch) {
  return InChart(problem, std::move(system)).run(most_stretch);
}

std::shared_ptr<const MinimalProblem> minimal_problem_like(const MinimalProblem& other, Problem problem,
                                                           MinimalSystem system) {
  problem.guess = other.guess;
  return InChart(problem, std::move(system)).run_like(other);
}

}  // namespace extremal
