#include "solution/in_phase_space.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "action/rule.hpp"
#include "problem/phase_space.hpp"

namespace extremal {

PhaseRanges phase_ranges(const Problem& problem, const Trajectory& trajectory) {
  const std::size_t all = trajectory.coordinates, n = all / 2;
  std::vector<double> low(all, INFINITY), high(all, -INFINITY);
  for (std::size_t k = 0; k < trajectory.nodes.size(); ++k) {
    low[k % all] = std::min(low[k % all], trajectory.nodes[k]);
    high[k % all] = std::max(high[k % all], trajectory.nodes[k]);
  }
  const auto range = [&](std::size_t first) {
    double most = 0, size = 0;
    for (std::size_t a = first; a < first + n; ++a) {
      most = std::max(most, high[a] - low[a]);
      size = std::max({size, std::abs(low[a]), std::abs(high[a])});
    }
    constexpr double negligible = 1e-10;
    return most > negligible * size ? most : size;
  };
  constexpr double least_share = 1e-7;
  const PhaseWeights& weights = problem.phase->weights;
  const double q = range(0), p = range(n), p_by_q = std::sqrt(weights.velocity / weights.force);
  return {std::max(q, least_share * p / p_by_q), std::max(p, least_share * q * p_by_q)};
}

double phase_defect(const Problem& problem, const Trajectory& trajectory, int degree) {
  const std::size_t all = trajectory.coordinates, n = all / 2;
  const Rule rule = gauss_rule(degree);
  const PhaseRanges ranges = phase_ranges(problem, trajectory);
  std::vector<double> state(all), rate(all), motion(all);
  Scratch scratch;
  const double shift = problem.phase->weights.shift;
  double of_q = 0, of_p = 0;
  for (int k = 0; k < trajectory.elements(); ++k)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      trajectory.in_element(k, rule.nodes[i], state, rate);
      const double t = trajectory.times[k] + rule.nodes[i] * trajectory.length(k);
      for (std::size_t a = 0; a < all; ++a) state[a] += (a < n ? -shift : shift) * rate[a];
      hamilton_equations(*problem.phase->hamiltonian, state, t - shift, motion, scratch);
      const double weight = rule.weights[i] * trajectory.length(k);
      for (std::size_t a = 0; a < all; ++a)
        (a < n ? of_q : of_p) += weight * (rate[a] - motion[a]) * (rate[a] - motion[a]);
    }
  const auto relative = [&](double square, double range) {
    return square > 0 ? std::sqrt(square * trajectory.duration()) / range : 0;
  };
  return std::max(relative(of_q, ranges.q), relative(of_p, ranges.p));
}

std::vector<double> shifted_energies(const Problem& problem, const Trajectory& trajectory) {
  if (!problem.lagrangian->structure().autonomous) return {};
  const std::size_t all = trajectory.coordinates, n = all / 2;
  const double shift = problem.phase->weights.shift;
  std::vector<double> state(all), rate(all), energies;
  Scratch scratch;
  for (int k = 0; k < trajectory.elements(); ++k) {
    trajectory.in_element(k, 0.5, state, rate);
    for (std::size_t a = 0; a < all; ++a) state[a] += (a < n ? -shift : shift) * rate[a];
    const std::span<const double> point(state);
    energies.push_back(
        evaluate_at(*problem.phase->hamiltonian, point.first(n), point.subspan(n), 0, Order::value, scratch)
            .value);
  }
  return energies;
}

double largest_difference(const Trajectory& one, const Trajectory& other) {
  constexpr int parts = 4;
  std::vector<double> a(one.coordinates), b(a), unused(a);
  double most = 0;
  for (int k = 0; k < one.elements(); ++k)
    for (int i = 0; i <= parts; ++i) {
      const double tau = static_cast<double>(i) / parts;
      one.in_element(k, tau, a, unused);
      other.at(std::min(one.times[k] + tau * one.length(k), other.duration()), b, unused);
      for (std::size_t j = 0; j < a.size(); ++j) most = std::max(most, std::abs(a[j] - b[j]));
    }
  return most;
}

void observe_in_phase_space(const Problem& problem, Solution& solution) {
  solution.morse_index = solution.nullity = std::nullopt;
  solution.minimizing = solution.conjugate_times_known = false;
  solution.windows.clear();
  solution.conjugate_times.clear();
  solution.certificate = Certificate::none;
  const Trajectory& trajectory = solution.trajectory;
  if (trajectory.times.empty()) return;
  const std::size_t all = trajectory.coordinates, n = all / 2;
  solution.momentum_start.assign(trajectory.nodes.begin() + static_cast<std::ptrdiff_t>(n),
                                 trajectory.nodes.begin() + static_cast<std::ptrdiff_t>(all));
  solution.momentum_end.assign(trajectory.nodes.end() - static_cast<std::ptrdiff_t>(n),
                               trajectory.nodes.end());
  solution.energy = solution.energy_drift = std::nullopt;
  if (!problem.lagrangian->structure().autonomous) return;
  Scratch scratch;
  const auto energy = [&](const double* state) {
    return evaluate_at(*problem.phase->hamiltonian, {state, n}, {state + n, n}, 0, Order::value, scratch)
        .value;
  };
  const double start = energy(trajectory.nodes.data());
  double drift = 0;
  for (std::size_t k = 0; k < trajectory.nodes.size(); k += all)
    drift = std::max(drift, std::abs(energy(trajectory.nodes.data() + k) - start));
  std::vector<double> state(all), rate(all);
  for (int k = 0; k < trajectory.elements(); ++k) {
    trajectory.in_element(k, 0.5, state, rate);
    drift = std::max(drift, std::abs(energy(state.data()) - start));
  }
  if (!std::isfinite(start) || !std::isfinite(drift)) return;
  solution.energy = start;
  solution.energy_drift = drift;
}

}  // namespace extremal
