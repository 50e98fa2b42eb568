#pragma once

#include <string>

#include "analysis/multipliers.hpp"
#include "analysis/variation.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Whether a periodic orbit is stable.

namespace extremal {

/// How an orbit of a periodic problem closes, and the symmetries that move it; `relative_error` of its
/// coordinates.
ClosedOrbit closed_orbit(const Problem& problem, const Trajectory& trajectory, double relative_error);

/// The Floquet multipliers, of one copy where the problem is of two.
std::optional<Floquet> multipliers_of(const Problem& problem, const SecondVariation& variation,
                                      const ClosedOrbit& orbit);

/// Distances along a solution of `size` above this are not zero.
double distinct_distance(const Solution& solution, double size);

/// Sets the Floquet multipliers and the minimal period of a converged solution of a periodic problem.
/// `variation` was assembled for it, perhaps without success. `size` of the solution: that its error is
/// relative to. Returns whether, with forces and a free period, paths beside it close as well.
bool read_stability(const Problem& problem, const SecondVariation& variation, double size, Solution& solution,
                    bool vectors = true);

/// Of a periodic orbit beside which others close, in so many independent directions that no symmetry
/// explains.
std::string one_of_a_continuum(int directions);
/// Says so of a converged solution whose period is given, without forces.
void tell_continuum(const Problem& problem, Solution& solution);

/// Morse indices of a solution of a periodic problem run through 1, 2, … most times. Empty where they cannot
/// be told: see OrbitForm. Throws std::invalid_argument for another problem, or for a negative number.
std::vector<int> iterate_indices(const Problem& problem, const Solution& solution, int most);

}  // namespace extremal
