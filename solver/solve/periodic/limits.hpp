#pragma once

#include <cstddef>

#include "machine/roundoff.hpp"

/// \file The numbers by which orbits are compared.

namespace extremal::limits {

namespace repetition {

/// Entries of R^m − 1 that are zero: R may come from a formula with as many digits.
inline constexpr double zero_entry = 1e-9;
inline constexpr int most_segments = 64;

}  // namespace repetition

namespace segment {

inline constexpr int most_parts = 12;
/// Candidates for one more symmetry.
inline constexpr int most_draws = 60;
/// Values of L at points of chance, relative.
inline constexpr double same = 1e-10;
inline constexpr int points = 8, most_points = 40;

}  // namespace segment

namespace equilibrium {

/// An orbit so much smaller than its guess has shrunk onto an equilibrium. Where L depends on t, a weak drive
/// makes small orbits that do not rest: only roundoff of the guess is none.
inline constexpr double at_rest = 1e-6, at_driven_rest = 1e-10;
/// With forces a turn of amplitude a gains or loses a part of about a² beside an equilibrium without
/// damping: paths there close as those of a family do. One that is so small against its guess is no orbit.
inline constexpr double at_undamped_rest = 1e-2;

}  // namespace equilibrium

namespace orbit_index {

/// Forces of a path that errs by ε of its extent change by some ε times this, relative: 3 for 1/r², more
/// where bodies are near.
inline constexpr double change_of_forces = 10;
/// However much a path errs, an eigenvalue that is not small is not zero.
inline constexpr double largest_change = 1e-3;
/// Squares of null fields differ: an eigenvalue may be so many times larger than those known and be zero.
inline constexpr double most_squares = 10;
/// Of an eigenvalue that is zero, relative to the sizes of pieces.
inline constexpr double roundoff = 32 * machine_epsilon;
/// Eigenvalues that are zero, though nothing explains it, are so many times smaller than others.
inline constexpr double apart = 30;
/// A symmetry that moves a path by less than this, relative to the terms that it is the sum of, does not.
inline constexpr double least_move = 1e-8;

}  // namespace orbit_index

namespace soft_shifts {

/// Speeds below this, relative to the largest, are rest.
inline constexpr double slowest = 1e-2;

}  // namespace soft_shifts

}  // namespace extremal::limits
