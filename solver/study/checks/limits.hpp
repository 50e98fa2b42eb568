#pragma once

/// \file The numbers that decide while a scene is checked.

namespace extremal::limits::regularity {

/// Points about the guess that are tried, and how many where the mass is finite and singular tell that it is
/// so everywhere. For a length an identity is tested besides.
inline constexpr int tries = 64, telling = 3, telling_of_lengths = 8;
/// Coordinates up to which eigenvalues of the mass are taken.
inline constexpr int largest_dense = 200;
/// Of eigenvalues in comparable units: roundoff of products of a hundred terms is below.
inline constexpr double singular = 1e-12;
/// q'·∂L/∂q' = L holds within this part of L.
inline constexpr double homogeneous = 1e-10;

}  // namespace extremal::limits::regularity

namespace extremal::limits::continuity {

/// Points about the guess from which a surface is looked for, and how many on it tell.
inline constexpr int tries = 32, telling = 4;
inline constexpr int most_steps = 20;
/// Of the state, relative: a surface is reached this closely.
inline constexpr double on_surface = 1e-12;
/// Distances from it, relative to the state: between them a term |u|^a falls to 10^-4a, a jump stays within
/// this part.
inline constexpr double farther = 1e-5, nearer = 1e-9, stays = 1e-2;
/// Jumps below this part of L are roundoff.
inline constexpr double least_jump = 1e-9;

}  // namespace extremal::limits::continuity
