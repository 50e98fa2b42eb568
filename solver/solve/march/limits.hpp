#pragma once

#include "solve/mesh/roundoff.hpp"

/// \file The numbers that decide in marching.

namespace extremal::limits::march {

/// Unknowns of an element up to which the inverse of its matrix is kept; beyond, sparse factors.
inline constexpr int most_dense = 256;
/// Newton steps for an element.
inline constexpr int most_steps = 40;
/// A step below this, relative to the element's own extent, is roundoff; one below the second that does not
/// shrink to less than `stagnation` of the last, too; so is one of so many roundings of q, which the forces
/// have.
inline constexpr double negligible_step = 2 * unit_roundoff, small_step = 1e-12, stagnation = 0.25,
                        roundings = 16 * unit_roundoff;
/// A step that shrinks no more is roundoff if it is at most so many times what roundings of forces make.
inline constexpr double roundings_of_step = 4;
/// Where the force of an element changes the momentum by no more than this part, steps so many times larger
/// are: what they change the force by is smaller still.
inline constexpr double weak_force = 0.25, weak_factor = 4;
/// So few unknowns have a new matrix for each element.
inline constexpr int few_unknowns = 12;
/// A kept matrix serves as long as it shrinks a step to less than this; an element begins with it where it
/// shrank the first of the last one to less than the second.
inline constexpr double poor_contraction = 0.1, good_contraction = 0.02;
/// A step that is longer, relative to the extent of the element, and does not shrink by so much, may lead to
/// another solution of the equations than the nearest. So may one that is longer than all elements before, if
/// it does not solve linear equations.
inline constexpr double near = 1e-2, straight = 0.5, linear = 1e-6;
/// Steps by the kinetic energy alone shrink regularly; beyond the second they do not converge. After so many
/// elements where they did not they are not tried again.
inline constexpr double kinetic_stagnation = 0.7, divergence = 1e3;
inline constexpr int most_kinetic_failures = 8, most_cheap_steps = 20;
/// Where cheap steps do not converge, elements are cut to this part; what bounds them is raised again by the
/// second from element to element. After so many cuts in a row cheap steps are given up.
inline constexpr double cheap_cut = 0.6, cheap_growth = 1.02;
inline constexpr int most_cheap_cuts = 8;
/// An extent smaller than this part of the largest so far counts as so large.
/// Nor is one that is smaller than the second part of that of another coordinate told: a front that
/// runs into a body at rest begins with numbers below all others.
inline constexpr double least_extent = 1e-2, negligible_extent = 1e-25;
/// Orders of extrapolation from earlier elements, at most.
inline constexpr int most_differences = 10;
/// Pieces of an element that Newton's method fails on, each solved from the last, for a better start; and how
/// often they may be cut again.
inline constexpr int pieces = 4, most_cuts = 3;

/// Share of the tolerance that the truncation of an element is aimed at, and what may be accepted of it.
inline constexpr double aim = 0.2, accepted = 1.0;
/// Elements grow and shrink from one to the next by no more.
inline constexpr double most_growth = 2, fast_growth = 8, most_shrink = 0.2;
/// Coefficients fall at least so fast in an element that is accepted: else the estimate means little.
inline constexpr double slowest_fall = 0.6;
/// The first element, and the least, relative to the duration.
inline constexpr double first_length = 1e-6, least_length = 1e-15;
/// Degrees that are chosen from.
inline constexpr int least_degree = 4, highest_degree = 16;
/// The truncation of the march that another is compared with is so much smaller, and it has so many degrees
/// more.
inline constexpr double companion_share = 0.01;
inline constexpr int companion_degrees = 2;
/// No truncation, relative to the range, is aimed at below this.
inline constexpr double finest = 2e-15;
/// Of the tolerance, the first truncation of a march; from one march to the next it falls by no more, and to
/// this part of what the error asks for. A companion serves as long as its own is so much smaller.
inline constexpr double first_share = 0.25, most_fall = 1e-3, spare = 0.4, companion_enough = 0.2;
inline constexpr int most_marches = 10;
/// Part of the duration that tells how errors grow, where it takes so many elements.
inline constexpr double pilot_part = 1.0 / 32;
inline constexpr int least_pilot = 64;
/// Of the time until which a tolerance holds, what is advised: ranges are smaller then, and what roundoff
/// leaves differs from march to march.
inline constexpr double shorter = 0.4;
/// An error that another march with a smaller truncation does not lower to this part is roundoff, where it is
/// below the second part of the range: there it tells motions apart that are near each other.
inline constexpr double stagnant = 0.5, near_motions = 0.1;
/// The truncation of a motion that a scheme is compared with; errors below so many times that ask for the
/// finest.
inline constexpr double scheme_companion = 1e-10, scheme_margin = 1e4;
/// Equal elements: the first number, the most, and the largest factor from one to the next.
inline constexpr int first_elements = 16, most_elements = 20'000'000;
inline constexpr double most_element_growth = 16;
/// Elements that end so near before a kink, relative to their length, are made to end on it, as precisely as
/// the third number tells, relative to the duration. One that crosses it is cut to no less than the second.
inline constexpr double kink_near = 0.1, kink_least = 0.02, kink_precision = 1e-15;
inline constexpr int most_kink_tries = 12;
/// An instant beside the end of an element at which L jumps, by its length and by the time.
inline constexpr double instant = 1e-12, instant_digits = 16 * unit_roundoff;
/// Points of an exact quadrature.
inline constexpr int most_points = 20;
inline constexpr double exact = 1e-15;
/// Speeds this much above their mean along the motion belong to a collision.
inline constexpr double collision_speed = 30;
/// Numbers of a trajectory that are kept at most.
inline constexpr double most_numbers = 5e7;

}  // namespace extremal::limits::march
