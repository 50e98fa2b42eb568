#include "solve/accept/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "action/energies.hpp"
#include "problem/closing.hpp"
#include "solution/broken_node.hpp"
#include "solution/one_copy.hpp"
#include "solve/accept/limits.hpp"
#include "solve/adapt/others_to_try.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/residual_test.hpp"
#include "solve/periodic/equilibrium.hpp"

namespace extremal {

using namespace limits::conditions;

namespace {

/// Where atoms overlap, forces are so strong that steps are roundoff while δS is not.
bool balanced(const Solution& solution, const Path& path, const NewtonIteration& newton) {
  const double roundoff = strong_force_roundoff * newton.stiffness() * largest_coordinate(path);
  return solution.residual <= largest_residual || newton.residual() <= roundoff;
}

/// A duration that runs away can look like convergence.
bool closed(const Problem& problem, const SolveOptions& options, const Path& path,
            const ElementTables& tables, NewtonIteration& newton) {
  const ClosingEquation* closing = newton.closing(path);
  if (!closing) return true;
  const double duration = path.duration();
  const bool in_range = duration > 0 && duration < longest_duration * problem.duration.value;
  // The energy of two copies vanishes wherever they agree.
  if (problem.paired && closing->row.empty()) return in_range;
  const double slope = newton.action().slope_duration();
  // An energy may be zero: then it is known against those along the path.
  const double size = closing->row.empty() ? std::abs(slope) + std::abs(closing->value)
                                           : std::max(1.0, scales(path, tables).magnitude);
  const double unit = closing->row.empty() ? energy_unit(newton.action(), path.duration()) : size;
  const double value = closing->row.empty() ? slope + closing->value : closing->value;
  const double share =
      std::max(closing_tolerances * (options.elements > 0 ? 0 : options.tolerance), least_closing);
  const double allowed = std::max(share * size, closing_roundoff * unit);
  return std::abs(value) <= allowed && in_range;
}

/// The residual of the natural conditions must be within the error that momenta may have: where forces hardly
/// change momenta, that may be far below them. Steps of closed paths have no part along a family of orbits,
/// nor have other steps along null directions: there only the forces that an error of q makes may be left.
bool within_momenta(const Problem& problem, const Survey& survey, double tolerance, int nullity,
                    const Path& path, const DiscreteAction& action) {
  const double range = *std::max_element(survey.p.begin(), survey.p.end());
  if (nullity > 0 && !problem.periodic) {
    const double error = tolerance * *std::max_element(survey.q.begin(), survey.q.end());
    return natural_residual(problem, action, path, error) <=
           std::max(momentum_tolerances * tolerance * range, unit_roundoff * action.momentum_scale());
  }
  const double part = problem.shifts_in_time() || problem.periodic ? held_tolerances : momentum_tolerances;
  return natural_residual(problem, action, path) <=
         std::max(part * tolerance * range, momentum_roundoff * action.momentum_scale());
}

/// By how much momenta jump from element to element, of their range, where that is more than they may err and
/// than roundoff of their sums: forces or masses are formed of terms that cancel. A path at rest has no
/// range.
double jump_of_momenta(const Survey& survey, double tolerance, const Scales& size,
                       const DiscreteAction& action) {
  const double range = *std::max_element(survey.p.begin(), survey.p.end()), jump = action.residual();
  const double roundoff = momentum_roundoff * std::max(survey.momentum, action.momentum_scale());
  const bool moves = size.range == size.q && range > roundoff;
  const double allowed = std::max(jump_margin * momentum_tolerances * tolerance * range, roundoff);
  return moves && jump > allowed ? jump / range : 0;
}

}  // namespace

std::optional<Refusal> equations_fail(const Problem& problem, const SolveOptions& options,
                                      const Outcome& outcome, const Path& path, NewtonIteration& newton,
                                      const Solution& solution) {
  const ElementTables& tables = *outcome.tables;
  if (!newton.action().finite() || !std::isfinite(solution.action) || !std::isfinite(solution.residual))
    return Refusal{Status::not_converged, "the path runs through a singularity of L; try another guess"};
  if (!balanced(solution, path, newton))
    return Refusal{
        Status::not_converged,
        fmt::format("a residual of {:.1e} of the largest momentum remains: forces are too large against the "
                    "momenta; try another guess",
                    solution.residual)};
  if (!closed(problem, options, path, tables, newton))
    return Refusal{
        Status::no_solution_near,
        "the duration left the range of the guess: no extremal near it satisfies the condition that "
        "determines the duration; try another guess"};
  if (shrank(problem, scales(path, tables).range, outcome.first_range))
    return Refusal{Status::no_solution_near,
                   fmt::format("{}; try {}", shrank_to_rest,
                               others_to_try(problem, "a larger guess", "another duration"))};
  return std::nullopt;
}

std::optional<Refusal> elements_fail(const Problem& problem, const SolveOptions& options,
                                     const Outcome& outcome, const Path& path,
                                     const std::optional<Survey>& found, const DiscreteAction& action,
                                     Solution& solution) {
  const double estimate = solution.error_estimate;
  // Shifts in time, which are held, do not count.
  const int nullity = problem.periodic ? solution.nullity.value_or(0)
                                       : std::max(0, solution.nullity.value_or(0) - problem.shifts_in_time() -
                                                         static_cast<int>(problem.symmetries.size()));
  const auto drifts = [&](const Survey& by) {
    solution.error_estimate = error_behind_drift(by, solution.trajectory, estimate);
    const bool raised = solution.error_estimate > estimate,
               conserved = options.scheme || conserves_energy(by, solution.trajectory, options.tolerance);
    return !conserved || (raised && options.elements == 0 && solution.error_estimate > outcome.tolerance);
  };
  const auto inertial = [&] { return with_inertia(*found, *problem.lagrangian, solution.trajectory); };
  if (found && drifts(*found) && drifts(inertial()))
    return energy_drifts(*solution.energy_drift, options.tolerance);
  if (found && problem.ends.free > 0 && !options.scheme &&
      !within_momenta(problem, *found, options.tolerance, nullity, path, action))
    return Refusal{
        Status::not_converged,
        fmt::format(
            "a residual of {:.1e} of the largest momentum remains, more than the tolerance {:.1e} allows: "
            "forces nearly vanish along the path, and there may be no extremal near; try another guess",
            solution.residual, options.tolerance),
        // Orbits near rest: the smaller the next one is, the more roundoff hides of its residual.
        problem.periodic};
  // Far away, where forces vanish, equations that have no solution leave hardly a residual.
  if (outcome.elsewhere && !outcome.shifts_held && !problem.periodic && nullity > 0)
    return Refusal{
        Status::conjugate_ends,
        "the path found is far from the guess, and its second variation is singular: the ends may be "
        "conjugate, or forces vanish along the path; move an end, change the duration, or try a better "
        "guess"};
  if (!found || options.scheme) return std::nullopt;
  const auto jump_by = [&](const Survey& by) {
    return jump_of_momenta(by, options.tolerance, scales(path, *outcome.tables), action);
  };
  if (const double jump = jump_by(*found) > 0 ? jump_by(inertial()) : 0; jump > 0)
    return Refusal{Status::not_converged,
                   fmt::format("momenta jump by {:.1e} of their range from element to element, more than the "
                               "tolerance {:.1e} allows: roundoff hides them; try another tolerance",
                               jump, options.tolerance)};
  return std::nullopt;
}

Refusal energy_drifts(double drift, double tolerance) {
  return {Status::not_converged,
          fmt::format("the energy drifts by {:.1e}, more than the tolerance {:.1e} allows: L has a "
                      "singularity or a kink on the path that the elements do not resolve; try "
                      "another tolerance",
                      drift, tolerance)};
}

std::optional<Refusal> has_broken_node(const Problem& problem, const Lagrangian& lagrangian,
                                       const Trajectory& trajectory, int first, int last) {
  if (lagrangian.structure().velocity_free) return std::nullopt;  // p is linear in q'
  std::optional<ClosingMap> closing;
  if (problem.periodic && last == trajectory.elements()) closing = closing_map(problem);
  const std::optional<BrokenNode> broken =
      find_broken_node(lagrangian, trajectory, problem.paired, first, last, closing ? &*closing : nullptr);
  if (!broken) return std::nullopt;
  return Refusal{Status::not_converged, describe(*broken)};
}

std::optional<Refusal> copies_differ(const Trajectory& pair, double size) {
  const double difference = difference_of_copies(pair);
  if (difference <= limits::acceptance::most_difference_of_copies * size) return std::nullopt;
  return Refusal{Status::not_converged,
                 fmt::format("two copies of the coordinates, which agree along a motion with forces, differ "
                             "by {:.1e}; try another guess",
                             difference)};
}

}  // namespace extremal
