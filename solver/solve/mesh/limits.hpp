#pragma once

#include <cstddef>

#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which elements are measured and planned.

namespace extremal::limits {

namespace conservation {

/// Ratio of the drift to the errors that explain it.
inline constexpr double margin = 10;
/// Roundings of the terms of the energy, one for each that is summed up, and of q.
inline constexpr double roundoff_of_terms = 2e3 * unit_roundoff, roundoff_of_q = 8 * unit_roundoff;

}  // namespace conservation

namespace plan {

/// Spare elements, since densities are estimates.
inline constexpr double spare = 1.1;
/// Another mesh must promise to be so much cheaper: the path has to be moved to it, and its distances are
/// less certain than the measure of the present elements.
inline constexpr double worth_moving = 0.75;
/// A batch of elements up to this degree is not worth planning again.
inline constexpr int cheap_degree = 10;

}  // namespace plan

namespace resolution {

/// Coefficients are known to so many roundings of the extent of their element.
inline constexpr double noise = 8 * unit_roundoff;
/// Squares of how much smaller one coefficient may be expected than the last, of all coordinates together.
/// Where all of one is in the coefficients before, another's seem to fall faster than they do: what falls by
/// more than `fast` is judged by the coordinate with the largest of the last.
inline constexpr double fastest = 1e-6, fast = 1e-4, slowest = 0.95;
/// A range this much smaller than the coordinates is roundoff.
inline constexpr double negligible = 1e-12;
/// Velocities are not asked for more digits than this share of the mean speed gives.
inline constexpr double nearly_uniform = 1e-3;

}  // namespace resolution

namespace kinks {

/// Of T: crossings are known no better.
inline constexpr double least_misplacement = 1e-13;
/// Of the shorter element beside a node: a crossing nearer than this is that at the node.
inline constexpr double at_node = 0.1;
/// The shortest element beside T has this times s², over the tolerance, of T: its slopes err by ε s²/h.
inline constexpr double slope_roundoff = 3e-18;

}  // namespace kinks

namespace overlooked {

/// Steps in which forces are looked for that elements overlook, at least; elements of no more than so many
/// see them.
inline constexpr int least_steps = 4096;
inline constexpr double steps_an_element = 4;
/// Between its points, an element is so many cubics by its degree.
inline constexpr int cubics_a_degree = 2;
/// Of the change of momentum in a step and the one before, what its middle may not tell; and parts of the
/// largest momentum of one coordinate, and of all, that are roundoff.
inline constexpr double far = 0.5, momentum_noise = 1e-6, rounded_off = 1e-12;

}  // namespace overlooked

}  // namespace extremal::limits
