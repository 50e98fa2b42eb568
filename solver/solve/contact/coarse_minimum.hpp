#pragma once

#include <string>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/external/inequality_minimum.hpp"

/// \file Minima of the coarse action; a free duration with them.

namespace extremal {

struct CoarseMinimum {
  MinimumReport report;
  std::string reason = {};                 ///< why no duration or unknowns were found, where that is known
  std::vector<double> z = {}, times = {};  ///< nodes
};

/// A minimum of the coarse action from the nodes z of a path at coarse_times(). A free duration becomes one
/// at which the minimum has the energy given, or satisfies the condition that closes it: the minimum is
/// continued in the duration from that of the problem, by the secant rule. Unknown constants become those
/// with which the minimum satisfies their conditions. The problem gets all of these values.
CoarseMinimum coarse_minimum(Problem& problem, const CoarseElements& elements, const std::vector<double>& z,
                             const Deadline& deadline);

}  // namespace extremal
