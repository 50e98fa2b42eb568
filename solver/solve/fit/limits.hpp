#pragma once

/// \file The numbers by which a fit ends.

namespace extremal::limits::fit {

/// Elements are chosen anew at most so often.
inline constexpr int most_rounds = 5;
/// Of the path that is found together with the unknowns: the degrees of its elements in turn, how many there
/// are at least and at most, and their length in units of 1/ω, ω the local frequency along the guess.
inline constexpr int whole_path_degrees[] = {4, 12}, sketch_elements = 16, most_elements = 1 << 11;
inline constexpr double longest_element = 2.0;
/// It is known well enough when a step is shorter than this, relative to the path. Steps are damped to this
/// part at most.
inline constexpr double short_step = 1e-7, strongest_damping = 1e-3;
/// Of Newton's method from the extremal before, predicted by its derivatives.
inline constexpr int most_newton_steps = 12;
/// Trust regions to begin with: the second makes the first step a tenth of that of Gauss and Newton.
inline constexpr double first_radii[] = {1e4, 0.1};
/// Singular values of the derivatives, each column of length one, that are smaller relative to the largest
/// belong to what observations do not determine: ten digits of the derivatives are known at least.
inline constexpr double undetermined = 1e-9;
/// The same beside a family, whose directions are known to fewer digits.
inline constexpr double undetermined_beside = 1e-7;
/// An unknown that changes the residuals by less than this, in σ, when it changes by its size, is alone not
/// determined, relative to the largest such change or to what was observed.
inline constexpr double without_effect = 1e-12;
/// Unknowns with at least this part of the largest in a direction that is not determined are named.
inline constexpr double named = 1e-3;
/// Of the residuals at a minimum, the part that parameters still change is at most so much.
inline constexpr double least_descent = 1e-5;
/// Quotients of differences over one and two steps that differ by more, relative, are no derivatives: the
/// extremals are not of one family.
inline constexpr double quotients_apart = 0.1;
/// Steps after the minimisation, at most, the first of which changes no more than half of this part of the
/// residuals.
inline constexpr int most_last_steps = 6;
inline constexpr double first_last_step = 0.02;
/// A member of a family is solved for again until it is the one that the fit has, within this part of the
/// tolerance; at most so often beside once for each direction of the family.
inline constexpr int most_shifts = 6;
inline constexpr double least_shift = 0.01;
/// Of a unit step along a family, so that the duration hardly changes.
inline constexpr double small_move = 1e-6;
/// Moves to other members of a family that differ by less, relative, are the same: on a circle a rotation is
/// a shift in time.
inline constexpr double dependent_moves = 1e-5;
/// That holds a path along a null direction, relative to its largest momentum: what elements err by.
inline constexpr double largest_force = 1e-5;
/// Relative to the path: so far beside it a second variation that is singular to the last digit is not. Null
/// eigenvalues are less than the second there.
inline constexpr double beside = 1e-8, largest_beside = 1e-6;
/// χ² above its mean by so many of its standard deviations is no scatter of the data.
inline constexpr double most_deviations = 10;
/// A node stands for q(T) where Jacobi fields that vanish at 0 have fallen, behind it, to less than this part
/// of their size there.
inline constexpr double fallen = 0.5;
/// Steps without damping end below the first, relative to the path, or below the second where they shrink no
/// more.
inline constexpr double least_step = 1e-14, roundoff_of_step = 1e-10;
/// Of times of observations, as they are written, relative to the duration.
inline constexpr double roundoff_of_times = 1e-9;
/// Of an unknown: extremals so far apart are compared where only differences give derivatives.
inline constexpr double difference = 1e-3;
/// Of the points of the quadrature that counts as exact.
inline constexpr int exact_points = 20;

}  // namespace extremal::limits::fit
