#include "solution/one_copy.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "action/rule.hpp"
#include "problem/manifold.hpp"
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

/// The power F·q' of the forces at a point.
class Power {
 public:
  Power(const Lagrangian& lagrangian, const Lagrangian& copies)
      : lagrangian_(lagrangian), copies_(copies), n_(lagrangian.structure().coordinates) {}

  /// Λ by q₁ is ∂L/∂q + F.
  double at(std::span<const double> q, std::span<const double> v, double t) {
    q_.assign(q.begin(), q.end());
    v_.assign(v.begin(), v.end());
    q_.insert(q_.end(), q.begin(), q.end());
    v_.insert(v_.end(), v.begin(), v.end());
    const PointValues l = evaluate_at(lagrangian_, q, v, t, Order::gradient, scratch_);
    const PointValues both = evaluate_at(copies_, q_, v_, t, Order::gradient, scratch_);
    double power = 0;
    for (std::size_t a = 0; a < n_; ++a) power += (both.dq[a] - l.dq[a]) * v[a];
    return power;
  }

 private:
  const Lagrangian &lagrangian_, &copies_;
  const std::size_t n_;
  std::vector<double> q_, v_;
  Scratch scratch_;
};

/// The integral of f(q, q', t).
template <class Function>
double integral(const Trajectory& trajectory, const Rule& rule, const Function& f) {
  std::vector<double> q(trajectory.coordinates), v(q);
  double sum = 0;
  for (int k = 0; k < trajectory.elements(); ++k)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      trajectory.in_element(k, rule.nodes[i], q, v);
      const double t = trajectory.times[k] + rule.nodes[i] * trajectory.length(k);
      sum += rule.weights[i] * trajectory.length(k) * f(q, v, t);
    }
  return sum;
}

double work(const Trajectory& trajectory, const Rule& rule, const Lagrangian& lagrangian,
            const Lagrangian& copies) {
  Power power(lagrangian, copies);
  return integral(trajectory, rule,
                  [&](const auto& q, const auto& v, double t) { return power.at(q, v, t); });
}

double work_under_constraints(const Manifold& manifold, const Trajectory& trajectory, const Rule& rule) {
  return work(trajectory, rule, manifold.lagrangian(), *manifold.parts().copies);
}

Rule fine_rule(const Trajectory& trajectory) {
  return gauss_rule(std::min(trajectory.degree + 4, max_points));
}

/// p·q' − L at the start.
double energy(const Lagrangian& lagrangian, const Trajectory& trajectory) {
  std::vector<double> q(trajectory.coordinates), v(q);
  trajectory.in_element(0, 0, q, v);
  Scratch scratch;
  const PointValues l = evaluate_at(lagrangian, q, v, trajectory.times[0], Order::gradient, scratch);
  return std::inner_product(v.begin(), v.end(), l.dv.begin(), -l.value);
}

/// ∫ L dt and ∫ F·q' dt.
void integrate(const Problem& problem, const Rule& rule, Solution& solution) {
  const Lagrangian& lagrangian = *problem.lagrangian;
  Scratch scratch;
  solution.action = integral(solution.trajectory, rule, [&](const auto& q, const auto& v, double t) {
    return evaluate_at(lagrangian, q, v, t, Order::value, scratch).value;
  });
  const bool moving = problem.manifold && !problem.manifold->autonomous();
  solution.work = moving ? work_under_constraints(*problem.manifold, solution.trajectory, rule)
                         : work(solution.trajectory, rule, lagrangian, *problem.copies);
  solution.energy = solution.energy_drift = std::nullopt;
  if (lagrangian.structure().autonomous) solution.energy = energy(lagrangian, solution.trajectory);
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

double work_under_constraints(const Manifold& manifold, const Trajectory& trajectory) {
  return work_under_constraints(manifold, trajectory, fine_rule(trajectory));
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
  const bool exact = !scheme || scheme->quadrature == Quadrature::exact;
  const Rule rule = exact ? fine_rule(solution.trajectory) : rule_of(*scheme, 0);
  integrate(problem, rule, solution);
  if (solution.pinned && solution.converged())
    solution.element_energies =
        element_energies(*problem.lagrangian, rule.nodes, rule.weights, solution.trajectory);
  return solution;
}

}  // namespace extremal
