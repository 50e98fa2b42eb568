#pragma once

#include <cstddef>

#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which a curve of extremals is traced to the problem.

namespace extremal::limits {

namespace comoving {

/// Of (δh/h)² against (δq)²/extent². Much less lets meshes degenerate where there is one coordinate: all of
/// its changes are along the path.
inline constexpr double strain_weight = 3;

}  // namespace comoving

namespace duration_homotopy {

/// Durations that are looked at: so many octaves either side, in quarters.
inline constexpr int octaves = 6;
/// Forces that bend a path by less than this, relative to its range, leave it nearly as it is.
inline constexpr double slight = 0.2;
/// A duration is natural if the path is not further from a motion than this times the least distance.
inline constexpr double nearly_least = 1.3;
inline constexpr std::size_t most_durations = 4;
/// As T → 0: this much of the wanted duration.
inline constexpr double instant = 1e-4;

}  // namespace duration_homotopy

namespace end_homotopy {

/// A displacement for difference quotients, in units of the extent.
inline constexpr double small = 1e-6;

}  // namespace end_homotopy

namespace homotopy {

/// Lengths are relative: root mean square over the nodes by the path's range, and the parameter by its unit.
inline constexpr double first_length = 0.1, least_length = 1e-5, largest_approach = 0.2;
inline constexpr double on_curve = 1e-2, close_to_curve = 1e-3, farthest_landing = 0.05, landed = 1e-5;
/// Of the last correction, by the length of the step: where the second variation is nearly singular, the
/// remainder makes the tangent turn.
inline constexpr double corrected = 3e-3;
/// An element keeps so much of its length in one move.
inline constexpr double least_element = 0.3;
/// A step is refused where corrections shrink less than this, are longer than this part of it, or where the
/// family turns by more than the angle with this cosine. The next try is so much of it.
inline constexpr double contraction = 0.5, longest_correction = 0.5, sharpest_turn = 0.9, shortening = 0.4;
/// A step grows by a factor where the cosine of the angle by which it turned is more than a bound, less after
/// more linearisations than these.
inline constexpr double straight = 0.98, growth_if_straight = 2, bent = 0.93, growth_if_bent = 1.4;
inline constexpr int few_steps = 2;
inline constexpr double slowdown = 0.7;
inline constexpr int refusals_before_polish = 2;
inline constexpr int most_corrections = 4, most_landings = 8, most_approaches = 25;
/// The family has run away where the path is so much larger than at first, or the parameter so many units
/// off, and further than at first.
inline constexpr double runaway = 1e3, farthest = 4;
/// Truncation error at which elements are chosen anew, and the aim then; relative to the range.
inline constexpr double unresolved = 1e-5, resolved = 1e-7;
inline constexpr int most_elements = 256;
inline constexpr double strongest_cut = 4;

}  // namespace homotopy

namespace weakened_lagrangian {

/// Points whose derivatives are averaged; halvings for their places.
inline constexpr int samples = 512, bisections = 50;

}  // namespace weakened_lagrangian

}  // namespace extremal::limits
