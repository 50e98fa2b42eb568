#pragma once

#include <string>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "solve/external/inequality_minimum.hpp"

/// \file Minima of the coarse action; a free duration with them.

namespace extremal {

struct CoarseMinimum {
  MinimumReport report;
  std::string reason;  ///< why no duration was found, where that is known
};

/// Takes the nodes z of a path of so many elements to a minimum of the coarse action at the problem's
/// duration. A free duration becomes one at which the minimum has the energy given, or satisfies the
/// condition that closes it: the minimum is continued in the duration from that of the problem, by the secant
/// rule.
CoarseMinimum coarse_minimum(Problem& problem, int elements, std::vector<double>& z,
                             const Deadline& deadline);

}  // namespace extremal
