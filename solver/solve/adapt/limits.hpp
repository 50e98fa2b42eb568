#pragma once

#include <cstddef>

#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which elements are chosen and a path meets the tolerance.

namespace extremal::limits {

namespace pinned {

inline constexpr int most_points = 20;  ///< of the quadrature that counts as exact (DESIGN: S_h to 1e-15)
/// To move the default guess to where L is finite: bends, each by this part of the extent more.
inline constexpr unsigned most_bends = 8;
inline constexpr double bend_size = 0.1;
/// Of an element, by which a node is moved.
inline constexpr double node_noise = 0.3;
inline constexpr int most_elements = 1 << 20;
/// An error below amplified_roundoff, relative to the range, or below the second, relative to the values, is
/// roundoff if more elements reduce it by less than the first.
inline constexpr double stagnation = 0.9, at_roundoff = 1e-14;
/// Where an error is below the second, relative to the range, and so many times more elements did not reduce
/// it, more hardly will, unless few had stepped over something.
inline constexpr int futile_growth = 8;
inline constexpr double resolved = 1e-3;
inline constexpr int steps = 100;
/// Starting paths of homotopies to the equations of a scheme, from each that there is.
inline constexpr unsigned most_seeds = 24;
/// From an extremal to its companion, which is near or none.
inline constexpr int companion_steps = 25;
/// Of the times, in t/T, at which the companion crosses kinks.
inline constexpr double companion_misplacement = 1e-12;
/// Errors of q' may be so many tolerances, relative to its range.
inline constexpr double velocity_tolerances = 10;
/// Elements become at most so many times more at once.
inline constexpr double most_growth = 16;
/// An error within this factor of that predicted by its order falls regularly.
inline constexpr double regular_fall = 0.5;
/// Nanoseconds, by batch_cost(), after which no more elements are tried for a scheme that fails or is futile,
/// and no more of the steps that are dearer than others; or of one step.
inline constexpr double most_cost = 1e8;
/// Relative to the largest momentum; of periodic paths.
inline constexpr double stationary_residual = 1e-10;

}  // namespace pinned

namespace stationary_phase {

/// Of an element, that a path is shifted at a time, and how often in each sense.
inline constexpr double shift_part = 0.125;
inline constexpr int most_shifts = 4;
/// Steps to a zero of the force; a residual that needs none, relative to the largest momentum.
inline constexpr int most_zero_steps = 40;
inline constexpr double unforced = 1e-14;

}  // namespace stationary_phase

namespace scheme_equations {

/// An element becomes at most so many times shorter or longer in one step.
inline constexpr double most_stretch = 3;

}  // namespace scheme_equations

namespace residual_homotopy {

/// Equations hold to this, relative to the largest momentum, and of times to that times the largest velocity.
/// Where times are free, energies that differ little on fine elements are not equal yet: equations hold to
/// the second part of what is left at first, or to roundoff.
inline constexpr double solved = 1e-12, part_of_first = 1e-3, roundoff = 4e-15;
/// Of Newton's method, and what may be left after one of its steps.
inline constexpr int most_newton_steps = 12;
inline constexpr double worst_residual = 1;
/// To the next μ.
inline constexpr double least_way = 1e-2;
/// Lengths are relative: root mean square of values by the extent and of times by that of an element, and μ.
inline constexpr double first_length = 0.02, longest_length = 0.2, least_length = 1e-4;
/// The first correction is shorter than this part of the step, others by this factor than the one before,
/// unless they are shorter than the second part; the last is shorter than the third, or is roundoff and
/// shorter than the fourth. The curve turns by less than the angle with this cosine.
inline constexpr double longest_correction = 0.5, contraction = 0.5, close_to_curve = 0.02, corrected = 1e-5,
                        nearly = 1e-3, sharpest_turn = 0.9;
inline constexpr int most_corrections = 8;
/// Newton's method for μ = 0 is tried where μ has become so much smaller.
inline constexpr double leap = 0.7;
/// The next try after a step that failed is so much of it. A step that took no more linearisations is
/// followed by a longer one.
inline constexpr double shortening = 0.5, lengthening = 1.5;
inline constexpr int few_linearisations = 5;
/// Linearisations of one curve, and these times its unknowns.
inline constexpr int least_linearisations = 50, most_linearisations = 400;
inline constexpr double most_work = 3e6;
/// A curve has run away where the path is so much larger than its extent at first, or μ so large.
inline constexpr double runaway = 100, farthest = 1e3;

}  // namespace residual_homotopy

namespace refinement {

/// Elements at most, or so many times those of the first mesh: a path that needs more meets a singularity.
inline constexpr int most_elements = 1 << 12, most_cuts = 64;
/// Coarse elements have done their work when the path is known to this, relative to its range.
inline constexpr double coarse_goal = 1e-3;
/// A coarse element becomes at most so many at a time.
inline constexpr double coarse_cut = 4;
/// Steps allowed for one run of damped Newton.
inline constexpr int coarse_steps = 25, fine_steps = 12;
/// Times that a path may cross other kinks, or cross them elsewhere, after Newton's method.
inline constexpr int most_realignments = 12;
/// Times that elements are planned before all are halved.
inline constexpr int most_plans = 6;
/// An undamped step longer than this, relative to the path, casts doubt on the equations.
inline constexpr double suspicious_step = 1e6;
/// Nanoseconds, by batch_cost(), that one solve may take; or so many steps on the first mesh; and the factor
/// by which a guess that asks for more elements may raise it.
inline constexpr double most_cost = 1e8, most_first_steps = 200, most_cost_growth = 10;
/// Of a step, to fill a path.
inline constexpr double filling = 0.1;
/// Nanoseconds of a free end or duration, for each entry of the blocks of the nodes.
inline constexpr double border_cost = 2;
/// Tolerances that velocities are planned for: they may have ten, but slopes at the ends of elements are
/// harder to predict than those between.
inline constexpr double planned_slopes = 6;

}  // namespace refinement

namespace tolerance_test {

/// A force that holds the phase of a periodic path, relative to the largest momentum, is at most so large;
/// the least may be roundoff.
inline constexpr double most_phase_force = 1e-7, least_phase_force = 1e-10;
/// Errors of finer elements are less than this part of those before.
inline constexpr double element_fall = 0.25;
/// Of the size of the path that was started from: a path smaller than this is at rest.
inline constexpr double rest = 1e-12;
/// Of the range of velocities: that of momenta counts where inertia is not the same everywhere.
inline constexpr double much_less = 0.25;
/// Of roundoff that was measured.
inline constexpr double certain = 3;
/// Steps for the natural conditions, after Newton's method has converged.
inline constexpr int most_natural_steps = 4;
/// They use the factors there are as long as they contract so much.
inline constexpr double worst_chord = 0.5;

}  // namespace tolerance_test

}  // namespace extremal::limits
