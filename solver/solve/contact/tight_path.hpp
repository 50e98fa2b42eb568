#pragma once

#include <optional>
#include <vector>

#include "solve/contact/coarse_action.hpp"

/// \file Paths that are pulled tight about obstacles.

namespace extremal {

struct TightPath {
  double action = 0;
  std::vector<double> z;  ///< nodes
};

/// Moves a node to where all inequalities hold; false where that fails.
bool push_node(const Problem& problem, std::span<double> q, double t);

/// Nearly the minimum of S_h that a path slides to if it stays on its side of each obstacle: nodes move one
/// after the other, by so much more than to the minimum of S_h in one node that long waves are quick too
/// (successive over-relaxation; Young, Trans. AMS 76 (1954) 92), and back to where inequalities hold. The
/// inner nodes alone move. Nothing where that does not lower the action, or the path slips through.
std::optional<TightPath> pulled_tight(const Problem& problem, const CoarseAction& action,
                                      std::vector<double> z);

}  // namespace extremal
