#pragma once

#include <optional>

#include "analysis/variation.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Morse index and nullity of closed paths, and of paths that rest.

namespace extremal {

/// Of the second variation under the relation of the ends: directions along which the action falls, and those
/// along which it does not change.
struct OrbitIndex {
  int negative = 0, null = 0;
};

/// From the pieces of the second variation, which resolve its Jacobi fields and minimise. Elements that
/// resolve the path need not: one that rests has few. `error` is that of the path, relative. Nothing where an
/// eigenvalue is neither zero for sure nor surely not.
std::optional<OrbitIndex> orbit_index(const Problem& problem, SecondVariation& variation,
                                      const Trajectory& path, double error);

/// Sets both numbers of a converged solution, or says in its message that they are not told.
void tell_index(const std::optional<OrbitIndex>& found, Solution& solution);
void read_index(const Problem& problem, SecondVariation& variation, double error, Solution& solution);

/// Negative squares on fields that turn their sign after a period: it changes where a pair of multipliers
/// passes −1. Nothing where it cannot be told.
std::optional<int> doubling_index(const Problem& problem, SecondVariation& variation);

}  // namespace extremal
