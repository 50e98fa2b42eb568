#pragma once

#include <functional>
#include <vector>

#include "machine/deadline.hpp"
#include "solve/external/displacement.hpp"
#include "solve/external/method.hpp"

/// \file Solvers of other libraries, applied to δS_h = 0.

namespace extremal {

/// Takes the path to where the method stops, which need not be an extremal, or until the deadline, or until
/// `count`, called for each iteration, says that there may be no more. Throws std::invalid_argument for a
/// method that this build lacks.
void run_external_solver(Method method, const Problem& problem, const ElementTables& tables, Path& path,
                         const Deadline& deadline, const std::function<bool()>& count);

/// The same by one of them, z = 0 in the beginning; the last z is left in z.
void solve_least_squares(Displacement& equations, std::vector<double>& z, const Deadline& deadline,
                         const std::function<bool()>& count);
void solve_interior_point(Displacement& equations, std::vector<double>& z, const Deadline& deadline,
                          const std::function<bool()>& count);

}  // namespace extremal
