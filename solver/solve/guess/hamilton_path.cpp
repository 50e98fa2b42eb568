#include "solve/guess/hamilton_path.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "action/rule.hpp"
#include "problem/phase_space.hpp"
#include "problem/point_range.hpp"
#include "solve/guess/limits.hpp"
#include "solve/periodic/equilibrium.hpp"

namespace extremal {

using namespace limits::hamilton_path;

namespace {

using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// The equations in the unknowns (q, p/unit) at all nodes, and the duration where it is free.
class Collocation {
 public:
  explicit Collocation(const Problem& problem)
      : problem_(problem),
        hamiltonian_(*problem.phase->hamiltonian),
        n_(problem.coordinates() / 2),
        unit_(std::sqrt(problem.phase->weights.velocity / problem.phase->weights.force)),
        elements_(std::clamp(most_values / (2 * n_ * degree), fewest_elements, most_elements)),
        rule_(gauss_rule(degree)),
        basis_(lobatto_basis(degree, rule_.nodes)) {
    const std::vector<double>& nodes = lobatto_barycentric(degree).nodes;
    for (int k = 0; k < elements_; ++k)
      for (int j = 0; j < degree; ++j) tau_.push_back((k + nodes[j]) / elements_);
    tau_.push_back(1);
  }

  bool too_large() const { return 2 * n_ * degree * elements_ > most_values; }

  VectorXd start() const {
    VectorXd x(unknowns());
    std::vector<double> z(2 * n_);
    for (std::size_t k = 0; k < tau_.size(); ++k) {
      problem_.guess.at(tau_[k], z);
      for (int a = 0; a < 2 * n_; ++a) x[index(k) + a] = z[a] / scale(a);
    }
    if (problem_.duration.free) x[unknowns() - 1] = 1;
    return x;
  }

  /// Residuals and their derivatives; false where H is not finite.
  bool evaluate(const VectorXd& x, VectorXd& residual, SparseMatrix& slopes) {
    values_.clear();
    entries_.clear();
    if (!(duration(x) > 0)) return false;
    for (int k = 0; k < elements_; ++k)
      for (int i = 0; i < degree; ++i) add_point(x, k, i);
    add_relation(x);
    if (!problem_.periodic) add_natural_conditions(x);
    if (problem_.duration.energy) add_energy(x);
    if (problem_.duration.where) add_condition(x);
    residual = Eigen::Map<const VectorXd>(values_.data(), std::ssize(values_));
    if (!residual.allFinite()) return false;
    for (const auto& entry : entries_)
      if (!std::isfinite(entry.value())) return false;
    slopes.resize(residual.size(), unknowns());
    slopes.setFromTriplets(entries_.begin(), entries_.end());
    return true;
  }

  Problem guessed(const VectorXd& x) const {
    Problem result = problem_;
    result.duration.value = duration(x);
    result.guess = {};
    result.guess.tau = tau_;
    for (std::size_t k = 0; k < tau_.size(); ++k)
      for (int a = 0; a < 2 * n_; ++a) result.guess.q.push_back(x[index(k) + a] * scale(a));
    return result;
  }

  double extent(const VectorXd& x) const { return x.head(index(tau_.size())).cwiseAbs().maxCoeff(); }

 private:
  Eigen::Index index(std::size_t node) const { return static_cast<Eigen::Index>(node) * 2 * n_; }
  Eigen::Index unknowns() const { return index(tau_.size()) + problem_.duration.free; }
  /// Of an end coordinate, see BoundaryRelation.
  Eigen::Index end_index(int e) const { return e < 2 * n_ ? e : index(tau_.size() - 2) + e; }
  double scale(int a) const { return a < n_ ? 1 : unit_; }
  double end_scale(int e) const { return scale(e % (2 * n_)); }
  double duration(const VectorXd& x) const {
    return problem_.duration.value * (problem_.duration.free ? x[unknowns() - 1] : 1);
  }
  void put(Eigen::Index row, Eigen::Index column, double value) {
    if (value != 0) entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  }
  PointValues hamiltonian(const VectorXd& z, double t, Order order) {
    const VectorXd q = z.head(n_), p = unit_ * z.tail(n_);
    return evaluate_at(hamiltonian_, {q.data(), std::size_t(n_)}, {p.data(), std::size_t(n_)}, t, order,
                       scratch_);
  }

  /// dz/dτ − T (∂H/∂p, −∂H/∂q), weighted as its square is in the integral over τ.
  void add_point(const VectorXd& x, int element, int i) {
    const auto [value, derivative] = basis_.row(i);
    VectorXd z = VectorXd::Zero(2 * n_), rate = z;
    for (int j = 0; j <= degree; ++j) {
      const auto node = x.segment(index(element * degree + j), 2 * n_);
      z += value[j] * node;
      rate += elements_ * derivative[j] * node;
    }
    const double T = duration(x), weight = std::sqrt(rule_.weights[i] / elements_);
    const PointValues h = hamiltonian(z, T * (element + rule_.nodes[i]) / elements_, Order::hessian);
    const auto first = std::ssize(values_);
    const auto slope = [&](int a, int b) {  // of the rate of a, by z_b
      const double* table = (a < n_) == (b < n_) ? h.vq.data() : a < n_ ? h.vv.data() : h.qq.data();
      const int r = a % n_, c = b % n_;
      const bool transposed = a >= n_ && b >= n_;  // H_qp
      const double entry = transposed ? table[c * n_ + r] : table[r * n_ + c];
      return (a < n_ ? entry : -entry) * scale(b) / scale(a);
    };
    for (int a = 0; a < 2 * n_; ++a) {
      const double motion = (a < n_ ? h.dv[a] : -h.dq[a - n_]) / scale(a);
      values_.push_back(weight * (rate[a] - T * motion));
      for (int j = 0; j <= degree; ++j) {
        const auto column = index(element * degree + j);
        put(first + a, column + a, weight * elements_ * derivative[j]);
        for (int b = 0; b < 2 * n_; ++b) put(first + a, column + b, -weight * T * slope(a, b) * value[j]);
      }
      if (problem_.duration.free) put(first + a, unknowns() - 1, -weight * problem_.duration.value * motion);
    }
  }

