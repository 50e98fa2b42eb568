#pragma once

/// \file The numbers that decide about solutions as they are read off.

namespace extremal::limits::on_manifold {

/// A node of a solution is no farther from the manifold than so many of its errors, and of roundings of its
/// largest coordinate.
inline constexpr double most_moved = 100, roundings = 1e-12;
/// Imaginary parts of the eigenvalues of a map of constraints below this are roundoff.
inline constexpr double real = 1e-6;

}  // namespace extremal::limits::on_manifold

namespace extremal::limits::minimal {

/// Between its nodes a polynomial of q differs from q(u) by no more than this part of the error of u, or of
/// the tolerance; else it gets a higher degree, by so much.
inline constexpr double between_nodes = 0.1;
inline constexpr int raise = 4;
/// Ends may miss their relation by this part of what stands in it: decimals that a scene gives.
inline constexpr double relation_missed = 1e-7;
/// Velocities meet so many tolerances relative to their range. What they integrate to differs from the change
/// of q by no more than so many errors, and so many roundings of the largest coordinate.
inline constexpr double velocity_share = 10, most_errors = 100, roundings = 1e-12;

}  // namespace extremal::limits::minimal

namespace extremal::limits::broken_node {

/// Roundings of L and of p·q', and of q.
inline constexpr double roundoff_of_terms = 1e-12, roundoff_of_q = 1e-14;
/// Of the speed: the cube root of a rounding.
inline constexpr double least_jump = 6e-6;

}  // namespace extremal::limits::broken_node
