#pragma once

#include <stdexcept>

#include "problem/problem.hpp"
#include "problem/rest_point.hpp"

/// \file Ends at infinity: an end at which every coordinate is fixed at an equilibrium of L.

namespace extremal {

/// Why an end cannot be at infinity.
struct InfiniteEndError : std::invalid_argument {
  enum class About { start, end, both } about;
  InfiniteEndError(About about, const std::string& message) : std::invalid_argument(message), about(about) {}
};

/// The ends of a relation that are at infinity; at least one is. Where L depends on t, only t → ∞ can be: L
/// approaches there a Lagrangian with this equilibrium. Throws InfiniteEndError where no end has every
/// coordinate fixed at an equilibrium, where that is not hyperbolic, and where two equilibria have different
/// values of L. `names` are those of the coordinates.
InfiniteEnds infinite_ends(const Lagrangian& lagrangian, const EndMap& ends,
                           const std::vector<std::string>& names);

/// The equilibrium of an infinite end with its linear motion, at time t.
RestPoint rest_point_of(const Lagrangian& lagrangian, const InfiniteEnds& infinite, bool at_end, double t);

/// The time in which the slowest linear motions at the infinite ends decay far below any tolerance's root.
double approach_time(const Lagrangian& lagrangian, const InfiniteEnds& infinite);

/// Leaves the infinite ends of a problem free, and gives it the default guess if it has none: from the
/// finite end, or from equilibrium to equilibrium along the straight line, at the rates of the slowest linear
/// motions. Free coordinates of the finite end are those of linear motions with the momenta asked for. Throws
/// InfiniteEndError where that guess is the equilibrium itself.
void make_infinite(Problem& problem, InfiniteEnds infinite);

}  // namespace extremal
