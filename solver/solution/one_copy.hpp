#pragma once

#include "solution/solution.hpp"

/// \file Solutions with forces, which are found with two copies of the coordinates.

namespace extremal {

/// The solution of a problem with forces, given that of its pair: one of the copies, with action and energy
/// of L and the work of the forces. What tells of the second variation is left out: with forces there is
/// none. `scheme`: whose quadrature integrates along the elements; null: a fine one.
Solution one_copy(const Problem& problem, Solution pair, const Scheme* scheme);

/// The largest difference of the two copies along a trajectory of both.
double difference_of_copies(const Trajectory& pair);

}  // namespace extremal
