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
inline constexpr int samples_a_decay = 8, samples_of_part = 256;
inline constexpr int quadrature_points = 12;
/// Corrections of the shift in time by which two paths differ.
inline constexpr int shift_steps = 4;
/// A path so much smaller than its guess, relative, is the equilibrium itself.
inline constexpr double shrunk = 1e-4;

}  // namespace infinite_solve

namespace phase_space {

/// What stationary paths may leave of Hamilton's equations, at least and in tolerances. Paths that are no
/// motions leave far more.
inline constexpr double least_defect = 1e-6, defect_tolerances = 1e3;
/// Momenta may err by so many tolerances of their range. A solve for their sake has no tighter tolerance.
inline constexpr double momentum_tolerances = 10, tightest_for_momenta = 1e-13;

}  // namespace phase_space

}  // namespace extremal::limits
