#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "rivals/problems.hpp"
#include "rivals/verify.hpp"

/// \file Which way round fields are that leave the start where it is.

namespace extremal {
namespace {

double orientation(const Problem& problem, const Trajectory& trajectory) {
  const Verification found = verify(problem, trajectory, {.tolerance = 1e-9});
  EXPECT_TRUE(found.verified) << found.message;
  return found.orientation;
}

/// ∂q(T)/∂p(0) = sin T: negative after an odd number of conjugate times, and next to nothing at one.
TEST(Orientation, OfTheOscillator) {
  for (const double T : {0.5, 3.0, 3.3, 6.0, 6.5, 9.6, 31.0, 31.6, 2 * std::numbers::pi}) {
    const auto swing = [](double t) { return std::vector{std::sin(t + 0.3)}; };
    const Problem problem = fixed_ends(oscillator(), swing(0), swing(T), T);
    const double found = orientation(problem, sampled(1, 64, T, swing));
    if (std::abs(std::sin(T)) < 1e-3)
      EXPECT_LT(std::abs(found), 1e-6) << T;
    else
      EXPECT_GT(found * std::copysign(1, std::sin(T)), 0.01) << T;
  }
}

/// Less than one turn: nothing is conjugate.
TEST(Orientation, OfKeplersArc) {
  EXPECT_GT(orientation(fixed_ends(kepler(), {1, 0}, {-0.6, 0.9}, 2.5),
                        reference_trajectory(*kepler(), "kepler-arc")),
            0.1);
}

}  // namespace
}  // namespace extremal
