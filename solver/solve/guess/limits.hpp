#pragma once

#include <cstddef>

/// \file The numbers of first paths.

namespace extremal::limits {

namespace first_path {

/// A path so much larger than the guess has run away.
inline constexpr double runaway = 100;

}  // namespace first_path

namespace loop {

/// Frequencies are taken from 2πk with k at most this.
inline constexpr int most_turns = 12;
/// Frequencies that differ less are one.
inline constexpr double same_frequency = 1e-6;
/// Of an eigenvalue of R: the modulus of others than symmetries differs from 1 by more.
inline constexpr double unit_modulus = 1e-6;
/// The constant part of a loop, in units of the moving part.
inline constexpr double offset = 0.3;
/// Points at which a loop is measured.
inline constexpr int samples = 96;
/// Steps of the size, two octaves of four steps either way from that of a guess, ten without one.
inline constexpr int steps_an_octave = 4, octaves_of_guess = 2, most_octaves = 10;

}  // namespace loop

namespace hamilton_path {

/// Elements of the collocation: their degree, and how many. A guess is wanted, no solution.
inline constexpr int degree = 3, fewest_elements = 16, most_elements = 64;
/// Values of coordinates and momenta at all nodes.
inline constexpr int most_values = 20'000;
/// Damping relative to the mean diagonal of the normal equations, and its changes.
inline constexpr double first_damping = 1e-5, least_damping = 1e-13, most_damping = 1e6;
inline constexpr double more_damping = 8, less_damping = 12;
inline constexpr int most_steps = 100;
/// Residuals relative to the largest coordinate: where steps end, and of what counts as solved. A step that
/// lowers it by less than this stalls.
inline constexpr double enough = 1e-10, solved_within = 1e-4, least_fall = 1e-3;

}  // namespace hamilton_path

}  // namespace extremal::limits
