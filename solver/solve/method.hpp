#pragma once

#include <functional>

#include "solve/displacement.hpp"
#include "solve/solve.hpp"

/// \file Solvers of other libraries, where they lead from a guess.

namespace extremal {

/// In a few words.
const char* description(Method method);

/// Takes the path to where the method comes to rest, which need not be an extremal, or until `count`, called
/// for each iteration, says that there may be no more. Throws std::invalid_argument for one that this build
/// lacks.
void lead(Method method, const Problem& problem, const ElementTables& tables, Path& path,
          const std::function<bool()>& count);

/// The same by one of them, z = 0 in the beginning; what it arrives at stays in z.
void solve_least_squares(Displacement& equations, std::vector<double>& z, const std::function<bool()>& count);
void solve_interior_point(Displacement& equations, std::vector<double>& z,
                          const std::function<bool()>& count);

}  // namespace extremal
