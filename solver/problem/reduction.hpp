#pragma once

#include <optional>

#include "problem/problem.hpp"
#include "problem/signed_permutation.hpp"

/// \file Symmetries of periodic orbits, and the part of an orbit that they leave to be found.

namespace extremal {

/// Of an orbit with q(t + T) = R q(t): q(t + T/turns) = M q(t), where L(M q, M q') = L(q, q'), and perhaps
/// q(−t) = S q(t), where L(S q, −S q') = L(q, q'). M and S map paths onto paths of the same action: what is
/// stationary among paths that they leave as they are is stationary (Palais, The principle of symmetric
/// criticality, 1979). With S the part to be found is half of a turn, from q = S q to q = M S q at its ends,
/// natural in what these leave free.
struct Reduction {
  int turns = 1;
  SignedPermutation turn;                   ///< M
  std::optional<SignedPermutation> mirror;  ///< M S, about the end of the part
  Problem part;                             ///< its duration is T over parts()

  int parts() const { return mirror ? 2 * turns : turns; }
};

/// The shortest part, of a periodic problem whose guess has symmetries but for two percent of the range of
/// each coordinate; null if it has none. S and M are signed permutations of the coordinates.
std::shared_ptr<const Reduction> reduction_of(const Problem& problem);

}  // namespace extremal
