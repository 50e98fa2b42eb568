#pragma once

#include "solve/mesh/conservation.hpp"
#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which a path is accepted or refused.

namespace extremal::limits {

namespace acceptance {

/// A residual under the finer quadrature grows by no more from a part of an orbit to the whole.
inline constexpr double residual_growth = 10;
/// Part of T within which a time conjugate to 0 is T, if ends are conjugate.
inline constexpr double conjugate_end = 1e-5;
/// With free ends, the part of T within which a time conjugate to 0 is T: the error of the path relative to
/// its size, not less than roundoff and not more than what a coarse scheme leaves.
inline constexpr double least_blur = 1e-13, largest_blur = 1e-3;
/// Two copies of the coordinates that agree differ by roundoff, relative to the largest coordinate.
inline constexpr double most_difference_of_copies = 1e-8;
/// A drift of the energy that looks like an error, relative to the energy or to the mean of L. Drifts are
/// small if they are less than this part of the terms.
inline constexpr double noticed_drift = 1e-6;
/// Of the first or the last element, what is left of it where it is cut.
inline constexpr double shorter_end = 0.125;

}  // namespace acceptance

namespace conditions {

/// Residuals above this, relative to the largest momentum, must be roundoff of strong forces.
inline constexpr double largest_residual = 1e-6;
/// Strong forces sum up a hundred times as many terms as those that cancel along a body at rest.
inline constexpr double strong_force_roundoff = 100 * force_roundoff;
/// The closing equation holds to so many tolerances, or to this, relative to its terms; or to roundoff of the
/// energies along the path.
inline constexpr double closing_tolerances = 10, least_closing = 1e-6, closing_roundoff = 1e-13;
/// A duration this much longer than the guess's has run away.
inline constexpr double longest_duration = 1e6;
/// Forces that hold closed paths, in tolerances of the range of momenta: a small part of
/// momentum_tolerances, or the paths are no family.
inline constexpr double held_tolerances = 0.1;
/// Momenta may jump by so many times their error: that is an estimate.
inline constexpr double jump_margin = 10;

}  // namespace conditions

namespace conjugate_ends {

/// T within this of a conjugate time, relative, is one however accurate the trajectory is.
inline constexpr double least_distance = 1e-13;
/// A trajectory known no better than this does not make ends conjugate that are not.
inline constexpr double largest_distance = 1e-5;
/// Nearer than this, relative, the error of the elements is measured anew.
inline constexpr double near = 1e-2;
/// Of a path that did not converge, so near a conjugate time is no accident.
inline constexpr double suspicious = 1e-6;
/// A path that failed on more elements is not resolved: its second variation would take long and be
/// no measure.
inline constexpr int most_elements = 512;
/// With more coordinates a solve that failed is not examined for conjugate ends: the work grows with their
/// fourth power, and took half a minute for 100.
inline constexpr int most_examined = 40;
/// Roundoff of the elements' lengths, half a rounding on average, which acts as one of T.
inline constexpr double roundoff = unit_roundoff / 2;
inline constexpr int finer = 3, steps = 12;

}  // namespace conjugate_ends

namespace failure {

/// Singular mass matrices of more coordinates are not looked for.
inline constexpr int most_coordinates = 64;
/// How far beside a point, relative, its mass matrix is looked at too.
inline constexpr double aside = 0.01;

}  // namespace failure

namespace branches {

/// Steps along a curve, by the distance between the ends, or from the end where that is longer; how far from
/// the start it is left.
inline constexpr double first_step = 1e-3, least_step = 1e-9, longest_step = 0.1, far = 1e4;
inline constexpr int most_steps = 20'000;
/// Cosines of the turn of a step: less is too much, more allows a longer one.
inline constexpr double least_cosine = 0.98, quiet_cosine = 0.999;
/// Of a chord: an end nearer to it may be on the curve; the curve has returned to a start that is nearer than
/// an arc with the largest turn bulges, 1/8 of the angle.
inline constexpr double beside = 0.2, bulge = 0.03;

}  // namespace branches

namespace isolation {

/// Errors are estimates: they may be larger by so much.
inline constexpr double honest = 10;
/// Of the degree of elements that decide.
inline constexpr int raised = 2;
/// An eigenvalue, by the diagonal, that may be of roundings.
inline constexpr double roundoff = 64 * unit_roundoff;

}  // namespace isolation

namespace minimality {

/// Of the degree of elements that confirm an index.
inline constexpr int confirming = 2;

}  // namespace minimality

namespace quadrature_check {

/// Largest ratio of an error to its estimate.
inline constexpr double honest = 10;
/// Tolerances that velocities may change by: ten, and that is an estimate.
inline constexpr double most_turned = honest * momentum_tolerances;
/// Symmetries of more take too long to find.
inline constexpr int most_coordinates = 18;
/// Points about which symmetries are looked for.
inline constexpr int guess_points = 32;

}  // namespace quadrature_check

namespace sparse_windows {

/// Elements of the first trial for the first window; windows are about as long as the one before; none is
/// shorter than this part of an element.
inline constexpr double first_trial = 4, like_the_last = 1.25, shortest = 1e-3;
/// By which a window is shorter than the longest one at most, relative.
inline constexpr double margin = 1e-3;
/// Steps of inverse iteration to the field that vanishes at both ends of a window, and what elements may
/// leave out of it, relative: the window errs by about the square.
inline constexpr int inverse_steps = 3;
inline constexpr double most_left_out = 1e-2;
/// Of so many trials one halves what is left, that the others may not.
inline constexpr int most_by_slope = 4;

}  // namespace sparse_windows

}  // namespace extremal::limits
