#pragma once

/// \file The numbers of the front door.

namespace extremal::limits {

namespace infinite_solve {

/// The linear motion beyond an end errs by the square of the deviation there. That square is made this part
/// of the tolerance, relative to the range of the path.
inline constexpr double wanted_error = 0.01;
/// Part of the tolerance that the infinite ends may take.
inline constexpr double most_error = 0.3;
/// Each lengthening makes the deviation at the ends at least so many times smaller, and with it the error.
inline constexpr double lengthening_factor = 10;
/// Lengthenings in times of the slowest decay, the longest and those tried on a guess.
inline constexpr double most_decays = 20;
inline constexpr double lengthenings[] = {3, 8};
inline constexpr int most_lengthenings = 12;
/// Where that fails, lengthenings grow by these factors: between two nearly conjugate times elimination loses
/// digits.
inline constexpr double further[] = {1, 1.7, 2};
/// Deviations so small, relative to the range, fall no further: roundoff.
inline constexpr double at_rest = 1e-12;
/// Short durations between fixed ends, in times of the slowest decay, an infinite end each; what is added to
/// them then.
inline constexpr double short_durations[] = {4, 2.5, 7, 12};
inline constexpr double kept_decays = 12;
/// Sizes of a guess from 2⁻⁴ to 2⁴ and rates from 1/8 to 8 among which one near a pass of the action is
/// looked for; points of the integral, and of the guess that is made.
inline constexpr int scan_sizes = 16, scan_rates = 6, scan_samples = 160, samples_of_resized = 1024;
/// Shifts of the guess among which the action is stationary, their distances, and how closely one is found,
/// in parts of its duration.
inline constexpr double most_shift = 0.75, shift_step = 1.0 / 64, least_shift = 1e-3;
inline constexpr int samples_a_decay = 8, samples_of_part = 256;
inline constexpr int quadrature_points = 12;
/// Corrections of the shift in time by which two paths differ.
inline constexpr int shift_steps = 4;
/// A path so much smaller than its guess, relative, is the equilibrium itself.
inline constexpr double shrunk = 1e-4;

}  // namespace infinite_solve

namespace phase_space {

/// What stationary paths may leave of Hamilton's equations, at least, in tolerances, and at most. Paths that
/// are no motions leave far more.
inline constexpr double least_defect = 1e-6, defect_tolerances = 1e3, most_defect = 0.05;
/// Momenta may err by so many tolerances of their range. A solve for their sake has no tighter tolerance.
inline constexpr double momentum_tolerances = 10, tightest_for_momenta = 1e-13;

}  // namespace phase_space

namespace minimal_solve {

/// Of the time there is, what minimal coordinates may take: beside a chart the other way is left.
inline constexpr double share = 0.3;
/// Tolerance of a march that is to tell whether a motion stays in the chart.
inline constexpr double coarse = 1e-4;

}  // namespace minimal_solve

namespace reversed_solve {

/// Motions that vary in a shorter part of T next to the end are run backwards: times next to T differ by
/// 1e-16 of it, and a layer has many elements.
inline constexpr double thinnest = 1e-14;
/// The last element of a path whose layer no time can tell, by T.
inline constexpr double least_length = 1e-15;

}  // namespace reversed_solve

namespace singular_solve {

/// The nearer of two distances from an end, by the duration, and how much farther the other is: between them
/// s L̃ falls by less than this where L̃ has a pole.
inline constexpr double pole_part = 2e-3, pole_farther = 10, pole_fall = 0.5;

/// Elements of a path in t towards a singular end: each is this part of the time to it, so that powers of
/// the time are polynomials of this degree to 1e-12.
inline constexpr double shrinking = 0.5;
inline constexpr int degree = 16;
/// The first one and the last one, by the duration; times near T have fewer digits.
inline constexpr double nearest = 1e-18, nearest_to_end = 1e-14;
/// Instants nearer to each other than this part of their distance from an end are one.
inline constexpr double least_gap = 1e-3;
/// Of a free duration: its first change and the largest one, as factors; durations tried; a change that is
/// none, in tolerances.
inline constexpr double first_change = 1.01, largest_change = 2;
inline constexpr int most_durations = 60;
inline constexpr double same_duration = 1e-3;
/// What closes it holds to so many tolerances.
inline constexpr double closing_tolerances = 10;

}  // namespace singular_solve

}  // namespace extremal::limits
