#pragma once

#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Layers at the end of the time, by the motion run backwards.

namespace extremal {

/// Whether motions may be run backwards, and vary faster at the end than times next to T can tell, but not at
/// the start. Next to t = 0 times have all their digits.
bool has_layer_at_end(const Problem& problem);

/// The problem with its ends exchanged, of a Lagrangian that reversal leaves unchanged.
Problem reversed(const Problem& problem);

/// The solution of a problem by that of the reversed one. Elements that times next to T cannot tell apart
/// become one.
Solution reversed(const Problem& problem, Solution solution);

}  // namespace extremal
