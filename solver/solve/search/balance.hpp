#pragma once

#include <optional>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file Where in time a path belongs that leaves one equilibrium and comes to another.

namespace extremal {

/// By how much t the inner part of a path between two fixed equilibria must be shifted for energies at both
/// ends to agree. There the speed decays as e^−rt, r² = dᵀL_qq d / dᵀL_q'q' d for a deviation d from the
/// equilibrium, beyond what doubles resolve. Nothing if the path does not rest at both ends, or L depends on
/// t.
std::optional<double> shift_to_balance(const Problem& problem, const Path& path);

/// Shifts it by stretching and compressing the elements of the rests. False, and nothing is done, if those
/// are too short.
bool shift_in_time(const Problem& problem, double shift, Path& path);

}  // namespace extremal
