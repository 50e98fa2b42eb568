#include "solve/reversed_solve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "action/rule.hpp"
#include "motion/point.hpp"
#include "solve/limits.hpp"

namespace extremal {

using namespace limits::reversed_solve;

namespace {

/// L = ½ q'ᵀMq' − V(q).
bool reversible(const Structure& s) {
  return s.autonomous && s.quadratic && s.velocity_free && s.gyroscopic.empty() && s.linear.empty();
}

/// 1/√(V''/M) at an end that is fixed, the shortest of the coordinates; 0 where it is free.
double shortest_time(const Problem& problem, bool at_end, PointEvaluator& point) {
  if (!problem.ends.fixes(at_end)) return 0;
  const std::size_t n = problem.coordinates();
  const std::span<const double> q(problem.ends.offset.data() + (at_end ? n : 0), n);
  const std::vector<double> rest(n, 0);
  if (!point.evaluate(q, rest, 0, Order::hessian)) return 0;
  std::vector<double> stiffness(n, 0), mass(n, 0);
  for (const auto& [form, diagonal] : {std::pair(&point.qq(), &stiffness), std::pair(&point.vv(), &mass)})
    for (const Triplet& entry : *form)
      if (entry.row == entry.column) (*diagonal)[entry.row] += entry.value;
  double fastest = 0;
  for (std::size_t a = 0; a < n; ++a)
    fastest = std::max(fastest, std::sqrt(std::abs(stiffness[a] / mass[a])));
  return std::isfinite(fastest) && fastest > 0 ? 1 / fastest : 0;
}

/// Row by row, the last one first.
void reverse_rows(std::vector<double>& rows, std::size_t n) {
  std::ranges::reverse(rows);
  for (std::size_t k = 0; k < rows.size(); k += n)
    std::reverse(rows.begin() + static_cast<std::ptrdiff_t>(k),
                 rows.begin() + static_cast<std::ptrdiff_t>(k + n));
}

/// Elements of the trajectory that are beyond the last time below T which is told from its neighbours become
/// one; its values are those at its nodes.
void join_last_elements(const Trajectory& backwards, Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates, row = (trajectory.degree + 1) * n;
  const double T = trajectory.duration();
  std::size_t kept = 0;  // elements
  while (kept + 1 < trajectory.times.size() - 1 && trajectory.times[kept + 1] > trajectory.times[kept] &&
         T - trajectory.times[kept + 1] > least_length * T)
    ++kept;
  if (kept + 1 == trajectory.times.size() - 1) return;
  const double length = T - trajectory.times[kept];
  trajectory.times.resize(kept + 1);
  trajectory.times.push_back(T);
  trajectory.lengths.resize(kept);
  trajectory.lengths.push_back(length);
  trajectory.nodes.resize(kept * row);
  trajectory.slopes.resize(kept * row);
  std::vector<double> q(n), v(n);
  for (const double tau : lobatto_barycentric(trajectory.degree).nodes) {
    backwards.at((1 - tau) * length, q, v);
    trajectory.nodes.insert(trajectory.nodes.end(), q.begin(), q.end());
    for (const double x : v) trajectory.slopes.push_back(-x);
  }
}

/// At the start, where the terms of the energy are smaller than in the layer.
void read_energy(const Problem& problem, Solution& solution) {
  std::vector<double> q(problem.coordinates()), v(q);
  solution.trajectory.at(0, q, v);
  Scratch scratch;
  const PointValues at = evaluate_at(*problem.lagrangian, q, v, 0, Order::gradient, scratch);
  double energy = -at.value;
  for (std::size_t a = 0; a < q.size(); ++a) energy += at.dv[a] * v[a];
  solution.energy = energy;
}

}  // namespace

bool has_layer_at_end(const Problem& problem) {
  if (!problem.has_ends() || problem.duration.free || problem.initial || problem.paired || problem.copies ||
      problem.manifold || problem.phase || problem.extension || problem.inequalities ||
      !problem.boundary.momenta.empty() || !reversible(problem.lagrangian->structure()))
    return false;
  PointEvaluator point(*problem.lagrangian);
  const double T = problem.duration.value, end = shortest_time(problem, true, point);
  if (end == 0 || end > thinnest * T) return false;
  return shortest_time(problem, false, point) > end;
}

Problem reversed(const Problem& problem) {
  const int n = problem.coordinates();
  Problem result = problem;
  for (Triplet& entry : result.boundary.matrix) entry.column = (entry.column + n) % (2 * n);
  result.ends = solve_relation(result.boundary);
  std::ranges::reverse(result.guess.tau);
  for (double& tau : result.guess.tau) tau = 1 - tau;
  reverse_rows(result.guess.q, n);
  return result;
}

Solution reversed(const Problem& problem, Solution solution) {
  if (solution.trajectory.times.empty()) return solution;
  const Trajectory backwards = solution.trajectory;
  Trajectory& trajectory = solution.trajectory;
  const std::size_t n = trajectory.coordinates;
  const double T = trajectory.duration();
  std::ranges::reverse(trajectory.times);
  for (double& t : trajectory.times) t = T - t;
  std::ranges::reverse(trajectory.lengths);
  reverse_rows(trajectory.nodes, n);
  reverse_rows(trajectory.slopes, n);
  for (double& x : trajectory.slopes) x = -x;
  join_last_elements(backwards, trajectory);
  std::swap(solution.momentum_start, solution.momentum_end);
  for (std::vector<double>* p : {&solution.momentum_start, &solution.momentum_end})
    for (double& x : *p) x = -x;
  if (solution.energy) read_energy(problem, solution);
  for (std::array<double, 2>& window : solution.windows) window = {T - window[1], T - window[0]};
  std::ranges::reverse(solution.windows);
  // Conjugate times and the longest windows are counted from the start.
  if (solution.windows.size() > 1 || !solution.conjugate_times.empty()) {
    solution.windows.clear();
    solution.conjugate_times.clear();
    solution.conjugate_times_known = false;
    solution.certificate = Certificate::none;
  }
  if (solution.converged())
    solution.message += "; found backwards, as the layer at the end is thinner than digits of t";
  return solution;
}

}  // namespace extremal