  void add_relation(const VectorXd& x) {
    const BoundaryRelation& relation = problem_.boundary;
    const auto first = std::ssize(values_);
    std::vector<double> size(relation.rows, 0);
    for (const Triplet& e : relation.matrix)
      size[e.row] = std::max(size[e.row], std::abs(e.value) * end_scale(e.column));
    for (int row = 0; row < relation.rows; ++row) values_.push_back(-relation.value[row] / size[row]);
    for (const Triplet& e : relation.matrix) {
      const double coefficient = e.value * end_scale(e.column) / size[e.row];
      values_[first + e.row] += coefficient * x[end_index(e.column)];
      put(first + e.row, end_index(e.column), coefficient);
    }
  }

  /// p(T)·δq(T) − p(0)·δq(0) is that of given momenta for all variations that the relation allows.
  void add_natural_conditions(const VectorXd& x) {
    const auto first = std::ssize(values_);
    const std::vector<double>& given = problem_.boundary.momenta;
    values_.resize(first + problem_.ends.free, 0);
    for (const Triplet& z : problem_.ends.z) {
      if (z.row % (2 * n_) >= n_) continue;
      const double sign = z.row < 2 * n_ ? -z.value : z.value;
      const auto momentum = end_index(z.row + n_);
      values_[first + z.column] += sign * (x[momentum] - (given.empty() ? 0 : given[z.row] / unit_));
      put(first + z.column, momentum, sign);
    }
  }

  /// In units of its slope.
  void add_energy(const VectorXd& x) {
    const PointValues h = hamiltonian(x.head(2 * n_), 0, Order::gradient);
    VectorXd slope(2 * n_);
    for (int a = 0; a < n_; ++a) slope[a] = h.dq[a], slope[n_ + a] = unit_ * h.dv[a];
    add_row(h.value - *problem_.duration.energy, slope, 0);
  }

  void add_condition(const VectorXd& x) {
    std::vector<double> start(2 * n_), end(2 * n_), gradient(4 * n_);
    for (int a = 0; a < 2 * n_; ++a) {
      start[a] = x[a] * scale(a);
      end[a] = x[end_index(2 * n_ + a)] * scale(a);
    }
    const double value = problem_.duration.where(start, end, gradient);
    VectorXd slope(4 * n_);
    for (int e = 0; e < 4 * n_; ++e) slope[e] = gradient[e] * end_scale(e);
    add_row(value, slope, 2 * n_);
  }

  /// An equation by the ends; the slopes of the start come first, those of the end from `last` on.
  void add_row(double value, const VectorXd& slope, int last) {
    const double size = slope.norm() > 0 ? slope.norm() : 1;
    const auto row = std::ssize(values_);
    values_.push_back(value / size);
    for (int e = 0; e < slope.size(); ++e)
      put(row, last > 0 ? end_index(e) : static_cast<Eigen::Index>(e), slope[e] / size);
  }

  const Problem& problem_;
  const Lagrangian& hamiltonian_;
  const int n_;
  const double unit_;
  const int elements_;
  const Rule rule_;
  const Basis basis_;
  std::vector<double> tau_, values_;
  std::vector<Eigen::Triplet<double>> entries_;
  Scratch scratch_;
};

}  // namespace

std::optional<Problem> near_hamilton_path(const Problem& problem, const Deadline& deadline) {
  if (!problem.guess.given()) return std::nullopt;
  Collocation equations(problem);
  if (equations.too_large()) return std::nullopt;
  VectorXd x = equations.start(), residual, tried;
  SparseMatrix slopes, tried_slopes;
  if (!equations.evaluate(x, residual, slopes)) return std::nullopt;
  Eigen::SimplicialLDLT<SparseMatrix> solver;
  double damping = first_damping;
  for (int step = 0; step < most_steps && residual.norm() > enough * equations.extent(x); ++step) {
    if (deadline.passed() || damping > most_damping) return std::nullopt;
    SparseMatrix normal = slopes.transpose() * slopes;
    const double size = normal.diagonal().mean();
    normal.diagonal().array() += damping * size;
    solver.compute(normal);
    if (solver.info() != Eigen::Success) {
      damping *= more_damping;
      continue;
    }
    const VectorXd moved = x - solver.solve(slopes.transpose() * residual);
    if (!equations.evaluate(moved, tried, tried_slopes) || !(tried.norm() < residual.norm())) {
      damping *= more_damping;
      continue;
    }
    const bool stalls = tried.norm() > (1 - least_fall) * residual.norm();
    x = moved;
    residual.swap(tried);
    slopes.swap(tried_slopes);
    damping = std::max(damping / less_damping, least_damping);
    if (stalls && residual.norm() <= solved_within * equations.extent(x)) break;
  }
  if (!(residual.norm() <= solved_within * equations.extent(x))) return std::nullopt;
  Problem near = equations.guessed(x);
  const auto range = [](const Problem& of) { return largest_range(of.guess.q, of.coordinates()); };
  if (problem.periodic && shrank(problem, range(near), range(problem))) return std::nullopt;
  return near;
}

}  // namespace extremal
