#pragma once

/// \file The numbers that decide while a scene becomes a problem.

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

namespace extremal::limits::regularity {

/// Points about the guess that are tried, and how many where the mass is finite and singular tell that it is
/// so everywhere. For a length an identity is tested besides.
inline constexpr int tries = 64, telling = 3, telling_of_lengths = 8;
/// Coordinates up to which eigenvalues of the mass are taken.
inline constexpr int largest_dense = 200;
/// Of eigenvalues in comparable units: roundoff of products of a hundred terms is below.
inline constexpr double singular = 1e-12;
/// q'·∂L/∂q' = L holds within this part of L.
inline constexpr double homogeneous = 1e-10;

}  // namespace extremal::limits::regularity

namespace extremal::limits::continuity {

/// Points about the guess from which a surface is looked for, and how many on it tell.
inline constexpr int tries = 32, telling = 4;
inline constexpr int most_steps = 20;
/// Of the state, relative: a surface is reached this closely.
inline constexpr double on_surface = 1e-12;
/// Distances from it, relative to the state: between them a term |u|^a falls to 10^-4a, a jump stays within
/// this part.
inline constexpr double farther = 1e-5, nearer = 1e-9, stays = 1e-2;
/// Jumps below this part of L are roundoff.
inline constexpr double least_jump = 1e-9;

}  // namespace extremal::limits::continuity

namespace extremal::limits::constraints {

/// Expressions of L̃ are dense in the coordinates: their Hessian has (2n)² entries that each hold all
/// constraints.
inline constexpr int most_coordinates = 64;
/// ω T between ends: what is beside the manifold costs more than the forces of constraints gain there.
/// Motions from initial data, which would be amplified so, have less.
inline constexpr double growth = 12, growth_of_motions = 1;
/// Points beside the surfaces of inequalities, at this part of the size of the guess, at which those of
/// closed paths are compared with those one period later.
inline constexpr int closing_points = 16;
inline constexpr double closing_distance = 1e-5;
/// Points about the guess at which masses are compared.
inline constexpr int mass_points = 16;
/// A mass matrix nearer to singular is no metric.
inline constexpr double least_rcond = 1e-10;
/// Ends may miss the manifold by so much of the largest coordinate: decimals that a scene gives.
inline constexpr double end_distance = 1e-8;
/// Singular values below this, relative, are roundoff.
inline constexpr double rank = 1e-9;
/// Of the size of the ends: beside them, where nothing is special.
inline constexpr double aside_part = 0.01;
/// A point comes back from there where less than this part of the way remains.
inline constexpr double part_come_back = 1e-3;
/// Of what conditions on ends say of points of the manifold, in the units of q: less follows from the others.
inline constexpr double dependent_condition = 1e-7;
/// Gradients of unit length that depend on each other leave so much.
inline constexpr double dependence = 1e-9;
/// A part of the largest momentum that may be normal to the manifold: decimals that a scene gives.
inline constexpr double normal_momentum = 1e-7;
/// A part of the momentum that crosses the size of the ends in the duration.
inline constexpr double negligible_momentum = 1e-12;
/// Equal steps of a default guess.
inline constexpr int guess_steps = 256;
/// A guess that is moved onto the manifold jumps if one of its steps is this part of its length.
inline constexpr double jump = 0.2;
/// Where the line between the ends cannot be moved onto the manifold, or jumps, it is bent by these parts of
/// its size.
inline constexpr double bends[] = {0, 0.1, -0.1, 0.3, -0.3, 1, -1, 3, -3};

}  // namespace extremal::limits::constraints

namespace extremal::limits::contradiction {

/// Equal parts of a guess at whose ends constraints are tried, at so many points about each, the first one
/// itself.
inline constexpr int parts = 4, tries = 3;
/// Steps onto the constraints before one; steps toward it along them, down to this part of Newton's, as long
/// as what it is missed by falls by this part.
inline constexpr int most_corrections = 50, most_approaches = 200;
inline constexpr double least_part = 1e-9, least_fall = 1e-9;

}  // namespace extremal::limits::contradiction

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
