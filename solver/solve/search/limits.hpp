#pragma once

#include <cstddef>

#include "solve/mesh/roundoff.hpp"

/// \file The numbers by which guesses are tried.

namespace extremal::limits {

namespace scanned_motions {

/// An integrator's; what one with variations costs, by that of a motion alone; and one where velocities
/// follow from momenta by Newton's method.
inline constexpr int most_integrator_steps = 3000, variations_cost = 2, implicit_cost = 6;

}  // namespace scanned_motions

namespace arrivals {

/// Of an integrator's step, relative: of motions that are looked along.
inline constexpr double coarse_step = 1e-6;
inline constexpr int samples_a_step = 4;
/// Directions of two coordinates, and how often they are halved where passages are further apart than this
/// part of the extent, or one that is not too far has no partner.
inline constexpr int sectors = 48, most_halvings = 5;
inline constexpr double near_passage = 0.3, far_passage = 0.5;
inline constexpr int most_newton_steps = 6;
/// Unknowns are relative to a fast velocity, and the logarithm of the time. Steps of Newton's method shrink
/// by this, from at most the second.
inline constexpr double contraction = 0.7, longest_correction = 0.3;
/// Errors of an integrator's step, relative, and the last step of Newton's method, whose square by the extent
/// is a miss that is none: along a curve, and of motions that arrive. Those that pass a centre closely time
/// after time amplify what they miss: the elements take them only where they are this near.
inline constexpr double step_error_along = 1e-8, last_step_along = 1e-3;
inline constexpr double step_error_arriving = 1e-12, last_step_arriving = 1e-6;
/// Along a curve, and where it turns. The next try after a step that failed is so much of it; a longer one
/// follows where the curve turned little and a step took no more motions.
inline constexpr double first_length = 0.02, longest_length = 0.2, least_length = 1e-5;
inline constexpr double sharpest_turn = 0.9, mild_turn = 0.98;
inline constexpr double shortening = 0.4, lengthening = 1.6;
inline constexpr int few_flights = 3;
inline constexpr int most_points = 400, crossing_samples = 8;
/// Points so near to a curve, by the length of the step there, are on it.
inline constexpr double near_curve = 1e-3;
/// Of a manifold other points are seen where q1 is: those farther away than this part of the extent and so
/// many times what is missed; and on a way past it, than so many times what it moves there.
inline constexpr double seen_beside = 0.1, seen_near = 2;

}  // namespace arrivals

namespace balance {

inline constexpr int speed_samples = 4, halvings = 60;
/// Speeds by the largest: of a rest, at most; and where its tails are measured, which is small for the linear
/// equations, large against errors, and so many times the least that one exponential function is left.
inline constexpr double resting = 1e-2, tail_speed = 1e-4, tail_growth = 10;
/// Tails of speeds that are halved: from so much faster on, at most so many, and so many together.
inline constexpr double fastest_tail = 32;
inline constexpr std::size_t most_tails = 13, most_extrapolated = 6;
/// A further power of a polynomial changes less than the one before, about by the speed; of what is none, as
/// of a power that is not whole, it changes hardly less.
inline constexpr double least_fall = 0.1;
/// Faster than this, by the largest, a part is no tail of a rest.
inline constexpr double moving = 0.1;
/// Of speeds at an end, by the largest of the path: an end so near to an equilibrium is at it.
inline constexpr double speed_roundoff = 1e-12;
/// Of velocities and momenta, by the largest: roundings of the sums that they are.
inline constexpr double path_roundoff = 4 * unit_roundoff;
/// Weights of a rest this much smaller than the largest, and less than so many of their doubts, are none: it
/// would be a rare accident if roundoff hid one that there is.
inline constexpr double roundoff_of_weights = 1e-9, doubtful = 100;
/// Slower than this, by the fastest, a motion near an equilibrium neither approaches nor leaves.
inline constexpr double least_rate = 1e-8;
/// Rates that differ less, by the fastest, may be one, of which roundoff makes several: the root of it. They
/// are if their vectors, of length 1, are dependent but for this.
inline constexpr double coinciding = 1e-5, parallel_vectors = 1e-6;
/// Steps from a rest to the equilibrium; and roundoff of L there, by its size and the kinetic energy of the
/// path.
inline constexpr int newton_steps = 3;
inline constexpr double cost_roundoff = 1e-14;
/// Lengths of a rest are looked along by this, by the fastest rate, at most so often.
inline constexpr double length_step = 0.1;
inline constexpr int most_lengths = 200;
/// Steps to the least action of all rests; they are doubled as long as the logarithm of the largest energy
/// falls by this. Damping where the action does not fall, by the bound of its curvature, which is at least
/// that part of the largest; roundoff of the action; and the last change, by the fastest rate.
inline constexpr int most_shift_steps = 2000;
inline constexpr double far = 0.5;
inline constexpr double first_damping = 0.25, damping_growth = 4, least_damping = 1e-3, most_damping = 1e9;
inline constexpr double least_bound = 1e-12, action_roundoff = 1e-15, converged = 1e-8;
/// Of a rest between its tails, what must remain if only that is to be compressed.
inline constexpr double still_long = 0.3;
/// An element of a rest becomes no shorter than this part of itself.
inline constexpr double shortest_element = 1e-5;
/// A shift by the rate, after which the tails need not be measured again; and passes at most.
inline constexpr double balanced = 1e-5;
inline constexpr int most_balances = 8;
/// Of Newton's method on elements of a degree that is higher by so much, from a path that is an extremal.
inline constexpr int finer_steps = 12, finer_by = 2;
/// A smaller energy in rests, by that of the motion, is none that 106 bits know.
inline constexpr double least_resolved = 1e-24;
/// What may be unknown of shifts, by the range of the path; and the last shift may be as large.
inline constexpr double most_error = 1e-3;
/// A smaller energy in rests, by that of the motion, holds what lies between them in time by roundoff.
inline constexpr double loose = 1e-13;

}  // namespace balance

namespace deflation {

inline constexpr int most_steps = 40;
/// Of a step, and where plain Newton takes over; root mean square by the extent of the path.
inline constexpr double longest = 0.5, short_step = 0.02;
/// A path this much larger than at first has run away.
inline constexpr double runaway = 1e3;

}  // namespace deflation

namespace descent {

/// Relative to the range: a longer step may land beyond the barrier that the guess avoids.
inline constexpr double longest_step = 0.3;
/// The action must fall by this part of the decrease that its slope predicts.
inline constexpr double sufficient = 1e-4;
inline constexpr double shortest = 0x1p-40;
/// Relative to the range: minima this well known let the ends of windows move; and an extremal.
inline constexpr double nearly_minimal = 0.03, close = 1e-3;

}  // namespace descent

namespace distinct {

/// Errors are estimates; they and the tolerance may be exceeded by this factor.
inline constexpr double margin = 10;
/// Of the size of the problem: a path smaller than this is at rest.
inline constexpr double rest = 1e-3;
/// Where a shift is tried, in parts of itself; and what it may change of forces and momenta, by the largest.
inline constexpr double shifted[] = {-0.618, 0.382, 0.7};
inline constexpr double unchanged = 1e-6;

}  // namespace distinct

namespace from_other_ends {

/// Of the way of the ends to their mean: where it begins, where it is as good as at the mean, and where the
/// ends are as good as those wanted.
inline constexpr double first_share = 0.5, largest_share = 0.95, least_share = 1e-12;
/// Of that share, what is left after a step: at first, at least, and where it ends.
inline constexpr double first_part = 0.5, smallest_part = 0.25, largest_part = 0.97;
/// The ends wanted are tried where the share is less than so much of that at which they were tried before.
inline constexpr double nearer_by = 0.25;
/// Tolerance of paths between, and of the effort of a solve what one may take.
inline constexpr double between = 1e-6, effort = 0.1;
/// Elements go on that resolve a path to `finest`: the next one is sharper. Where others do that with fewer
/// unknowns by the factor `lavish`, nodes become at most so many times rarer.
inline constexpr double finest = 1e-9, lavish = 2, strongest_growth = 4;

}  // namespace from_other_ends

namespace from_motions {

/// Of an integrator's step, relative: a guess need not be better.
inline constexpr double step_error = 1e-8;
inline constexpr int most_integrator_steps = 3000, samples_a_step = 16;
/// So many of its steps evaluate L about as often as one of Newton's.
inline constexpr int steps_a_count = 8;
/// Added to the mean velocity, in turn: of the extent of the guess times the frequency along it.
inline constexpr double speeds[] = {0.3, 1, 0.1, 2};
/// Durations that are free, in turn: of the guess.
inline constexpr double durations[] = {1, 0.7, 1.5};
inline constexpr unsigned most_motions = 1000;
/// With one coordinate: velocities between which the end is passed, and halvings of such an interval.
inline constexpr int velocities = 64, most_bisections = 40;
/// A scan of more coordinates would have to be too dense; of so many the ball is filled evenly, of more the
/// distance from its centre is as of these.
inline constexpr int most_scanned = 24, most_dimensions = 4;
/// Velocities of momenta that are to lead along a manifold: off it by less than this part of themselves.
inline constexpr double off_manifold = 1e-9;
/// Lengths of velocities on which curves of arrivals are looked for, at first and in each ring beyond, and
/// how many times more with one coordinate.
inline constexpr int first_levels = 8, further_levels = 5, denser_in_one = 3;
/// Steps of integrators for one of these lengths at most.
inline constexpr int most_sweep_steps = 100000;
/// Steps from one arrival to the next at most, where some motions do not last.
inline constexpr int most_vain_steps = 100000;
/// Times, by the duration, until which curves are looked for, and followed where times grow along them; and
/// velocities, by the reach.
inline constexpr double seed_until = 1.5, follow_until = 1.1, follow_beyond = 100;
/// Directions in which the least velocity is looked for.
inline constexpr int directions_tried = 24;
/// Newton steps for a velocity of given energy, and how near they come, relative.
inline constexpr int most_energy_steps = 30;
inline constexpr double energy_error = 1e-9;

}  // namespace from_motions

namespace settled_motion {

/// Of an integrator's step, relative, and samples in it.
inline constexpr double settling_error = 1e-10;
inline constexpr int settling_samples = 16;
/// Steps of the integrator in all.
inline constexpr int most_settling_steps = 1 << 19;
/// The velocity of a guess is taken over this part of its duration.
inline constexpr double step_of_guess = 1e-4;
/// Returns lie between these parts of the duration that is expected, and are located by so many bisections.
inline constexpr double earliest_return = 0.3, latest_return = 3;
inline constexpr int bisections = 40;
/// An orbit returns to this, relative, after so many returns at most; at rest its range is this part of its
/// size.
inline constexpr double closed_nearly = 1e-6, least_range = 1e-4;
inline constexpr int most_returns = 200;

}  // namespace settled_motion

namespace gradient_flow {

/// Linear elements on which the action is minimised; times coordinates at most the second, but at least the
/// third.
inline constexpr int elements = 384, most_nodal_values = 3072, least_elements = 128;
/// Steps, and those between two meshes. Operations of all, elements times the cube of the coordinates each:
/// with fewer steps than the last the flow is not tried.
inline constexpr int most_steps = 250, steps_a_mesh = 4, least_steps = 100;
inline constexpr double most_work = 1e10;
/// Of the effort of one solve, where that is spent already.
inline constexpr double share = 0.5;
/// The action has no minimum, it seems, where the path grows by this factor in so many steps, and on. Where
/// one is rather reached as a rest becomes shorter, that is done, so often.
inline constexpr int patient_steps = 40, most_falls = 8;
/// Saddles that are left, one after the other; and guesses that keep no symmetry, each bent by this more, by
/// the extent.
inline constexpr int most_saddles = 4;
inline constexpr unsigned bends_aside = 4;
inline constexpr double bend_aside = 0.1;
inline constexpr double growing = 1.5;
/// Passes of smoothing over the density of nodes, and the part of nodes that are spread evenly.
inline constexpr int smoothings = 4;
inline constexpr double floor = 0.5;
/// 1/τ by the negative curvature of L in q: the flow keeps the order of paths from 1 on.
inline constexpr double faithful = 2;
/// τ grows beyond that as long as steps are shorter than this, relative to the range; by this factor at most
/// after each step.
inline constexpr double short_step = 0.02, growth = 4;
/// 1/τ grows by the first where the second variation is indefinite or the action does not fall, by at least
/// the second where a step is too long; by the largest curvature of L in q it is then at least the third, at
/// most the fourth; and near a minimiser below the last.
inline constexpr double cut = 4, least_cut = 1.5, least_shift = 1e-3, most_shift = 1e6, final_shift = 0.1;
/// Relative to the range: the longest change of a step, and one below which the path is nearly minimal.
inline constexpr double longest_step = 0.3, close = 1e-3;
inline constexpr int mass_samples = 32;
/// The action must fall by this part of the decrease that its slope predicts, but for its roundoff.
inline constexpr double sufficient = 1e-4, roundoff = 1e-14;
/// Of the range, along the direction of most negative curvature.
inline constexpr double kick = 0.1, least_kick = 1e-3;
/// An eigenvalue below this, by the largest curvature of L in q, is negative: that of a shift of an interface
/// through the elements has either sign.
inline constexpr double negative = 0.02;
/// Of paths with less time, by the largest kinetic energy: the energy of the first stage, of each that
/// follows by that of the one before, and a smaller one that makes no stage. There energies hold interfaces
/// in time, and eigenvalues below this are negative.
inline constexpr double first_energy = 0.1, less_energy = 0.1, last_energy = 1e-8, negative_of_stage = 1e-4;
inline constexpr int inverse_iterations = 12;
/// A path this much larger than at first has run away.
inline constexpr double runaway = 1e3;
/// Nodes of one element of higher degree; and elements by those beside them: tails of a path reach into the
/// elements of a rest. The degree where Newton's method fails from the path, and the action is minimised
/// further, until that part of the range is left: what a rest holds may be this small.
inline constexpr int nodes_an_element = 4, finishing_degree = 8;
inline constexpr double finished = 1e-5;
inline constexpr double steepest_grading = 4;

}  // namespace gradient_flow

namespace time_law {

/// Of the largest of the elements: what is none, and what elements count at least that stand still.
inline constexpr double roundoff = 1e-12, standing = 1e-30;
/// An element is not shorter than this, by the mean.
inline constexpr double shortest = 1e-4;
inline constexpr int most_octaves = 100, halvings = 60;

}  // namespace time_law

namespace continuum {

/// Degree of elements on which conjugate ends are nearly conjugate to roundoff, and how often they are
/// halved.
inline constexpr int family_degree = 12, raised = 3, most_family_halvings = 4, most_family_elements = 512;
/// Directions of the guess that are softer than the others by this factor are taken for null.
inline constexpr double softer = 0.2;
/// Eigenvalues so small, relative to the next, are zero but for the error of the elements.
inline constexpr double null_eigenvalue = 1e-7;
/// Where the second variation is singular to the last digit, its directions are those of a path that is moved
/// by this part of its range.
inline constexpr double beside = 1e-9;
inline constexpr int inverse_iterations = 4;
/// A step is at most this part of the range.
inline constexpr double longest_family_step = 0.5;
inline constexpr int most_family_steps = 60, most_null_rounds = 12;
/// Of both attempts, from the path that was found and from the guess; and of all from flows.
inline constexpr int most_steps_in_all = 800;
/// Whole steps from where no direction is null, until they are this part of the range.
inline constexpr int whole_steps = 4;
inline constexpr double near_extremal = 1e-3;
/// Steps of roundoff, relative to the range; and steps so small that they may be, if they no longer fall.
inline constexpr double arrived = 1e-14, nearly = 1e-10;
/// Other members of the family are looked for at this part of the range to both sides. There, the force along
/// the null directions, relative to the largest momentum, is at most this: roundoff of a sum over as many
/// nodes as there may be; and at most that part of what the ends make of it, unless that is less than
/// roundoff of a gradient.
inline constexpr double aside = 0.05, largest_no_force = 1e-12, part_of_force = 1e-4;
inline constexpr double roundoff_of_force = 1e-15;
/// Members at that distance are nearer to the guess if the square of their distance is less by this part of
/// the square of the range: more than roundoff. Steps along the family to the nearest, and how often it is
/// looked for.
inline constexpr double nearer = 1e-9;
inline constexpr int most_slides = 40, most_nearer = 4;
/// Factors of steps along the family.
inline constexpr double least_relaxation = 0.1, largest_relaxation = 10;
/// Directions of two copies that depend on others but for this part are the same.
inline constexpr double dependent = 0.1;
/// A path so small by the guess is roundoff.
inline constexpr double roundoff_of_guess = 1e-13;
/// Part of the tolerance that the elements may take.
inline constexpr double family_share = 0.3;

}  // namespace continuum

namespace guess_mesh {

/// Elements are at most this long in units of 1/ω, ω the local frequency along the guess.
inline constexpr double longest_element = 2.0;
/// Elements follow a guess to this, relative to its range, a motion to between these by the tolerance; they
/// follow velocities to so many times that, and become at most so many at a time.
inline constexpr double guess_goal = 1e-5, best_guess_goal = 1e-8, slope_goal = 100, guess_cut = 4;
inline constexpr double guess_floor = 0.25;
inline constexpr int most_passes = 10, highest_guess_degree = 12;
/// Steps of an integrator, elements that follow them, and their degree.
inline constexpr std::size_t steps_an_element = 5, least_kept = 1024, most_kept = 1 << 15;
inline constexpr int kept_degree = 7;
/// Their degree where a step amplifies all that doubles have lost.
inline constexpr int exact_degree = 12;
/// A path of chance that needs more elements than this comes too near a singularity.
inline constexpr int most_launched = 128;
/// A singularity is near where elements differ so much.
inline constexpr double collision = 100;
/// A mesh whose elements differ less than this is not worth starting again for.
inline constexpr double mild_grading = 3;
/// Elements on which the kinks that a guess crosses are found.
inline constexpr int least_sampled = 16, most_sampled = 1024;
/// Tries to move the default guess to where L is finite.
inline constexpr unsigned most_bends = 8;
/// A guess that asks for more elements would ask again.
inline constexpr int most_first_elements = 1 << 12;
/// Elements of a path of chance whose frequency is measured.
inline constexpr int sketch_elements = 16;

}  // namespace guess_mesh

namespace loop_search {

/// Symmetries in use at most.
inline constexpr std::size_t most_symmetries = 16;
/// Of the effort of one solve, for each loop.
inline constexpr double share = 0.3;

}  // namespace loop_search

namespace search {

/// Newton steps from guesses, and those times unknowns of the first mesh: their cost.
inline constexpr int most_steps = 4000;
inline constexpr double most_work = 1e7;
inline constexpr double least_steps = 100;
/// Starts with noise that are cheaper than other durations are; and at most.
inline constexpr unsigned first_noises = 8, most_noises = 10000, collision_noises = 100;
/// Of the guess's extent, in turn.
inline constexpr double noise_sizes[] = {0.1, 0.3, 0.6};

/// Of elements that may not be refined on the way: coarse ones may not resolve a family of extremals as it
/// grows.
inline constexpr int homotopy_degree = 8;
/// Points about the guess that tell linear forces from bounded ones: their distance by its extent.
inline constexpr double force_spreads[] = {8, 1};
/// Of the effort, kept for weaker forces.
inline constexpr double share_of_forces = 0.25;
/// Times that elements of a path are cut where forces change fast within them.
inline constexpr int most_cuts = 8;

}  // namespace search

namespace several {

/// Elements of a family keep the accuracy that is needed to land.
inline constexpr int family_degree = 6, elements_a_turn = 8;
/// Paths whose shifts are held are known to this, relative to their extent.
inline constexpr double held_apart = 1e-3;
/// Saddles that are left downhill at a time.
inline constexpr int most_saddles = 24;
/// Guesses tried before families are traced, and each time between.
inline constexpr unsigned guesses = 8;
/// Of the effort that one solve may take, for each extremal that is new.
inline constexpr double patience = 3;
/// So many in a row without a new extremal are enough.
inline constexpr int most_in_vain = 100;
/// Random loops tried instead, and in vain.
inline constexpr unsigned loops = 1200;
inline constexpr int most_loops_in_vain = 1200;
/// Rows of the boundary relation that are varied, at most.
inline constexpr int most_rows = 12;
/// Of k extremals that are led to alike, one remains unseen after m motions with probability (1 − 1/k)ᵐ: with
/// so many motions for each of them e⁻⁸, and for one that is led to half as often e⁻⁴.
inline constexpr int motions_each = 8, least_motions = 24;
/// Motions for each extremal that is wanted: of chaotic systems there are always more.
inline constexpr int most_motions_each = 60;
/// Steps of integrators that one scan may take, and its part of the time there is.
inline constexpr int most_scan_steps = 1500000;
/// So many of them may find nothing new.
inline constexpr int most_quiet_steps = most_scan_steps / 16;
inline constexpr double arrivals_share = 0.3;
/// The ball reaches so much further than the extremals that are wanted; and grows so, so often in vain, where
/// there are not enough in it; more where curves of arrivals are followed, for few of fast motions are
/// costly.
inline constexpr double reach_beyond = 1.1, growth_of_reach = 1.4, growth_of_arrivals = 2.5;
/// The same of a box of starts: actions do not grow in the order of velocities.
inline constexpr double starts_beyond = 1.6;
inline constexpr int most_growths = 4, most_cheap_growths = 24;
/// Of the effort of one solve, for a motion that nearly closes; points of the first lattice of starts, whose
/// box grows so often in vain, times its dimensions.
inline constexpr double share_of_motion = 0.01, first_points = 576;
inline constexpr int growths_in_vain = 2;
/// Of integrators' steps, for motions that nearly close.
inline constexpr double openings_share = 0.6;
/// Motions for each extremal known that may lead nowhere, in a row.
inline constexpr int most_astray = 40;
/// A path that a homotopy has led to the problem is known to this, relative to its extent.
inline constexpr double led = 3e-5;
/// Loops that come back to known orbits, for each of them, before no other is expected between them; and no
/// more loops than this times those before.
inline constexpr int returns_each = 2;
inline constexpr unsigned spare_loops = 1;

}  // namespace several

namespace closing_motions {

/// A box of twice as many dimensions is to be filled.
inline constexpr int most_coordinates = 3;
/// Of an integrator's step, relative: of motions that are looked at, and of those that are closed.
inline constexpr double coarse_step = 1e-4, fine_step = 1e-7;
/// What a motion that closes misses, at most, and the least singular value of the return map less one that an
/// isolated orbit has: by units.
inline constexpr double closed = 1e-4, isolated = 1e-5;
/// Of least squares: steps, and the damping by the mean curvature, first and after steps that succeed and
/// fail.
inline constexpr int most_steps = 12;
inline constexpr double first_damping = 1e-3, less_damping = 0.1, more_damping = 8;

}  // namespace closing_motions

namespace start_scan {

inline constexpr int most_unknowns = 2;
/// Of an integrator's step, relative: near zeros, and of samples by two unknowns.
inline constexpr double fine_step = 1e-8, coarse_step = 1e-5;
/// Cells of a box along a coordinate, and how often they are halved where values are off what the corners
/// tell by more than this part of their range; and how often besides where Newton's method fails from them.
inline constexpr int cells_in_one = 192, cells_in_two = 32;
inline constexpr int halvings_in_one = 20, halvings_in_two = 3, further_halvings = 6;
inline constexpr double nearly_linear = 0.1;
/// Motions along a coordinate of a box that tell whether all are alike: none takes more steps than so many
/// times the mean.
inline constexpr int even_places = 9;
inline constexpr double uneven = 3;
/// Cells sampled together; and steps side by side that cost as much as one alone, with four lanes.
inline constexpr std::size_t cells_at_once = 256;
inline constexpr double abreast = 3;
/// Of a velocity at which L is not finite, halved until it is: the unit of momenta.
inline constexpr double least_part = 1e-9;
/// A value that keeps its sign by so many times its curvature has no zero in the cell. Beside a separatrix
/// all of the curvature may be in a part of the cell; of two unknowns finer cells cost too much.
inline constexpr double sure_in_one = 8, sure_in_two = 4;
/// Zeros are known to this part of a cell, or of the values at its corners; where the integrator fails, at
/// least to the second, and those nearer to each other are one.
inline constexpr double met = 1e-7, nearly_met = 1e-3;
inline constexpr int most_sections = 60;
/// Newton's method begins where a linear function is zero, as far as this beyond the triangle that it is
/// taken from, and ends further away than so many cells; zeros of slopes nearer to singular are of families.
inline constexpr double beyond_triangle = 0.2, strays = 3, isolated = 1e-10;
inline constexpr int most_newton_steps = 10;

}  // namespace start_scan

}  // namespace extremal::limits
