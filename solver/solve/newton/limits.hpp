#pragma once

#include <cstddef>

#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which Newton's method steps and ends.

namespace extremal::limits {

namespace converge {

/// A factorisation is used again while the simplified steps shrink at least so fast.
inline constexpr double chord_contraction = 0.2;
/// A first step that needs more is not trusted.
inline constexpr double mild_damping = 0.25;
/// Steps this short that stall, though gradients have digits to spare, lack digits of the factors.
inline constexpr double stalled_by_factors = 1e-5;

}  // namespace converge

namespace iteration {

/// Pivots this much smaller than the entry they came from are not trusted.
inline constexpr double breakdown = 1e-11;
/// Floating-point operations, elements times the cube of their unknowns, beyond which they are not.
inline constexpr double most_pivoted_work = 1e9;
/// Steps below this may fail to contract because they are roundoff; they are taken.
inline constexpr double roundoff_step = 1e-11;
/// Roundoff of a step is measured where one below the first stalls; a step that is no longer than so many
/// times it is no more.
inline constexpr double loudest = 1e-5, quiet = 10;
/// A step that is not tested may contract worse than any before by this factor; by so much it does. Steps of
/// another kind, as after finer elements, may be worse still: δS is taken to bend at least so much.
inline constexpr double worst_surprise = 30, surprise = 5, least_curvature = 1e3;
/// A model that is not the second variation must contract so much.
inline constexpr double worst_approximate = 0.5;
/// A simplified correction this much smaller than the step is worth taking.
inline constexpr double worth_taking = 0.3;

}  // namespace iteration

namespace resolve {

/// Newton's method converges where the second variation changes by less than this part along a step; the next
/// step is then shorter by as much (Kantorovich). It takes so many steps at most.
inline constexpr double most_change = 0.25;
inline constexpr int most_steps = 12;
/// A step, by the path, that is no roundoff.
inline constexpr double last_step = unit_roundoff / 64;

}  // namespace resolve

namespace iteration_measures {

/// Time of one more damping tried, by that of a step.
inline constexpr double trial_burden = 0.4;
/// Time of a step where the nodes of n coordinates are pivoted, again for each null direction: one at a time
/// where plain steps take as many elements together as there are lanes. Measured: 50 for n = 2, 10 from n = 4
/// on.
constexpr double pivoted_burden(double n) { return 10 + 160 / (n * n); }
/// Time of a step where all unknowns are.
inline constexpr double sparse_burden = 1000;
/// Roundoff of a step is the most that so many shifts make of it: one may meet little by chance.
inline constexpr int shifts = 3;
/// Of two terms that cancel one is rounded, to half a unit on average.
inline constexpr double half_a_digit = unit_roundoff / 2, half_an_extended_digit = extended_roundoff;
/// Times are known to so much of T: t is rounded, and so is t/T, at both ends of an element.
inline constexpr double last_digits = 4 * unit_roundoff;
/// Nodes are moved by as many roundings of the largest |q|.
inline constexpr double moved_digits = 8 * unit_roundoff;

}  // namespace iteration_measures

namespace krylov {

/// Of the step: Newton's method needs no more of its digits.
inline constexpr double enough = 1e-3;
inline constexpr int most_iterations = 24;

}  // namespace krylov

namespace extended_system {

/// Passes that scale rows and columns to a largest entry of about 1.
inline constexpr int equilibrations = 3;
/// Of the scaled border: a smaller pivot is null.
inline constexpr double null_pivot = 1e-22;

}  // namespace extended_system

namespace moving_step {

/// Of an element: a shift in time below this leaves values at fixed times linear.
inline constexpr double least_part = 1e-5;
/// An element becomes longer or shorter by less than this part.
inline constexpr double most_stretch = 0.5;

}  // namespace moving_step

namespace node_system {

/// Of the size of the terms that a row of the border is the difference of.
inline constexpr double negligible = 1e-10;
/// Null directions of the chain, by coordinates, that are believed.
inline constexpr std::size_t most_deflated = 4;
/// An end whose part of the second variation is this much smaller than that of others has units of its own.
inline constexpr double light_end = 1e-2;

}  // namespace node_system

namespace residual_test {

/// A residual below this, relative to the largest momentum, may be roundoff.
inline constexpr double least = 1e-10;

}  // namespace residual_test

namespace sparse_border {

/// Directions that differ from those before them by less than this are left to the least-squares solution.
inline constexpr double dependent = 1e-10;

}  // namespace sparse_border

namespace zero_eigenvalue {

/// An eigenvalue of a path that errs by ε of its extent errs by ε times the relative change of the second
/// derivatives of L, which is about 3 for a force 1/r².
inline constexpr double change = 3;
/// However much a path errs, an eigenvalue that is not small is not zero.
inline constexpr double largest_zero = 1e-3;
/// Of an elimination, if all are in one sense.
inline constexpr double roundings_an_element = 16;

}  // namespace zero_eigenvalue

}  // namespace extremal::limits
