#include "solution/one_copy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "action/rule.hpp"
#include "solution/observe.hpp"

namespace extremal {

namespace {

/// The first half of each row of 2n.
void keep_first(std::vector<double>& rows, std::size_t n) {
  if (n == 0) return;
  std::size_t to = 0;
  for (std::size_t from = 0; from < rows.size(); from += 2 * n, to += n)
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(from), n,
                rows.begin() + static_cast<std::ptrdiff_t>(to));
  rows.resize(to);
}

Trajectory one_of(Trajectory pair) {
  pair.coordinates /= 2;
  keep_first(pair.nodes, pair.coordinates);
  keep_first(pair.slopes, pair.coordinates);
  return pair;
}

/// L, and the power F·q' of the forces, at a point.
class Motion {
 public:
  explicit Motion(const Problem& problem)
      : problem_(problem), n_(problem.coordinates()), q_(2 * n_), v_(2 * n_) {}

  struct Values {
    double lagrangian = 0, power = 0, energy = 0;
  };
  /// Λ by q₁ is ∂L/∂q + F.
  Values at(const Trajectory& trajectory, int element, double tau) {
    const std::span<double> q(q_.data(), n_), v(v_.data(), n_);
    trajectory.in_element(element, tau, q, v);
    std::copy_n(q_.begin(), n_, q_.begin() + static_cast<std::ptrdiff_t>(n_));
    std::copy_n(v_.begin(), n_, v_.begin() + static_cast<std::ptrdiff_t>(n_));
    const double t = trajectory.times[element] + tau * trajectory.length(element);
    const PointValues l = evaluate_at(*problem_.lagrangian, q, v, t, Order::gradient, scratch_);
    const PointValues both = evaluate_at(*problem_.copies, q_, v_, t, Order::gradient, scratch_);
    Values values{.lagrangian = l.value, .power = 0, .energy = -l.value};
    for (std::size_t a = 0; a < n_; ++a) {
      values.power += (both.dq[a] - l.dq[a]) * v[a];
      values.energy += l.dv[a] * v[a];
    }
    return values;
  }

 private:
  const Problem& problem_;
  std::size_t n_;
  std::vector<double> q_, v_;
  Scratch scratch_;
};

/// ∫ L dt and ∫ F·q' dt.
void integrate(const Problem& problem, const Rule& rule, Solution& solution) {
  Motion motion(problem);
  double action = 0, work = 0;
  for (int k = 0; k < solution.trajectory.elements(); ++k)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const auto at = motion.at(solution.trajectory, k, rule.nodes[i]);
      const double weight = rule.weights[i] * solution.trajectory.length(k);
      action += weight * at.lagrangian;
      work += weight * at.power;
    }
  solution.action = action;
  solution.work = work;
  solution.energy = solution.energy_drift = std::nullopt;
  if (problem.lagrangian->structure().autonomous)
    solution.energy = motion.at(solution.trajectory, 0, 0).energy;
}

}  // namespace

double difference_of_copies(const Trajectory& pair) {
  const std::size_t n = pair.coordinates / 2;
  double most = 0;
  for (std::size_t row = 0; row < pair.nodes.size(); row += 2 * n)
    for (std::size_t a = row; a < row + n; ++a)
      most = std::max(most, std::abs(pair.nodes[a] - pair.nodes[a + n]));
  return most;
}

Solution one_copy(const Problem& problem, Solution pair, const Scheme* scheme) {
  Solution solution = std::move(pair);
  const std::size_t n = problem.coordinates();
  solution.morse_index = solution.nullity = std::nullopt;
  solution.minimizing = solution.conjugate_times_known = false;
  solution.windows.clear();
  solution.conjugate_times.clear();
  solution.certificate = Certificate::none;
  solution.unknowns = (solution.unknowns + problem.duration.free) / 2;
  solution.momentum_start.resize(std::min(n, solution.momentum_start.size()));
  solution.momentum_end.resize(std::min(n, solution.momentum_end.size()));
  if (solution.trajectory.times.empty()) return solution;
  solution.trajectory = one_of(std::move(solution.trajectory));
  const int degree = solution.trajectory.degree;
  const bool exact = !scheme || scheme->quadrature == Quadrature::exact;
  const Rule rule = exact ? gauss_rule(std::min(degree + 4, max_points)) : rule_of(*scheme, 0);
  integrate(problem, rule, solution);
  if (solution.pinned && solution.converged())
    solution.element_energies =
        element_energies(*problem.lagrangian, rule.nodes, rule.weights, solution.trajectory);
  return solution;
}

}  // namespace extremal
