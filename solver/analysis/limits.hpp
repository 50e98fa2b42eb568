#pragma once

/// \file The numbers that decide in the analysis of large systems.

namespace extremal::limits {

namespace falling_form {

/// Chebyshev's points at which a form is sampled, and the error that they may leave at the end of its
/// interval, relative: with the value there the error inside is some ten times smaller, and that of the
/// zeros.
inline constexpr int form_samples = 16;
inline constexpr double most_form_error = 3e-10;
/// Points of a part of the interval, the error that they may leave there, and the zeros for which it pays to
/// sample the part.
inline constexpr int part_samples = 8, part_zeros = 4;
inline constexpr double most_part_error = 1e-12;
/// Of a zero, relative to the end of the interval.
inline constexpr double zero_resolution = 1e-13;
/// Steps of safeguarded iteration to one zero: they converge quadratically, once the cosine of the angle
/// between a vector and the next is so large.
inline constexpr int most_zero_steps = 16;
inline constexpr double least_along = 0.5;
/// Of the differences for the slope of a form, relative to the time since the start of its interval.
inline constexpr double slope_step = 1e-4;

}  // namespace falling_form

namespace jacobi {

/// From so many coordinates on, forms are eliminated by blocks, and conjugate times in a piece found
/// together.
inline constexpr int least_large = 12;
/// Vectors and steps of inverse iteration to the eigenvalue that is nearest zero at the end.
inline constexpr int end_vectors = 4, end_steps = 6;

}  // namespace jacobi

namespace variation {

/// Doubles of the forms of all pieces, and of a batch of elements on which they are evaluated, at most. If
/// there are more pieces, forms are evaluated when they are needed.
inline constexpr double most_forms = 1 << 27, most_batch = 1 << 28;

}  // namespace variation

namespace windows {

/// Up to so many coordinates all conjugate times are found; for more where their number and that of `forms`
/// for each element, times the cube of the coordinates, is no more than this: about a second.
inline constexpr int always_found = 128, forms = 4;
inline constexpr double most_work = 5e9;

}  // namespace windows

}  // namespace extremal::limits
