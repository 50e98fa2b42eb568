#pragma once

#include <string>

#include "problem/problem.hpp"

/// \file Inequalities that no point keeps together.

namespace extremal {

/// Which inequalities contradict each other, when, and by how much; empty if none do. Points near the guess
/// at several times are moved to where what is missed is least. Nothing is proved far from them.
std::string incompatible_inequalities(const Problem& problem, const Guess& guess);

}  // namespace extremal
