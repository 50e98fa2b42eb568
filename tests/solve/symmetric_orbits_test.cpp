#include <fmt/format.h>
#include <gtest/gtest.h>

#include "problem/reduction.hpp"
#include "solve/scenes.hpp"

/// \file Orbits solved on the part that their symmetries leave, against the same solved as a whole.

namespace extremal::laws {
namespace {

Solution on_the_whole(Study study) {
  study.problem.reduction = nullptr;
  return run(study);
}

/// Where phases differ, so do not these.
void expect_same(const Solution& part, const Solution& whole, double tolerance) {
  ASSERT_TRUE(part.converged()) << part.message;
  ASSERT_TRUE(whole.converged()) << whole.message;
  EXPECT_NEAR(part.action, whole.action, tolerance * std::abs(whole.action));
  EXPECT_NEAR(part.duration(), whole.duration(), tolerance * whole.duration());
  EXPECT_NEAR(*part.energy, *whole.energy, tolerance * std::abs(*whole.energy));
  EXPECT_EQ(part.morse_index, whole.morse_index);
  EXPECT_EQ(part.nullity, whole.nullity);
  EXPECT_NEAR(std::abs(part.floquet->multipliers.front()), std::abs(whole.floquet->multipliers.front()),
              1e-3 * std::abs(whole.floquet->multipliers.front()));
}

TEST(SymmetricOrbits, AreThoseOfTheWholeProblem) {
  const std::pair<const char*, int> cases[] = {
      {"halo", 2}, {"lyapunov", 2}, {"nrho", 2}, {"figure-eight-near", 12}};
  for (const auto& [name, parts] : cases)
    for (const double tolerance : {1e-6, 1e-11}) {
      SCOPED_TRACE(fmt::format("{} {}", name, tolerance));
      Study study = load(bench_data(fmt::format("{}.toml", name)));
      study.options.tolerance = tolerance;
      ASSERT_TRUE(study.problem.reduction);
      EXPECT_EQ(study.problem.reduction->parts(), parts);
      const Solution part = run(study);
      EXPECT_EQ(part.trajectory.elements() % parts, 0);
      EXPECT_NE(part.message.find(fmt::format("1/{} of the orbit", parts)), std::string::npos);
      expect_same(part, on_the_whole(study), 10 * tolerance);
    }
}

/// A mound of force at one place of an orbit, too narrow to be met where symmetries are looked for.
TEST(SymmetricOrbits, AreGivenUpWhereForcesAreNot) {
  const Table orbit = read_table(bench_data("halo.csv"), 3);
  const State& at = orbit.states[40];
  const std::string lagrangian = fmt::format(
      "((x' - y)^2 + (y' + x)^2 + z'^2)/2 + (1 - mu)/r1 + mu/r2 + "
      "1e-5*exp(-((x - {})^2 + (y - {})^2 + (z - {})^2)/2e-6)",
      at.q[0], at.q[1], at.q[2]);
  Study study = load(bench_data("halo.toml"), {"system.lagrangian=" + lagrangian});
  ASSERT_TRUE(study.problem.reduction);
  study.options.tolerance = 1e-9;
  const Solution found = run(study);
  ASSERT_TRUE(found.converged()) << found.message;
  EXPECT_EQ(found.message.find("of the orbit"), std::string::npos);
  expect_same(found, on_the_whole(study), 1e-9);
}

}  // namespace
}  // namespace extremal::laws
