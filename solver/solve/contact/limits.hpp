#pragma once

/// \file The numbers that decide where a path touches what inequalities forbid.

namespace extremal::limits::contact {

/// Equal elements on which contacts are looked for, coarse first: each further level serves where the one
/// before has not led to a solution.
inline constexpr int coarse_elements[] = {96, 384, 1152};
/// Elements on which a path that passes a corner holds both sides of it, at most.
inline constexpr double corner_elements = 2.5;
/// Coordinates times elements of a coarse path, at most.
inline constexpr int most_unknowns = 40'000;
/// The arcs are solved to this part of the tolerance: differences of their momenta are derivatives.
inline constexpr double arc_share = 0.03, least_arc_tolerance = 2e-13, arc_share_again = 0.5;
/// Displacements for differences, relative to the size of the path and to the duration.
inline constexpr double difference = 1e-5;
/// Momenta agree at a junction within this part of the largest.
inline constexpr double matched = 1e-12;
/// Parts of the tolerance for the next step, by which Newton's method ends: what it aims at, and what is
/// enough where it goes no further.
inline constexpr double settled_share = 0.02, enough_share = 0.3;
inline constexpr int most_steps = 30;
/// A step may shorten an arc to this part of its length.
inline constexpr double shortest_step = 0.2;
inline constexpr double least_damping = 1e-3;
/// Arcs shorter than this part of the duration are left out.
inline constexpr double shortest_arc = 1e-5;
/// Singular values below this, relative, belong to directions that momenta do not depend on.
inline constexpr double rank = 1e-7;
/// Singular values below this, relative, are zero within what differences tell: such paths of one action are
/// taken for members of a continuum.
inline constexpr double singular_rank = 1e-4;
/// Changes of the set of arcs before a finer coarse path is looked for.
inline constexpr int most_changes = 12;
/// Points in each element at which the inequalities are compared, and forces of contact.
inline constexpr int points = 24;
/// Negative forces that are roundoff, relative to the largest force and momentum by time.
inline constexpr double negative_force = 1e-6;
/// Degree of elements of paths that constraints determine, and their largest number.
inline constexpr int held_degree = 8, most_held_elements = 1024;
/// Steps of a path that has been moved out of what is forbidden: longer than this part of it, it jumps.
inline constexpr double jump = 0.1;
/// A path of which so many of its elements are forbidden is bent aside by these parts of its size.
inline constexpr double bends[] = {0, 0.1, -0.1, 0.3, -0.3, 1, -1, 3, -3};
inline constexpr int most_pushes = 30;
/// The second variation with this part of the kinetic one added is positive at a minimum, also where
/// symmetries make it singular.
inline constexpr double shift = 1e-3;
/// Elements on which the second variation is taken.
inline constexpr int variation_elements = 384;
/// Waves of first paths of a search, their sizes, and starts in vain after which it ends.
inline constexpr int waves = 4;
inline constexpr double wave_sizes[] = {0.35, 0.8, 1.6};
inline constexpr int most_in_vain = 24;
/// Bent paths that are tried where the guess has led to no minimum.
inline constexpr int most_bends = 6;

}  // namespace extremal::limits::contact
