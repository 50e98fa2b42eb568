#pragma once

/// \file The numbers that decide while coordinates on a manifold are chosen.

namespace extremal::limits::polar {

/// Points beside the path at which second derivatives of constraints and rotations are compared.
inline constexpr int tries = 8;
/// Relative differences that are roundoff.
inline constexpr double roundoff = 1e-12;
/// Eigenvalues that vanish, relative to the largest; lengths that are equal.
inline constexpr double flat = 1e-9;
/// The distance from the centre does not fall below this part of the largest.
inline constexpr double least_radius = 0.2;
/// The least singular value of rows of length one that are independent.
inline constexpr double independent_rows = 0.1;
/// Directions that places of the guess determine, relative to the best one, when w is fitted to them; and at
/// least so many places for each number.
inline constexpr double fitted_rank = 1e-6;
inline constexpr int places_each = 2;
/// Of the time that a family has: where that leads nowhere, all coordinates are left.
inline constexpr double share_of_family = 0.4;
/// Planes of two coordinates are tried where a constraint has no more than this.
inline constexpr int most_coordinates_of_planes = 4;
/// Frames that are compared.
inline constexpr std::size_t most_frames = 12;

}  // namespace extremal::limits::polar

namespace extremal::limits::charts {

/// Points of a guess along which charts are compared.
inline constexpr std::size_t samples = 33;
/// The sine of the smallest angle between tangent spaces and directions of w: with less, u tells little of q.
/// Below the second one other directions than coordinates are tried, and taken where so many times better.
inline constexpr double least_quality = 0.2, turned_below = 0.5, better = 1.2;
/// Angles whose radius is to be found at each point cost more: they are taken where other coordinates are
/// worse by this factor.
inline constexpr double worth_of_spatial = 0.5;
/// Charts beside the best one that are tried where extremals leave it.
inline constexpr int most_others = 2;
/// |∂q/∂u| along a guess: with more the path may leave the chart, and u tells less of q. Where there are
/// several angles it may be so many times larger as these are many.
inline constexpr double most_stretch = 6;
/// Pivots, of rows of length one: one is no smaller than this part of the largest at the middle of the guess,
/// and nowhere smaller than this.
inline constexpr double threshold = 0.3, least_pivot = 0.05;
/// Entries that are smaller everywhere vanish.
inline constexpr double structural = 1e-12;

}  // namespace extremal::limits::charts
