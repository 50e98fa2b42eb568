#pragma once

#include <cstddef>

#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which a branch is continued.

namespace extremal::limits {

namespace branch {

/// Changes of the parameter for difference quotients, in its unit: of four points, whose roundoff is small
/// also where equations are nearly singular, unless those of two differ by more than this share: then of two.
inline constexpr double wide = 1e-3, most_curved = 1e-4, narrow = 1e-5;
/// What closes the equations changes along the branch by more than this share of the largest change, or
/// roundoff is as large as half of the digits.
inline constexpr double least_closing = 1e-7;

}  // namespace branch

namespace branch_points {

inline constexpr int most_trials = 80, most_points = 8;
/// Responses on either side of a branch point point opposite ways, to a cosine of this.
inline constexpr double opposite = -0.9;
/// Beyond a branch point, by so much of the step, the next one is sought.
inline constexpr double beyond_it = 1e-4;
/// From the start of another branch to the branch point.
inline constexpr double start_distance = 1e-4;
/// How far from a guess, in shares of the interval, a state is tried where the guess itself fails: near a
/// branch point that is almost located, and else.
inline constexpr double aside_near = 0.03, aside_far = 0.3;
/// How far from a branch point, in shares of the step, states on both sides of it are reached.
inline constexpr double offsets[] = {1e-3, 1e-2, 3e-2, 0.1};
/// Where they are not: how far before it one is.
inline constexpr double beside[] = {0, 1e-7, 1e-5, 1e-4};
/// Forces that are left at a branch point, in tolerances of the largest momentum, or relative to it. Along
/// the singular directions a branch point is as good as its predictor, 1e-4 or better; at a saddle of the
/// forces they are of second order in that.
inline constexpr double momentum_tolerances = 10, least_momentum = 1e-8;
/// Responses are inverse to the distance from a branch point: one that is less than this part of those
/// farther off has the null direction left out.
inline constexpr double left_out = 0.5;
/// A second direction is singular if its response is so many times the one far from the branch point.
inline constexpr double grown = 10;
/// A direction of length one that changes duration and parameter by less than this, relative, leaves them.
inline constexpr double hardly_changed = 1e-6;
/// Changes of momenta, relative to their terms, that are none of motions in phase space: well above errors.
inline constexpr double beside_motion = 1e-4;

}  // namespace branch_points

namespace bifurcation_equations {

/// Descents begin along the points of the lattice with entries up to this.
inline constexpr int lattice = 2, most_descents = 50;
inline constexpr double first_damping = 1e-3, least_damping = 1e-10, difference = 1e-5;
/// Of the largest forces: what descents leave, and what roundoff does of differences.
inline constexpr double enough = 1e-8;
/// Descents that end so near each other found one direction.
inline constexpr double same_direction = 1e-6;

}  // namespace bifurcation_equations

namespace other_branches {

/// From a branch point to the first state on another branch: ever shorter, until all solutions of the
/// bifurcation equations at that distance are states before the value wanted.
inline constexpr double farthest = 0.03, nearest = 1e-4, shorter = 0.7;
/// Differences and descents for more null directions than this would be too many.
inline constexpr int most_directions = 4;
/// The cosine between directions that are opposite.
inline constexpr double opposite = -1 + 1e-6;
/// Equal actions and durations agree to this; values of states as far from the point nearly do.
inline constexpr double copies = 1e-6, nearly_as_far = 1e-2;
inline constexpr double action_roundoff = 16 * unit_roundoff;

}  // namespace other_branches

namespace common_symmetries {

/// Symmetries differ by less than this, relative, if they are the same.
inline constexpr double same = 1e-6;
/// A part of the way where a member is like most.
inline constexpr double between = 0.382;

}  // namespace common_symmetries

namespace chord_steps {

/// A step is refused where corrections shrink less than this, or are longer than this part of it.
inline constexpr double contraction = 0.5, longest_correction = 0.5;
/// Corrections shorter than this part of a step hardly move the path, but where that is short, as near a
/// singularity: they may grow so much before they shrink.
inline constexpr double small_correction = 0.05, slowest = 4;
/// Roundoff shrinks less than this from one correction to the next.
inline constexpr double stagnation = 0.3;
/// Corrections that are longer are none of roundoff. Those of so many times what is enough will do.
inline constexpr double largest_roundoff = 1e-6, negligible = 10;

}  // namespace chord_steps

namespace continuation {

/// Drift of the energy by its largest terms: elements that overlook forces miss it by as much as it is. Near
/// a bound of the velocities it is known to few digits of q'.
inline constexpr double unresolved = 1e-2;

/// Lengths are relative, as Branch::dot measures them. The longest step is one of which so many make up the
/// distance wanted where as many points are allowed.
inline constexpr double first_length = 0.02, least_length = 1e-6, least_longest = 0.1, most_longest = 0.4;
inline constexpr double coverage = 4;
/// Steps over a change of the index that nothing explains are taken again until they are as short as this.
inline constexpr double shortest_leap = 2e-3;
/// The next try after a step that failed is so much of it.
inline constexpr double shortening = 0.4;
/// Where roundoff hides its end, the next try is longer by this factor.
inline constexpr double lengthening = 1.5;
/// A step grows by a factor where the cosine of the angle by which it turned is more than a bound, else it
/// shrinks; it shrinks, too, after corrections that took more factorisations.
inline constexpr double straight = 0.98, growth_if_straight = 2, bent = 0.95, growth_if_bent = 1.3,
                        growth_else = 0.8;
inline constexpr int many_factorisations = 4;
inline constexpr double growth_if_many = 0.7;
/// A crossing test so small, relative to that of the state before, is roundoff.
inline constexpr double on_crossing = 1e-6;
/// On a branch the extremal half as far from the first one as another is no farther away than this part of
/// its distance.
inline constexpr double half_as_far = 0.75;
/// Of its size, and of its error: an orbit that differs by less from itself half a period later has half the
/// period.
inline constexpr double half_period = 1e-6, half_period_errors = 10;
/// A point is where orbits meet those of half their period if it alternates by no more than this share of
/// what the state before it does; of the size, no error is larger.
inline constexpr double nearly_half_period = 1e-2;
/// Of the size of the guess: a path smaller than this is at rest.
inline constexpr double rest = 1e-9;
/// The action is compared with its derivatives at one point of so many, over half the lengths in turn until
/// the difference is so small.
inline constexpr int unchecked = 8;
inline constexpr double probes[] = {1e-3, 1e-4, 1e-5}, exact = 1e-9;
/// The period diverges after so many times the time in which the number that varies approaches its limit
/// e-fold, if this share of the period is spent at rest.
inline constexpr double lasting = 5, mostly = 0.25;
/// Of the distance wanted: where steps fail so near to the limit it is the end.
inline constexpr double hardly = 1e-6;

}  // namespace continuation

namespace approached {

/// Elements slower than this share of the fastest are at rest.
inline constexpr double slow = 0.03;
/// A path next to a homoclinic orbit is slowest at an equilibrium, within this share of its range. The number
/// that varies approaches its limit no faster than the motion leaves the equilibrium, but for this factor.
inline constexpr double beside_rest = 0.2, fastest_approach = 1.5;
/// Next to a singularity elements differ in length by more than the first, and forces change e-fold on less
/// than the second, of the range of the path.
inline constexpr double singular_grading = 100, singular_length = 1e-2;

}  // namespace approached

namespace elements {

/// Elements are planned for the first share of the tolerance; on the mesh there is, the second will do.
inline constexpr double spare = 0.1, tolerated = 0.7;
inline constexpr int highest_degree = 16, least_degree = 5, most_elements = 1 << 10;
/// Elements become longer again where the path becomes smooth from point to point.
inline constexpr double strongest_cut = 16, strongest_growth = 2;
/// Elements whose error is below this share of the tolerance are more than needed; others are taken instead
/// if they have no more nodes than this share.
inline constexpr double lavish = 1e-4, worth_changing = 0.7;
/// Error allowed of q', in tolerances of its range.
inline constexpr double slope_tolerances = 10;

}  // namespace elements

namespace event_location {

/// From this near, relative to the distance wanted, Newton's method lands on a value; where it does not, the
/// value is located so closely.
inline constexpr double near_value = 1e-3, at_value = 1e-13;
/// Two points of a closed branch differ by no more than this, relative.
inline constexpr double same = 1e-6;
/// So near its first member a branch of one value closes: along it errors add up.
inline constexpr double first_error = 1e-5;
/// A fold within this share of a step of a branch point is the same event.
inline constexpr double one = 1e-2;
/// An orbit this small against the one before the step is next to rest; to this share of it.
inline constexpr double nearly_rest = 1e-3, rest_located = 0.1;

}  // namespace event_location

namespace predictor {

/// A step is begun no longer than the branch is predicted to turn by so much, the tangent of an angle.
inline constexpr double predicted_turn = 0.4;

}  // namespace predictor

namespace held_family {

/// Responses of null directions are so many times those of others: at least, and where the path has no error.
/// An error of the path changes eigenvalues by up to so many times as much, relative.
inline constexpr double least_apart = 1e4, most_apart = 1e8, change = 100;
/// Each costs a factorisation.
inline constexpr int most_suspected = 32;
/// Of the extent and of the duration: a path so far off is singular no longer to the last digit, and null
/// directions still stand apart; one farther off has the same null directions to many digits.
inline constexpr double hardly = 1e-11, safely = 1e-9;

}  // namespace held_family

namespace tracker {

/// Corrections are carried on to this share of the tolerance, and no further than this.
inline constexpr double unfinished = 0.01, least_goal = 10 * least_correction;
/// A path nearer to the extremal of its own value than this share of the tolerance is not corrected further.
inline constexpr double settled = 0.1;
/// A value that is known to so many roundings is exact, however much the path depends on it.
inline constexpr double roundings = 100;
inline constexpr int most_resolutions = 4;
/// A path that another quadrature moves by more than this share of what it did before elements were halved is
/// moved by roundoff.
inline constexpr double halving_helps = 0.5;
/// How far the tangent may turn back and forth along a step.
inline constexpr double waviness = 0.005;
/// The unit of lengths is no smaller than this share of the largest path so far.
inline constexpr double least_extent = 0.3;

}  // namespace tracker

}  // namespace extremal::limits
