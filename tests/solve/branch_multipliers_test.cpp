#include <complex>

#include "analysis/multipliers.hpp"
#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Multipliers along a branch, which come from its own elements where these resolve Jacobi fields.

namespace extremal::laws {
namespace {

/// Pieces made for Jacobi fields tell the same.
TEST(BranchMultipliers, AreThoseOfTheTrajectory) {
  const Study study = load(bench_data("halo.toml"));
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-11}) {
    const ProblemFamily family{study.problem, Varied::energy, *study.problem.duration.energy, -1.5};
    Continuation branch(family, {.solve = within(tolerance), .points = 8});
    for (const BranchPoint& point : follow(branch)) {
      SecondVariation variation;
      ASSERT_TRUE(variation.assemble(study.problem.lagrangian, point.solution.trajectory));
      const std::optional<Floquet> own =
          floquet(variation, {.map = {}, .relative_error = tolerance, .autonomous = true});
      ASSERT_TRUE(own && point.solution.floquet);
      const std::complex<double> expected = own->multipliers[0],
                                 found = point.solution.floquet->multipliers[0];
      EXPECT_LE(std::abs(found / expected - 1.0), 0.01 * tolerance + 1e-11) << tolerance << ' ' << expected;
    }
  }
}

/// However little is known of an orbit, its multipliers are not all 1 for it.
TEST(BranchMultipliers, AreNotOneWhereTheOrbitIsHardlyKnown) {
  const Study study = load(bench_data("halo.toml"));
  const Solution solution = solve(study.problem, within(1e-9));
  SecondVariation variation;
  ASSERT_TRUE(variation.assemble(study.problem.lagrangian, solution.trajectory));
  const auto multipliers = [&](double error) {
    return floquet(variation, {.map = {}, .relative_error = error, .autonomous = true});
  };
  const std::optional<Floquet> known = multipliers(1e-9), hardly = multipliers(1);
  ASSERT_TRUE(known && hardly);
  ASSERT_LT(known->trivial_pairs, 3);
  EXPECT_EQ(hardly->multipliers, known->multipliers);
}

}  // namespace
}  // namespace extremal::laws
