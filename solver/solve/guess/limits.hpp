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

}  // namespace extremal::limits
