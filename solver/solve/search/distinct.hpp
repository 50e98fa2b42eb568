#pragma once

#include <optional>
#include <vector>

#include "solution/solution.hpp"

/// \file Whether two solutions of one problem are the same extremal.

namespace extremal {

/// Whether their distance is within their errors and the tolerance. A path that is small against `scale`, the
/// size of the problem, is at rest.
bool same_path(const Solution& a, const Solution& b, double tolerance, double scale);

/// Whether both belong to one continuum, by these numbers: the second variation of each is singular, and
/// action, duration, energy and index agree. So do time shifts of a periodic orbit, and its images under a
/// continuous symmetry.
bool same_continuum(const Solution& a, const Solution& b, double tolerance);

/// The same for orbits of an autonomous periodic problem, all of which have shifts of time: images of one
/// orbit under symmetries, of time and of space, continuous or not, are the same, if action, duration and
/// energy agree.
bool same_orbit(const Solution& a, const Solution& b, double tolerance);

/// Whether one is the other moved by a vector that leaves L unchanged, as angles have; of periodic paths,
/// where the period of L is given, perhaps some of these later.
bool same_but_for_place(const Lagrangian& lagrangian, const Solution& a, const Solution& b,
                        std::optional<double> period, double tolerance);

/// Whether two solutions on the same elements are the same to roundoff.
bool same_discrete(const Solution& a, const Solution& b);

void sort_by_action(std::vector<Solution>& solutions);

}  // namespace extremal
