#pragma once

#include <optional>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"

namespace extremal {

/// A guess for a problem in phase space that nearly solves Hamilton's equations, with its duration: their
/// collocation at Gauss's points, with the boundary relation, natural conditions and what closes the
/// duration, solved from the problem's own guess by the method of Levenberg and Marquardt (Marquardt, J. SIAM
/// 11 (1963) 431). These equations are as many as their unknowns, and steps are damped where they are
/// singular. Nothing where there is no guess, where it leads to no solution or, for a closed path, to a rest,
/// or where the equations are too many.
std::optional<Problem> near_hamilton_path(const Problem& problem, const Deadline& deadline);

}  // namespace extremal
