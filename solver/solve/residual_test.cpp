#include "solve/residual_test.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace extremal {

namespace {

/// A residual below this, relative to the largest momentum, may be roundoff.
constexpr double least = 1e-10;
/// Of a body at rest, relative to forces that cancel.
constexpr double roundoff = 1e-14;

}  // namespace

bool ResidualTest::passed(const Problem& problem, NewtonIteration& newton, const Path& path, double magnitude,
                          double allowed) {
  if (problem.ends.free == 0) return true;
  const double left = newton.residual_at(path), momentum = newton.action().momentum_scale();
  share_ = left / momentum;
  return left <= std::max({std::max(least, allowed) * momentum, roundoff * newton.stiffness() * magnitude});
}

std::string ResidualTest::message() const {
  return fmt::format(
      "the iteration came to rest where a residual of {:.1e} of the largest momentum is left: there is no "
      "extremal near, or the second variation is nearly singular; try another guess",
      share_);
}

}  // namespace extremal
