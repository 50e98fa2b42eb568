#pragma once

#include <optional>
#include <vector>

#include "solve/contact/junctions.hpp"

/// \file Whether arcs that meet are a minimum under inequalities.

namespace extremal {

/// Where a path is forbidden, or a contact pulls.
struct Violation {
  int constraint = 0;
  bool forbidden = true;  ///< else the force of a contact is negative
  double from = 0, to = 0;
  double amount = 0;  ///< distance from what is allowed, in units of q; or the force
};

/// The worst violation of a path of arcs; a path that is forbidden goes first. Nothing where all inequalities
/// hold to the tolerance between the nodes as well, and no force is negative.
std::optional<Violation> worst_violation(Arcs& arcs, const Junctions& path);

/// Whether the second variation is positive among displacements that keep the contacts.
bool is_minimum(Arcs& arcs, const Junctions& path);

}  // namespace extremal
