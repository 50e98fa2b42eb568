#pragma once

/// \file The numbers that decide while constraints and ends are made to agree.

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
