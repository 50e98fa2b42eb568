#pragma once

#include "solve/iteration.hpp"

/// \file Whether the equations hold where an iteration came to rest.

namespace extremal {

/// Where the ends are not fixed, a second variation that is nearly singular lets steps become short although
/// δS does not vanish against the momenta.
class ResidualTest {
 public:
  /// At the path where it ended; `magnitude` is the largest |q|. `allowed`, relative to the largest momentum:
  /// what holds the phase of a periodic path.
  bool passed(const Problem& problem, NewtonIteration& newton, const Path& path, double magnitude,
              double allowed = 0);

  /// What the last test found left, relative to the largest momentum.
  double share() const { return share_; }

  /// Why the last test was not passed.
  std::string message() const;

 private:
  double share_ = 0;
};

}  // namespace extremal
