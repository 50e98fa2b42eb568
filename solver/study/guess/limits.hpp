#pragma once

/// \file The numbers that decide while a guess is made of what a scene gives.

namespace extremal::limits::closing_correction {

/// Of the integrator's steps, relative: Newton's method needs no more digits of its matrix.
inline constexpr double step_error = 1e-15;
/// Singular values are trusted from so many times the error of the matrix on: those along symmetries are
/// roundoff.
inline constexpr double certain = 30;
/// Halves that miss each other by less, relative, need no correction: Newton's method for the action closes
/// them as well, at less expense.
inline constexpr double easily_closed = 1e-9;
/// Nor do those that were corrected, by less.
inline constexpr double closed_well = 1e-13;
/// Halves that miss each other by more are no orbit: the last of ten digits of a state would have to be
/// amplified a billion times.
inline constexpr double most_apart = 0.1;
/// Of a state, relative: corrections this short are those of the last digits of doubles, which nodes have.
inline constexpr double last_digits = 1e-14;
/// A correction must be this much shorter than the last; if not by the second, variations are integrated
/// anew.
inline constexpr double least_gain = 0.8, good_gain = 0.1;
inline constexpr int most_corrections = 8;

}  // namespace extremal::limits::closing_correction

namespace extremal::limits::return_time {

/// Steps to the time of a return, the least fall of the squared distance that a step brings, and how far from
/// the duration that is given it may be, relative.
inline constexpr int most_returns = 4;
inline constexpr double gain = 0.25, farthest = 0.1;

}  // namespace extremal::limits::return_time
