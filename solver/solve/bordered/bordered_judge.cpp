#include "solve/bordered/bordered_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "solution/extension_values.hpp"
#include "solution/observe.hpp"
#include "solve/accept/minimality.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/periodic/stability.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

Solution refused(std::string message) {
  Solution solution;
  solution.message = std::move(message);
  return solution;
}

std::shared_ptr<const ExtensionValues> read_extension_values(const Problem& problem,
                                                             const BorderedEquations& equations,
                                                             const BorderedState& state) {
  const Extension& extension = *problem.extension;
  const std::vector<double> constants = state.constants(problem.coordinates());
  auto values = std::make_shared<ExtensionValues>();
  for (int k = 0; k < extension.unknowns(); ++k)
    values->unknowns.emplace_back(extension.names[k], constants[k]);
  values->integral_multipliers.assign(constants.begin() + extension.unknowns(), constants.end());
  for (std::size_t w = 0; w < extension.waypoints.size(); ++w) {
    WaypointImpulse& impulse = values->waypoints.emplace_back();
    impulse.time = state.times[w];
    for (const auto& [a, value] : extension.waypoints[w].fixed)
      impulse.impulse.emplace_back(a, -equations.node_gradient(state.mesh.first[w + 1], a));
  }
  values->lagrangian = extension.at(constants);
  return values;
}

/// Windows, conjugate times and multipliers of L + Σ ν g with all constants held; none with waypoints, where
/// Jacobi fields jump too.
void read_variation(const Problem& problem, const SolveOptions& options, const Path& path, double size,
                    Solution& solution) {
  if (!problem.extension->waypoints.empty()) {
    solution.message += "; windows are not found across waypoints";
    return;
  }
  Problem held = problem;
  held.lagrangian = solution.extension->lagrangian;
  held.duration.value = path.duration();
  SecondVariation variation;
  const std::optional<int> index = solution.morse_index;
  const bool minimizing = solution.minimizing;
  read_minimality(held, options, variation, solution);
  // Integrals and conditions take directions from the index, which conjugate times do not.
  if (solution.morse_index) {
    solution.morse_index = index;
    solution.minimizing = minimizing;
  }
  read_stability(held, variation, size, solution);
}

}  // namespace

Solution judge(const Problem& problem, const SolveOptions& options, BorderedEquations& equations,
               const BorderedState& state, const ElementTables& own, double error, double first) {
  const double size = path_size(state.path, problem.coordinates());
  if (!equations.evaluate(state, true)) return refused("the action is not finite along the path found");
  if (!(size < most_growth * first) || !(state.times.back() < most_growth * problem.duration.value))
    return refused("the path ran away from the guess; try another guess");
  if (!(equations.residual() <= largest_residual))
    return refused(
        fmt::format("a residual of {:.1e} of the largest momentum remains: there is no extremal near; "
                    "try another guess",
                    equations.residual()));
  if (!(equations.mismatch() <= largest_mismatch))
    return refused(
        fmt::format("the conditions are missed by {:.1e}; try another guess", equations.mismatch()));
  const double energy = equations.momentum() * size / state.times.back();
  if (!(equations.energy_jump() <=
        largest_residual * std::max(energy, std::abs(problem.duration.energy.value_or(0)))))
    return refused(fmt::format("the energy at a free time is missed by {:.1e}; try another guess",
                               equations.energy_jump()));
  Solution solution;
  solution.status = Status::converged;
  solution.message = "converged";
  solution.extension = read_extension_values(problem, equations, state);
  Path path;
  without_constants(state.path, own, path);
  solution.trajectory = trajectory_of(path);
  const DiscreteAction& action = equations.action();
  const Extension& extension = *problem.extension;
  solution.action = action.action();
  for (int j = 0; j < extension.multipliers(); ++j)
    solution.action -= solution.extension->integral_multipliers[j] * extension.integrals[j];
  for (int a = 0; a < problem.coordinates(); ++a) {
    solution.momentum_start.push_back(-action.start_gradient()[a]);
    solution.momentum_end.push_back(action.end_gradient()[a]);
  }
  solution.residual = equations.residual();
  solution.error_estimate = error;
  solution.degree = path.degree();
  solution.unknowns = equations.first_held();
  const Inertia inertia = equations.inertia();
  solution.morse_index = inertia.negative;
  solution.nullity = inertia.zero;
  solution.minimizing = inertia.negative == 0 && (inertia.zero == 0 || problem.periodic);
  observe_energy(*solution.extension->lagrangian, solution);
  read_variation(problem, options, path, size, solution);
  solution.pinned = options.scheme.has_value();
  if (solution.pinned)
    solution.element_energies = element_energies(*solution.extension->lagrangian, own.scheme().node,
                                                 own.scheme().weight, solution.trajectory);
  return solution;
}

}  // namespace extremal
