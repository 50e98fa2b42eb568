#pragma once

#include "solution/solution.hpp"

/// \file Solutions with forces, which are found with two copies of the coordinates.

namespace extremal {

/// The solution of a problem with forces, given that of its pair: one of the copies, with action and energy
/// of L and the work of the forces. What tells of the second variation is left out: with forces there is
/// none. `scheme`: whose quadrature integrates along the elements; null: a fine one.
Solution one_copy(const Problem& problem, Solution pair, const Scheme* scheme);

/// ∫ F·q' dt along a trajectory on the manifold of constraints. Where these depend on t its velocity has a
/// part across the manifold, along which forces work too.
double work_under_constraints(const Manifold& manifold, const Trajectory& trajectory);

/// The largest difference of the two copies along a trajectory of both.
double difference_of_copies(const Trajectory& pair);

}  // namespace extremal
