#pragma once

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "system/formula.hpp"

namespace extremal {

/// Gives a constrained problem that is ready its like in minimal coordinates, where one chart has all of its
/// guess. Else leaves it as it is. `only`: L̃ has other natural conditions.
void put_minimal_coordinates(const SystemTable& table, const System& system, bool only, Problem& problem);

/// Whether a constrained problem has minimal coordinates in which L is finite along the guess and has a
/// regular mass matrix.
bool has_regular_chart(const Problem& problem);

}  // namespace extremal
