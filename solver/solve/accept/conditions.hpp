#pragma once

#include <optional>
#include <string>

#include "solution/observe.hpp"
#include "solve/adapt/outcome.hpp"
#include "solve/newton/iteration.hpp"

/// \file Conditions that an extremal satisfies.

namespace extremal {

/// Why a path is no extremal.
struct Refusal {
  Status status;
  std::string message;
  bool hopeless = false;  ///< other guesses would lead to a path as bad
};

/// Of the equations at the path that the iteration factored last and `solution` was read off: action and
/// residual are finite, forces balance, and the equation that closes a free duration holds.
/// A closed orbit is larger than a point.
std::optional<Refusal> equations_fail(const Problem& problem, const SolveOptions& options,
                                      const Outcome& outcome, const Path& path, NewtonIteration& newton,
                                      const Solution& solution);

/// Of the elements: energy drifts no more than the error explains, the residual of free ends is within the
/// error allowed of momenta, and a path away from the guess is not singular. Raises the error estimate of
/// `solution` where the drift shows a larger one. `found`: absent where L depends on t.
std::optional<Refusal> elements_fail(const Problem& problem, const SolveOptions& options,
                                     const Outcome& outcome, const Path& path,
                                     const std::optional<Survey>& found, const DiscreteAction& action,
                                     Solution& solution);

/// Of the nodes between the elements first, …, last − 1, and T of a closed path: none is broken
/// (solution/broken_node.hpp).
std::optional<Refusal> has_broken_node(const Problem& problem, const Lagrangian& lagrangian,
                                       const Trajectory& trajectory, int first, int last);

/// For the energy of a path that drifts by more than its error explains.
Refusal energy_drifts(double drift, double tolerance);

/// Two copies of the coordinates that differ are no motion with forces. `size`: of the path.
std::optional<Refusal> copies_differ(const Trajectory& pair, double size);

}  // namespace extremal
