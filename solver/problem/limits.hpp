#pragma once

/// \file The numbers by which problems are checked.

namespace extremal::limits {

namespace relation {

/// A remainder this small, relative to what it was formed from, counts as zero.
inline constexpr double dependence = 1e-11;

}  // namespace relation

namespace infinite_ends {

/// An end this near to an equilibrium, relative to its coordinates, is at it: scenes give as many digits.
inline constexpr double at_equilibrium = 1e-8;
/// In twice the time the distance of an equilibrium that is approached algebraically falls at least so far.
inline constexpr double approaching = 0.75;
/// Of the coordinates of an equilibrium: so far beside it rates are at most twice as large.
inline constexpr double beside = 1e-6;
/// Energies of rest that are equal but for roundoff of formulas.
inline constexpr double same_energy = 1e-9;
/// Of the coordinates of two points that are equal but for roundoff.
inline constexpr double same_point = 1e-12;
/// In so many times of the slowest decay a deviation falls to 6e-6: the square of that, by which the subspace
/// of the linear motion errs, is below most tolerances.
inline constexpr double decays = 12;
inline constexpr int most_doublings = 40;
/// Samples of the default guess.
inline constexpr int samples = 1024;

}  // namespace infinite_ends

namespace minimal {

/// Points of the guess that a chart gives back within this part of their size are those it was given.
inline constexpr double same_point = 1e-7;
/// Coefficients of relations that vanish but for this part.
inline constexpr double roundoff = 1e-12;

}  // namespace minimal

namespace singular_ends {

/// The exponent of the speed is read at distances of this part of the way, and so much nearer each time: next
/// to the level it is a power, farther from it the energy loses fewer digits.
inline constexpr double first_distance = 1e-3, nearer = 0.1;
inline constexpr int distances = 64;
/// So much nearer than there the momentum is read.
inline constexpr double gauge_distance = 1e-10;
inline constexpr int bisections = 60;
/// Of an exponent, from one distance to the next.
inline constexpr double exponent_change = 4e-3;
/// Beyond the largest one the integral of L is infinite; below the least one L is nearly finite.
inline constexpr double least_exponent = 0.02, largest_exponent = 0.98;
/// Denominators of simple fractions and of others; the errors of an exponent that is one of these, and that
/// of arithmetic. Distances from a level that have few digits in 106 bits, by the level.
inline constexpr int small_denominator = 16, most_denominator = 1000;
inline constexpr double whole = 3e-4, exact = 1e-10, roundoff = 1e-12, extended_roundoff = 1e-28;
/// Powers of the smooth variable that the time is, where powers of what is left are whole and where not; of
/// the latter, one that elements resolve.
inline constexpr int small_time = 5, least_time = 3, largest_time = 9;
inline constexpr double smooth_power = 1.6;
inline constexpr int most_coordinates = 16;
/// Samples of a guess in the new variables; sizes of it, by powers of two of the duration to both sides.
inline constexpr int guess_samples = 256, scanned_sizes = 24;
/// Where the rise of a guess is measured, by the duration.
inline constexpr double beside = 0.01;
/// Doublings of a speed that is looked for, in pairs.
inline constexpr int most_quadruplings = 40;

}  // namespace singular_ends

namespace singular_times {

/// Of the ends' size: a point in general position is so far from them.
inline constexpr double general = 0.3;
/// Times at which powers are read, by the duration: the shortest, also from T, where times have few digits,
/// the factor between them, and how many.
inline constexpr double nearest = 1e-12, nearest_to_end = 1e-8, shorter = 10;
inline constexpr int times = 4;
/// A mass that vanishes by a lower power is taken for regular; exponents are known to `exact`.
inline constexpr double least_exponent = 0.02, exact = 5e-4;
/// Of a part of L at the end by the same at a point in general position.
inline constexpr double roundoff = 1e-12;
/// k at least; as it is tried first, and taken where none serves; and at most. k |1 − a| at most.
inline constexpr int least_power = 2, usual_power = 4;
inline constexpr double most_power = 40, largest_power = 6.1;
/// A power of s that elements resolve as if it was whole, and one whose integral Gauss's rule resolves.
inline constexpr double smooth = 8, smooth_enough = 4;
/// Momenta may be infinite by this power of s: errors of the path are then as small in the action.
inline constexpr double steepest = 1.1;

}  // namespace singular_times

}  // namespace extremal::limits
