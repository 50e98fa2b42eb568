#include "solve/residual_test.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace extremal {

namespace {

/// A residual below this, relative to the largest momentum or to the first residual, may be roundoff; one
/// above the second is not what Newton's method leaves.
constexpr double least = 1e-10, largest = 1e-6;
/// Of a body at rest, relative to forces that cancel.
constexpr double roundoff = 1e-14;

}  // namespace

void ResidualTest::begin(const Problem& problem, NewtonIteration& newton, const Path& path) {
  first_ = problem.ends.free > 0 ? newton.residual_at(path) : 0;
}

bool ResidualTest::passed(const Problem& problem, NewtonIteration& newton, const Path& path, double allowed,
                          double magnitude) {
  if (problem.ends.free == 0) return true;
  const double left = newton.residual_at(path), momentum = newton.action().momentum_scale();
  share_ = left / momentum;
  return left <= std::max({std::clamp(allowed, least, largest) * momentum, least * first_,
                           roundoff * newton.stiffness() * magnitude});
}

std::string ResidualTest::message() const {
  return fmt::format(
      "the iteration came to rest where a residual of {:.1e} of the largest momentum is left: there is no "
      "extremal near, or the second variation is nearly singular; try another guess",
      share_);
}

}  // namespace extremal
