#include <cmath>

#include "solve/laws.hpp"

/// \file What the points of the elements do not see, and what roundoff hides, is no solution.

namespace extremal::laws {
namespace {

/// A body that falls in from 370 lengths away, free to start anywhere, meets the centre's force in the last
/// 0.003 of its way, between two points of the last element; near a focal point that moves its start by far
/// more than its end.
TEST(Unseen, ForceJustBeforeTheEnd) {
  const auto hill = trace(3, [](auto q, auto v, auto) {
    const auto r = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + (q[0] * v[1] - q[1] * v[0]) + 1.5 * q[0] * q[0] -
           q[2] * q[2] / 2 + 1 / r;
  });
  const Problem problem = with_ends(hill, 1.8386363858303114, [](BoundaryRelation& b) {
    b.fix(0, true, 0.09888550987587896);
    b.fix(1, true, -0.7612695457414451);
    b.fix(2, true, 0.4111700014519001);
  });
  const Solution exact = solve(problem, within(1e-12));
  int refused = 0;
  for (const double tolerance : {1e-5, 8e-7, 1e-7, 1e-8, 1e-9}) {
    const Solution s = Solver().solve(problem, within(tolerance));
    refused += !s.converged();
    if (!s.converged()) continue;
    Values q(3), v(3);
    const double error = distance(s.trajectory, [&](double t) { return exact.trajectory.at(t, q, v), q; });
    EXPECT_LT(error, 10 * std::max(s.error_estimate, tolerance)) << tolerance;
  }
  EXPECT_LT(refused, 5);
}

/// To fall by 1 from rest takes √2, at the least energy of all falls: E − E_min = (T − √2)²/2 + …, so that a
/// last digit of E is half the digits of T.
TEST(Unseen, RoundoffOfTheEnergyAtAFold) {
  const auto falling = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + q[0]; });
  Problem problem = fixed_ends(falling, {0}, {1}, 1.3);
  problem.duration = {.value = 1.3, .free = true, .energy = 0, .where = {}};
  problem = make_problem(problem);
  std::vector<SolveOptions> ways{within(1e-4), within(1e-9), within(1e-12)};
  for (const int elements : {10, 1000, 60000}) ways.push_back(pinned(scheme("quadratic"), elements));
  for (const SolveOptions& options : ways) {
    const Solution s = Solver().solve(problem, options);
    if (!s.converged()) continue;
    EXPECT_LT(std::abs(s.duration() - std::sqrt(2.0)), 10 * s.error_estimate) << options.elements;
    EXPECT_EQ(s.nullity, 0);
  }
}

/// Two atoms farther apart than where their attraction is greatest, every end free: they rest at the minimum
/// of their potential, or run away, to where all directions are null.
TEST(Unseen, AtomsThatRanAway) {
  const auto atoms = trace(2, [](auto q, auto v, auto) {
    const auto r2 = (q[1] - q[0]) * (q[1] - q[0]);
    const auto s6 = 1 / (r2 * r2 * r2);
    return (v[0] * v[0] + v[1] * v[1]) / 2 - 4 * (s6 * s6 - s6);
  });
  for (const double apart : {1.0, 1.6, 3.0})
    for (const double tolerance : {1e-4, 1e-9}) {
      const Problem problem = guessed(with_ends(atoms, 0.01, [](BoundaryRelation&) {}), [&](double) {
        return Values{0, apart};
      });
      const Solution s = Solver().solve(problem, within(tolerance));
      if (!s.converged()) continue;
      for (std::size_t k = 0; k < s.trajectory.nodes.size(); k += 2)
        EXPECT_NEAR(s.trajectory.nodes[k + 1] - s.trajectory.nodes[k], std::pow(2, 1.0 / 6), 10 * tolerance)
            << apart;
    }
}

}  // namespace
}  // namespace extremal::laws
