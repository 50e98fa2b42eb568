#pragma once

#include "solve/iteration.hpp"

/// \file Whether the equations hold where an iteration came to rest.

namespace extremal {

/// Where the ends are not fixed, a second variation that is nearly singular lets steps become short although
/// δS does not vanish: neither against the momenta, nor, at rest, against what it was where the iteration
/// began.
class ResidualTest {
 public:
  /// At the path that the iteration starts from.
  void begin(const Problem& problem, NewtonIteration& newton, const Path& path);

  /// At the path where it ended; `allowed` of the largest momentum, `magnitude` the largest |q|.
  bool passed(const Problem& problem, NewtonIteration& newton, const Path& path, double allowed,
              double magnitude);

  /// Why the last test was not passed.
  std::string message() const;

 private:
  double first_ = 0, share_ = 0;
};

}  // namespace extremal
