#include <algorithm>

#include "machine/long_test.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/iteration.hpp"
#include "solve/published.hpp"
#include "solve/scenes.hpp"

/// \file What an iteration takes for roundoff.

namespace extremal::laws {
namespace {

/// Near an encounter at 3e-4 of the size of the orbit roundoff of q is amplified some millions of times. How
/// many depends on the elements and on how sums are rounded, so the measure is held between what steps do, to
/// a factor of 50 on both sides: a step of that size is also bent by what it amplifies.
TEST(Roundoff, OfAStepIsAllThatStepsChange) {
  const nlohmann::json c = published("nbody_periodic_orbits.json", "3b-ff-F1_1_1_1_");
  const Study study = study_of(c, 1e-8);
  const Trajectory orbit = run(study).trajectory;
  Levels levels;
  levels.bind(study.problem.lagrangian);
  const ElementTables& tables = levels.at(orbit.degree);
  std::vector<double> mesh;
  for (double t : orbit.times) mesh.push_back(t / orbit.duration());
  Path path;
  path.reset(tables, mesh, orbit.duration());
  const std::size_t element = static_cast<std::size_t>(orbit.degree + 1) * orbit.coordinates;
  for (int k = 0; k < orbit.elements(); ++k) path.set_element(k, &orbit.nodes[k * element]);
  path.load_ends();

  NewtonIteration newton;
  newton.reset(study.problem, tables, path.elements());
  newton.set_scale(1);
  for (int k = 0; k < 5; ++k) ASSERT_EQ(newton.full_step(path, 0), StepResult::ok);
  // Chord steps alone may lead away: so much roundoff is beyond where old factors still contract.
  double noisiest = 0, largest = 0;
  for (int k = 0; k < 10; ++k) {
    ASSERT_EQ(newton.full_step(path, 0), StepResult::ok);
    const double noise = newton.roundoff(path);
    ASSERT_EQ(newton.chord_step(path), StepResult::ok);
    noisiest = std::max(noisiest, noise);
    largest = std::max(largest, newton.norm());
  }
  EXPECT_LT(largest, 50 * noisiest);
  EXPECT_GT(largest, noisiest / 50);
  EXPECT_GT(noisiest, 1e3 * unit_roundoff);
}

/// Roundoff of q amplified to 1e-8 hides a tolerance of 1e-9 from some elements on: thousands of times more
/// are not tried.
TEST(Roundoff, ThatHidesTheToleranceOfASchemeEndsIt) {
  LONG_TEST();
  const Study study = load(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/refused/nbody-amplified.toml");
  const Solution s = run(study);
  EXPECT_FALSE(s.converged());
  EXPECT_LT(s.iterations, 350) << s.message;
}

}  // namespace
}  // namespace extremal::laws
