#include <numbers>

#include "machine/long_test.hpp"
#include "solve/laws.hpp"

/// \file What cannot be solved is said to be so, and nothing that is not finite is returned.

namespace extremal::laws {
namespace {

using std::numbers::pi;

bool finite(const Values& x) {
  return std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); });
}

void expect_finite(const Solution& s) {
  EXPECT_TRUE(std::isfinite(s.action));
  EXPECT_TRUE(std::isfinite(s.energy.value_or(0)));
  EXPECT_TRUE(std::isfinite(s.energy_drift.value_or(0)));
  EXPECT_TRUE(std::isfinite(s.error_estimate));
  EXPECT_TRUE(std::isfinite(s.residual));
  EXPECT_TRUE(finite(s.momentum_start) && finite(s.momentum_end));
  EXPECT_TRUE(finite(s.trajectory.times) && finite(s.trajectory.nodes));
  for (const Iteration& i : s.history)
    EXPECT_TRUE(std::isfinite(i.residual) && std::isfinite(i.step) && std::isfinite(i.damping));
}

const double asked[] = {1e-3, 1e-6, 1e-9, 1e-13};

std::vector<SolveOptions> adaptive() {
  std::vector<SolveOptions> list;
  for (double tolerance : asked) list.push_back(within(tolerance));
  return list;
}

/// Adaptive, and every scheme on few elements.
std::vector<SolveOptions> every_way() {
  std::vector<SolveOptions> list = adaptive();
  for (const Scheme& scheme : schemes_and_families())
    for (int elements : {1, 8}) list.push_back(pinned(scheme, elements));
  return list;
}

/// What solving returns that it should not: convergence, or a message without `words`.
std::string wrong_answers(const Problem& problem, const std::vector<SolveOptions>& ways,
                          const std::string& words) {
  std::string list;
  for (const SolveOptions& options : ways) {
    Solver solver;
    const Solution s = solver.solve(problem, counted(options));
    expect_finite(s);
    if (!s.converged() && s.message.find(words) != std::string::npos) continue;
    const std::string way = options.scheme ? fmt::format("{} on {}", options.scheme->name, options.elements)
                                           : fmt::format("tolerance {}", options.tolerance);
    list += fmt::format("{}: {}; ", way, s.message);
  }
  return list;
}

/// √(q − 5) is not a number on the way from 0 to 1, however the guess is bent within its length.
TEST(Failure, LagrangianThatIsNotFinite) {
  const auto lagrangian = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + sqrt(q[0] - 5); });
  EXPECT_EQ(wrong_answers(fixed_ends(lagrangian, {0}, {1}, 1), every_way(), "not finite"), "");
}

/// ∂²L/∂q'² = 0 in some direction: δS = 0 is no differential equation of second order.
TEST(Failure, SingularMass) {
  const auto total = trace(1, [](auto q, auto v, auto) { return v[0] * q[0]; });
  EXPECT_EQ(wrong_answers(fixed_ends(total, {0}, {1}, 1), adaptive(), "singular"), "");
  const auto half = trace(2, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + v[1] * q[0]; });
  EXPECT_EQ(wrong_answers(fixed_ends(half, {0, 0}, {1, 1}, 1), adaptive(), "singular"), "");
}

/// On few elements too, what is returned is finite.
TEST(Failure, SingularMassLeavesNoNaN) {
  const auto total = trace(1, [](auto q, auto v, auto) { return v[0] * q[0]; });
  for (const SolveOptions& options : every_way())
    expect_finite(Solver().solve(fixed_ends(total, {0}, {1}, 1), options));
}

/// The ends are conjugate (T = π) and their values do not admit a solution.
TEST(Failure, ConjugateEnds) {
  EXPECT_EQ(wrong_answers(fixed_ends(systems::oscillator(1), {0}, {1}, pi), adaptive(), "singular"), "");
}

TEST(Failure, ToleranceBeyondRoundoff) {
  LONG_TEST();
  for (const Problem& problem : {fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5),
                                 fixed_ends(systems::pendulum(), {0}, {1.5}, 2)})
    EXPECT_EQ(wrong_answers(problem, {within(1e-17)}, "loosen"), "");
}

/// The message names the end at which L is infinite, and the speed that no path has.
TEST(Failure, EndsThatNoPathReaches) {
  LONG_TEST();
  const Problem centre = fixed_ends(systems::kepler(), {1, 0}, {0, 0}, 1);
  EXPECT_EQ(wrong_answers(centre, {within(1e-9)}, "not finite at the end, q[1] = 0, q[2] = 0"), "");
  const auto relativistic = trace(1, [](auto, auto v, auto) { return -sqrt(1 - v[0] * v[0]); });
  EXPECT_EQ(wrong_answers(fixed_ends(relativistic, {0}, {3}, 2.9), {within(1e-9)}, "try a longer one"), "");
  EXPECT_TRUE(Solver().solve(fixed_ends(relativistic, {0}, {3}, 3.1), within(1e-9)).converged());
}

/// On the sphere φ has no inertia at the pole.
TEST(Failure, MassThatIsSingularAtAnEnd) {
  const auto sphere = trace(
      2, [](auto q, auto v, auto) { return (v[0] * v[0] + sin(q[0]) * sin(q[0]) * v[1] * v[1]) / 2.0; });
  EXPECT_EQ(wrong_answers(fixed_ends(sphere, {0, 0}, {0, 1}, 1), {within(1e-9)}, "a point of the start"), "");
}

/// A free particle has no energy below 0: no T closes the problem.
TEST(Failure, EnergyThatNoPathHas) {
  const auto free_particle = trace(1, [](auto, auto v, auto) { return v[0] * v[0] / 2; });
  Problem problem = fixed_ends(free_particle, {0}, {1}, 1);
  problem.duration = {.value = 1, .free = true, .energy = -0.5, .where = {}};
  EXPECT_EQ(wrong_answers(make_problem(problem), every_way(), ""), "");
}

/// A failure leaves nothing behind in the solver.
TEST(Failure, DoesNotDisturbTheNextSolve) {
  const Problem good = fixed_ends(systems::pendulum(), {0}, {1.5}, 2);
  const Solution fresh = solve(good, within(1e-11));
  Solver solver;
  const auto bad = trace(1, [](auto q, auto v, auto) { return v[0] * q[0]; });
  EXPECT_FALSE(solver.solve(fixed_ends(bad, {0}, {1}, 1), within(1e-9)).converged());
  const Solution after = solver.solve(good, within(1e-11));
  EXPECT_TRUE(after.converged());
  EXPECT_EQ(after.trajectory.nodes, fresh.trajectory.nodes);
  EXPECT_EQ(after.action, fresh.action);
}

}  // namespace
}  // namespace extremal::laws
