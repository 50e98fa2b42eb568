#include <algorithm>
#include <cmath>

#include "solution/observe.hpp"
#include "solve/branch/continuation.hpp"
#include "solve/periodic/stability.hpp"

/// \file What there is to know of a place on a branch.

namespace extremal {

BranchPoint Continuation::read(PointKind kind) {
  BranchPoint point;
  point.parameter = here_.varied;
  point.kind = kind;
  const Problem& problem = branch_.problem();
  Solution& solution = point.solution;
  solution.status = Status::converged;
  solution.message = "converged";
  solution.strategy = "continuation";
  solution.trajectory = trajectory_of(here_.path);
  solution.degree = here_.path.degree();
  solution.action = here_.action;
  solution.error_estimate = error_;
  solution.morse_index = branch_.inertia().negative;
  solution.nullity = branch_.inertia().zero;
  observe_energy(*problem.lagrangian, solution);
  read_momenta(solution);
  if (!problem.periodic) return point;
  if (problem.coordinates() <= most_coordinates_for_multipliers)
    w_.variation.assemble(problem.lagrangian, solution.trajectory, condensed());
  read_stability(problem, w_.variation, sizes().q, solution, false);
  here_.gaps = solution.floquet ? doubling_gaps(*solution.floquet) : std::vector<double>{NAN};
  return point;
}

/// p = ∂L/∂q' of the trajectory against the derivatives of the action.
void Continuation::read_momenta(Solution& solution) {
  const std::size_t n = solution.trajectory.coordinates;
  const std::span<const double> momenta = branch_.momenta();
  solution.momentum_start.assign(momenta.begin(), momenta.begin() + n);
  solution.momentum_end.assign(momenta.begin() + n, momenta.end());
  const Trajectory& trajectory = solution.trajectory;
  // ∫p·q' dt by the range of q: momenta are small at both ends of a swing between points of rest.
  const double swept = std::abs(solution.action + solution.energy.value_or(0) * solution.duration());
  const double range = sizes().range;
  double worst = 0, largest = range > 0 ? swept / range : 0;
  for (const bool end : {false, true}) {
    const double t = end ? solution.duration() : 0;
    const std::size_t first = end ? trajectory.nodes.size() - n : 0;
    const PointValues at =
        evaluate_at(*branch_.problem().lagrangian, {trajectory.nodes.data() + first, n},
                    {trajectory.slopes.data() + first, n}, t, Order::gradient, momentum_memory_);
    const std::vector<double>& action = end ? solution.momentum_end : solution.momentum_start;
    for (std::size_t a = 0; a < n; ++a) {
      worst = std::max(worst, std::abs(at.dv[a] - action[a]));
      largest = std::max(largest, std::abs(action[a]));
    }
  }
  if (largest > 0) worst_momentum_ = std::max(worst_momentum_, worst / largest);
}

}  // namespace extremal
