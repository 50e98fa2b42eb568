#pragma once

#include <cstddef>

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

}  // namespace equilibrium

namespace soft_shifts {

/// Speeds below this, relative to the largest, are rest.
inline constexpr double slowest = 1e-2;

}  // namespace soft_shifts

}  // namespace extremal::limits
