#pragma once

/// \file The numbers that decide about solutions as they are read off.

namespace extremal::limits::on_manifold {

/// A node of a solution is no farther from the manifold than so many of its errors, and of roundings of its
/// largest coordinate.
inline constexpr double most_moved = 100, roundings = 1e-12;
/// Imaginary parts of the eigenvalues of a map of constraints below this are roundoff.
inline constexpr double real = 1e-6;

}  // namespace extremal::limits::on_manifold
