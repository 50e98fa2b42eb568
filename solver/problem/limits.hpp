#pragma once

#include <cstddef>

/// \file The numbers by which problems are checked.

namespace extremal::limits {

namespace infinite_ends {

/// An end this near to an equilibrium, relative to its coordinates, is at it: scenes give as many digits.
inline constexpr double at_equilibrium = 1e-8;
/// In twice the time the distance of an equilibrium that is approached algebraically falls at least so far.
inline constexpr double approaching = 0.75;
/// Energies of rest that are equal but for roundoff of formulas.
inline constexpr double same_energy = 1e-9;
/// In so many times of the slowest decay a deviation falls to 6e-6: the square of that, by which the subspace
/// of the linear motion errs, is below most tolerances.
inline constexpr double decays = 12;
inline constexpr int most_doublings = 40;
/// Samples of the default guess.
inline constexpr int samples = 1024;
/// Coordinates of a place that are named.
inline constexpr std::size_t most_named = 6;

}  // namespace infinite_ends

}  // namespace extremal::limits
