#pragma once

#include <cstddef>

/// \file The numbers that decide where a path touches what inequalities forbid.

namespace extremal::limits::contact {

/// Equal elements on which contacts are looked for, coarse first: each further level serves where the one
/// before has not led to a solution.
inline constexpr int coarse_elements[] = {96, 384, 1152};
/// A contact, or a stretch in which the path is forbidden, of fewer elements than the first number gets so
/// many in a stretch longer than it by a factor; so often, before elements become shorter everywhere.
inline constexpr int few_elements = 8, closer_elements = 32, most_closer = 4;
inline constexpr double wider = 3;
/// Slopes of an inequality at nodes below this part of the largest do not make it a distance.
inline constexpr double least_slope = 1e-4;
/// Elements on which a path that passes a corner holds both sides of it, at most.
inline constexpr double corner_elements = 2.5;
/// Whether inequalities contradict each other is looked for at so many times, from so many points about the
/// guess at each; most steps, the least part of one, and what is missed only by roundoff.
inline constexpr int compared_times = 32, compared_starts = 3, most_approaches = 100;
inline constexpr double least_approach = 1e-6, negligible_miss = 1e-7;
/// A free duration, or an unknown constant, of a coarse path: ratio of the first two, largest ratio of two
/// in succession, halvings on the way to one where there is a minimum, steps; it is found where a step is
/// smaller than this part of it.
inline constexpr double first_ratio = 1.05, most_ratio = 2, near_duration = 1e-5;
inline constexpr int most_halvings = 6, most_durations = 40;
/// Where the values come nearer to zero by less than this part in so many steps, none of them being zero,
/// they have an extremum there.
inline constexpr double useful_share = 0.9;
inline constexpr int most_vain_durations = 8;
/// A minimum is on another side of an obstacle, perhaps, if nodes that move straight there are so deep in it,
/// in parts of the size of the path, at one of so many points. Boundaries curve by less between neighbours.
inline constexpr double crossing_depth = 0.01;
inline constexpr double crossing_points = 32;
/// Then the path moves by steps of this part of its size, at most so many. The last one is shorter than this
/// part of a step, so that no bound acts.
inline constexpr double confined_step = 0.05, confined_end = 0.99;
inline constexpr int most_confined = 60;
/// A closed path is shifted in time where a contact begins or ends within so many elements of t = 0.
inline constexpr double clear_elements = 4;
/// Coordinates times elements of a coarse path, at most.
inline constexpr int most_unknowns = 40'000;
/// The arcs are solved to this part of the tolerance: differences of their momenta are derivatives.
inline constexpr double arc_share = 0.03, least_arc_tolerance = 2e-13, arc_share_again = 0.5;
/// Roundoff of positions, by their magnitude: the range of a short arc may not be known any better than a
/// part of itself, at most the second.
inline constexpr double arc_roundoff = 1e-14, most_arc_tolerance = 1e-3;
/// Displacements for differences, relative to the size of the path and to the duration; of a junction at most
/// this part of the arcs beside it.
inline constexpr double difference = 1e-5, difference_share = 0.2;
/// Momenta agree at a junction within this part of the largest.
inline constexpr double matched = 1e-12;
/// Of a distance from a surface, by the size of the path: roundoff of a point that is given on it.
inline constexpr double on_it = 1e-7;
/// Parts of the tolerance for the next step, by which Newton's method ends: what it aims at, and what is
/// enough where it goes no further.
inline constexpr double converged_share = 0.02, enough_share = 0.3;
inline constexpr int most_steps = 30;
/// Where a step would leave so large a part of the equations, they contradict each other.
inline constexpr double disagreeing = 0.3;
/// Times of changes that are told apart, by the shortest arc and by what lies between the first and the last;
/// a change moves by no more than this part of the arcs beside it.
inline constexpr double apart = 2, told_apart = 0.1, most_apart = 0.3;
/// A step may shorten an arc to this part of its length.
inline constexpr double shortest_step = 0.2;
inline constexpr double least_damping = 1e-3;
/// Arcs shorter than this part of the duration are left out.
inline constexpr double shortest_arc = 1e-6;
/// Singular values below this, relative, belong to directions that momenta do not depend on.
inline constexpr double rank = 1e-7;
/// Singular values below this, relative, are zero within what differences tell: such paths of one action are
/// taken for members of a continuum.
inline constexpr double singular_rank = 1e-4;
/// Changes of the set of arcs before a finer coarse path is looked for.
inline constexpr int most_changes = 12;
/// Points in each element at which the inequalities are compared, and forces of contact.
inline constexpr int points = 24;
/// Points along a whole path, once nothing else is wrong: inequalities may change fast in time.
inline constexpr double dense_points = 4096;
/// A path is freed along so many times the stretch in which its force is negative, −k (a² − s²) there:
/// between tangents at ±b it leaves the surface by ∫ k (a² − s²) ds = 0, so that b = √3 a.
inline constexpr double freed_stretch = 1.7320508;
/// Negative forces that are roundoff, relative to the largest force and momentum by time.
inline constexpr double negative_force = 1e-6;
/// Degree of elements of paths that constraints determine, and their largest number.
inline constexpr int held_degree = 8, most_held_elements = 1024;
/// Places on an element at which it is compared with what is forbidden; slopes of a boundary that differ by
/// less, of unit size, have one direction; the least and the largest distance by which a path is moved aside,
/// in parts of its size, and halvings between.
inline constexpr int points_between = 8, aside_halvings = 8;
inline constexpr double turned = 1e-2, least_aside = 1e-6, most_aside = 2;
/// The middle of an element between two points of a boundary is no deeper than this part of its length.
inline constexpr double deepest_chord = 0.2;
/// Steps of a path that has been moved out of what is forbidden: longer than this part of it, it jumps.
inline constexpr double jump = 0.1;
/// A path of which so many of its elements are forbidden is bent aside by these parts of its size.
inline constexpr double bends[] = {0, 0.1, -0.1, 0.3, -0.3, 1, -1, 3, -3};
inline constexpr int most_pushes = 30;
/// The second variation with this part of the kinetic one added is positive at a minimum, also where
/// symmetries make it singular.
inline constexpr double shift = 1e-3;
/// Elements on which the second variation is taken, at least so many in each arc. They end where contacts do:
/// then that of a shift in time is zero to second order.
inline constexpr int variation_elements[] = {384, 1536}, least_arc_elements = 4;
/// In contacts, by the cube root of how short they are.
inline constexpr double turn_elements = 1.0 / 96;
/// Points at which an inequality is looked for aside of a path, as far as the path is long, and how often
/// that is doubled; steepest slope of a path that goes round it, by its length; combinations of sides.
inline constexpr int side_points = 96, most_reaches = 7;
inline constexpr double side_slope = 4;
inline constexpr std::size_t most_sides = 64;
/// Sweeps over the nodes that pull a path tight, the last of them without over-relaxation; it is tight where
/// nodes move by less than this part of its size. Then estimates of actions are this good; paths that differ
/// by less than that part of their size are one.
inline constexpr int most_sweeps = 100, plain_sweeps = 5;
inline constexpr double tight = 1e-4, tight_action = 2e-3, one_tight_path = 2e-3;
/// Waves of first paths of a search, their sizes, and starts in vain after which it ends.
inline constexpr int waves = 4;
inline constexpr double wave_sizes[] = {0.35, 0.8, 1.6};
inline constexpr int most_in_vain = 24;
/// Bent paths that are tried where the guess has led to no minimum, while coarse minima are no more than
/// these.
inline constexpr int most_bends = 6, most_attempts = 12;

}  // namespace extremal::limits::contact
