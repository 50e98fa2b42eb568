#include <cmath>
#include <string>

#include "machine/long_test.hpp"
#include "solve/laws.hpp"

/// \file Ends that are free along directions which are nearly null: paths that come to rest beside the
/// equations are no solutions.

namespace extremal::laws {
namespace {

/// A sphere in kilometres near its pole: v has hardly a mass there, and what counts as roundoff of the force
/// on u is no excuse for what is left of its condition.
TEST(SoftEnds, RoundoffIsThatOfTheRow) {
  const auto sphere = trace(2, [](auto q, auto v, auto) {
    const auto across = cos(q[0]) * v[1];
    return 6378.0 * 6378.0 * (v[0] * v[0] + across * across) / 2.0;
  });
  const Problem problem = with_ends(sphere, 0.8354586921666689, [](BoundaryRelation& b) {
    const int row = b.add_row(-2.2288916287209277);
    b.add(row, 2, 0.7532838229981538);
    b.add(row, 3, -1);
  });
  const Solution s = Solver().solve(problem, within(2.7e-6));
  if (!s.converged()) return;
  const double momentum = std::max(std::abs(s.momentum_start[0]), std::abs(s.momentum_start[1]));
  EXPECT_LE(momentum, 1e-12 * 6378.0 * 6378.0) << s.message;
}

/// x is led from 0 to 1, y is free at both ends and rests where nothing pulls: at 1/2. It is pulled there by
/// 1e-10 of what the second variation is across: at the guess, y = 0, by half the residual that may be left.
TEST(SoftEnds, WeakForcesCount) {
  const auto pulled = trace(2, [](auto q, auto v, auto) {
    const auto off = q[1] - 0.5;
    return (v[0] * v[0] + v[1] * v[1] - 1e-10 * off * off) / 2.0;
  });
  const Problem problem = with_ends(pulled, 1, [](BoundaryRelation& b) {
    b.fix(0, false, 0);
    b.fix(0, true, 1);
  });
  const Solution s = Solver().solve(problem, within(1e-4));
  ASSERT_TRUE(s.converged()) << s.message;
  for (std::size_t k = 1; k < s.trajectory.nodes.size(); k += 2)
    EXPECT_NEAR(s.trajectory.nodes[k], 0.5, 1e-4);
}

/// The same with roundoff amplified to more than is allowed: that is said, or the place is right.
TEST(SoftEnds, AmplifiedRoundoffIsToldOf) {
  const auto pulled = trace(2, [](auto q, auto v, auto) {
    const auto off = q[1] - sin(q[0]);
    return (v[0] * v[0] + v[1] * v[1] - 1e-10 * off * off) / 2.0;
  });
  const Problem problem = with_ends(pulled, 1, [](BoundaryRelation& b) {
    b.fix(0, false, 0);
    b.fix(0, true, 1);
  });
  const Solution s = Solver().solve(problem, within(1e-9));
  if (s.converged()) {
    EXPECT_NEAR(s.trajectory.nodes[1], 1 - std::cos(1.0), 1e-8);
  } else {
    EXPECT_NE(s.message.find("roundoff"), std::string::npos) << s.message;
  }
}

/// A charge in the field of a dipole, which vanishes far away: so do all conditions on momenta.
TEST(SoftEnds, FarAwayNothingIsAnExtremal) {
  LONG_TEST();
  const auto dipole = trace(3, [](auto q, auto v, auto) {
    const auto r = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2.0 + (q[0] * v[1] - q[1] * v[0]) / (r * r * r);
  });
  const Problem problem = with_ends(dipole, 1.1414026945963431, [](BoundaryRelation& b) {
    const int z = b.add_row(-0.07790247356864485);
    b.add(z, 2, 1.0458739576305751);
    b.fix(0, true, 0.6296938642969294);
    const int both = b.add_row(1.0478610033430418);
    b.add(both, 5, 1);
    b.add(both, 0, 1.83266576468293);
  });
  SolveOptions options = within(1.2e-8);
  options.scheme = lobatto(12);
  const Solution s = Solver().solve(problem, options);
  // From the guess the scheme leads there. The extremal that is returned is near, and the one without it.
  const Solution near = Solver().solve(problem, within(1.2e-8));
  ASSERT_TRUE(s.converged() && near.converged()) << s.message;
  EXPECT_NEAR(s.action, near.action, 1e-12);
  for (const double q : s.trajectory.nodes) EXPECT_LT(std::abs(q), 10);
}

/// A Morse oscillator that flies by a distance d in no time, its momenta at both ends alike: V(x0) = V(x0 +
/// d), e^x0 = (1 + e^−d)/2. That hardly moves x0: roundoff of p is amplified by 1e4, of which one solve may
/// meet nothing.
TEST(SoftEnds, EstimatesKnowTheRoundoffOfMomenta) {
  const auto morse = trace(1, [](auto q, auto v, auto) {
    const auto rise = 1 - exp(-q[0]);
    return v[0] * v[0] / 2 - 0.5 * rise * rise;
  });
  for (const double d : {1.7, 2.498362795421397, 3.1})
    for (const double T : {0.02, 0.036653317835412872, 0.07})
      for (const double tolerance : {1e-6, 7.4e-9, 1e-11}) {
        const Problem problem = with_ends(morse, T, [&](BoundaryRelation& b) {
          const int row = b.add_row(d);
          b.add(row, 0, -1);
          b.add(row, 1, 1);
        });
        const Solution s = Solver().solve(problem, within(tolerance));
        ASSERT_TRUE(s.converged()) << s.message;
        const double error = std::abs(s.trajectory.nodes[0] - std::log((1 + std::exp(-d)) / 2));
        EXPECT_LT(error, 100 * s.error_estimate) << d << ' ' << T << ' ' << tolerance;
        EXPECT_LT(error, tolerance * d);
      }
}

}  // namespace
}  // namespace extremal::laws
