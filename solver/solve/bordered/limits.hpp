#pragma once

#include <initializer_list>

/// \file The numbers that decide in solves with further unknowns.

namespace extremal::limits::bordered {

/// A leg between waypoints becomes in one step no shorter than this part of itself.
inline constexpr double least_leg = 0.1;
/// Eigenvalues of the second variation this small, by its largest entry, are null: entries are known to
/// roundoff, which the elimination lets grow by some orders.
inline constexpr double null_eigenvalue = 1e-10;

/// Of the equations and unknowns in their units: a direction in which the matrix is so small is one of a
/// family of solutions. So many are looked for at most.
inline constexpr double null_direction = 1e-10;
inline constexpr int most_null_directions = 6;
/// Directions so soft, relative to the others, are left out where steps become too short; until steps are at
/// most the second, by the size of the path. There may be many: they are looked for by a dense decomposition,
/// in so many unknowns at most.
inline constexpr double soft_direction = 0.02, near_family = 1e-3;
inline constexpr int most_dense = 400;
/// A pivot on the diagonal serves if it is at least this part of the largest of its column: the row of an
/// integral, which has entries of all unknowns, fills all rows below where it becomes a pivot early.
inline constexpr double least_pivot = 0.01;

/// A step along a null direction, by the size of the path, and what the solution beside it may lie off, by
/// the step: of a family that is its curvature.
inline constexpr double family_step = 0.01, most_pull_back = 0.1;

/// A path of less range than this, beside its magnitude and the path that it started from, rests.
inline constexpr double resting = 1e-12;

/// Of the damped iteration.
inline constexpr int most_steps = 60;
inline constexpr double least_damping = 1e-3;
/// Corrections below this, relative, are taken as they are: their simplified steps are roundoff.
inline constexpr double roundoff_step = 1e-11;
/// Corrections that no longer shrink by this factor are roundoff, if they are below `amplified`.
inline constexpr double shrinks = 0.25, amplified = 1e-8;
/// The last correction of a result, relative.
inline constexpr double converged_step = 1e-14;
/// A constant that is this small beside 1 has no size of its own.
inline constexpr double least_constant = 1e-8;
/// A path may become so many times larger than its guess, a duration so many times longer or shorter.
inline constexpr double most_growth = 1e4;

/// Of steps downhill: how many at most, and the longest by the size of the path; one that is so short is
/// Newton's, beside the minimiser. The action must fall by a part of what the quadratic model predicts,
/// unless that is roundoff of the action.
inline constexpr int most_descents = 400;
inline constexpr double longest_descent = 0.3, minimal = 1e-6, sufficient = 1e-4, roundoff_of_action = 1e-14;
/// The least 1/τ, by the stiffest node, and the factor by which it changes.
inline constexpr double least_shift = 1e-8, growth = 4;
/// Of the size of the path, along the direction in which a saddle is left.
inline constexpr double kick = 0.1, least_kick = 1e-3;
inline constexpr int inverse_iterations = 12;

/// Elements: of the first attempt, of those that follow, at most.
inline constexpr int first_degree = 6, degree = 10, compared_with = 12;
inline constexpr int first_elements = 8, most_elements = 2000, most_first_elements = 64,
                     most_bent_elements = 16;
/// Of the range: a guess is resolved to this before the iteration begins.
inline constexpr double guess_error = 1e-2;
/// Of the tolerance, that a plan of elements aims at.
inline constexpr double aim = 0.1;
/// An element becomes at most so many.
inline constexpr int strongest_cut = 4;
inline constexpr int most_refinements = 14;
/// Errors of q' may be so many tolerances, relative to its range.
inline constexpr double velocity_tolerances = 10;

/// Derivatives of integrals and conditions, of length one, that are so nearly dependent are so; a small one
/// is compared with its terms. Of a combination that vanishes, parts beyond the second belong to it.
inline constexpr double dependent = 1e-6, takes_part = 1e-3;
/// Conditions that are missed by the first, by their terms, are met to roundoff. Beyond, a step of Newton's
/// method for them alone leaves the second at most: next to a point where they depend on each other a
/// quarter.
inline constexpr double met = 1e-15, corrected = 0.1;
/// Of the size of a path: where roundoff of integrals and conditions moves it by more, they do not determine
/// it.
inline constexpr double determined = 1e-2;
/// In roundoffs of the size of a path: a shorter step to meet them is none.
inline constexpr double shortest_step = 16;

/// States about the guess at which the equations are compared: their distances, relative to it, and elements
/// of each leg. Lines of length one that depend on each other in all of them leave at most so much: the
/// quadrature of exact derivatives on smooth paths.
inline constexpr std::initializer_list<double> state_distances = {0.3, 0.2, 0.1, 0.03, 0.01, 1e-3};
inline constexpr int elements_of_state = 8;
inline constexpr double structural = 1e-9, target_roundoff = 1e-12;

/// Of a result: equations of the path by the largest momentum, conditions by their terms.
inline constexpr double largest_residual = 1e-9, largest_mismatch = 1e-10;
/// Of conditions that follow from others and from constraints: decimals that a scene gives, and their squares
/// in constraints.
inline constexpr double largest_implied = 1e-7;

/// Starting paths bent by waves sin(mπt/T): sizes by the extent of the guess, first and last m, and how many.
struct BendRow {
  double size;
  int first, last, seeds;
};
inline constexpr std::initializer_list<BendRow> bends = {{0.1, 1, 1, 1}, {0.1, 2, 2, 1}, {0.3, 1, 1, 2},
                                                         {0.3, 2, 2, 2}, {0.1, 3, 3, 1}, {0.3, 1, 3, 4},
                                                         {1.0, 1, 3, 4}};
/// Ends that are drawn, and steps towards the conditions between them.
inline constexpr int drawn_ends = 32, most_end_steps = 12;
/// Of the jump at a waypoint as a function of its time: equal steps, the shortest leg by their sum, halvings
/// of a bracket, steps towards a minimum, elements of each time, and steps of Newton's method in all.
inline constexpr int scanned_steps = 96, bisections = 8, descents = 6;
inline constexpr double shortest_scanned = 1e-4;
inline constexpr int fewest_scan_elements = 16, most_scan_elements = 128, most_scan_steps = 3000;

/// On the way from what a starting path has to what is given, shortest step.
inline constexpr double least_part = 1.0 / 512;
/// Of the range: elements on that way.
inline constexpr double way_error = 1e-3;

/// Elements of a scheme are doubled at most up to this many.
inline constexpr int most_scheme_elements = 1 << 15;

}  // namespace extremal::limits::bordered
