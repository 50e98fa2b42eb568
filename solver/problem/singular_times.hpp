#pragma once

#include <vector>

#include "problem/problem.hpp"

/// \file Ends at whose time L is infinite or the mass vanishes, wherever the path is there.
///
/// As with a force like 1/√t, with a centrifugal term q²/t² in polar coordinates, or with a weight √t. With τ
/// the time from such an end, ∂²L/∂q'² ~ τ^a and ∂L/∂q ~ τ^b at the point where the path ends. Motions are
/// sums of powers of τ: 0, that of a constant momentum, 1 − a, and that which forces add, 2 + b − a. Their
/// momenta have 1 + b, and the action 1 + |a| and 3 + 2b − a. Where ∂²L/∂q² ~ K τ^(a−2), and ∂²L/∂q'² is
/// M τ^a, the power r of a motion solves Euler's equation, r (r − 1 + a) = K/M. With τ ~ s^k, where all of
/// these times k are whole or large, motions and action are smooth in s.

namespace extremal {

/// An end of this kind.
struct SingularTime {
  bool at_end = false;
  double mass = 0;  ///< a
  enum class Kind {
    powers,     ///< motions are smooth in s
    loose,      ///< a >= 1: no force holds the value that is given
    divergent,  ///< the action is infinite, whatever the path
    slow        ///< the action has a power that elements do not resolve
  } kind = Kind::powers;
  double power = 1;               ///< k
  bool unknown_momentum = false;  ///< infinite, or of a power that elements do not resolve
  /// ∂²L/∂q² is negative and grows like τ^(a−2), so that it and the mass have infinite parts of opposite
  /// signs, or it grows faster.
  bool unknown_index = false;
};

/// The ends of a problem that are such, the start first. Its ends are fixed or free.
std::vector<SingularTime> singular_times(const Problem& problem);

}  // namespace extremal
