#include "solve/newton/raised_model.hpp"

#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/laws.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/mesh.hpp"
#include "solve/newton/converge.hpp"

/// \file Steps of elements of high degree from factors of low ones.

namespace extremal::laws {
namespace {

constexpr int particles = 170, chain_elements = 8, low_degree = 4, high_degree = 10;

/// Of particles between walls; springs have stiffness k and harden.
template <class Q>
auto potential(double k, const Q& q) {
  auto sum = k * (q[0] * q[0] + q[particles - 1] * q[particles - 1]) / 2;
  for (int a = 0; a + 1 < particles; ++a) {
    const auto d = q[a + 1] - q[a];
    sum = sum + k * d * d / 2 + d * d * d * d / 4;
  }
  return sum;
}

std::shared_ptr<const Lagrangian> springs(double k) {
  return trace(particles, [=](auto q, auto v, auto) {
    auto l = -potential(k, q);
    for (int a = 0; a < particles; ++a) l = l + v[a] * v[a] / 2;
    return l;
  });
}

/// From a wave to another. Where 2√k·duration < π the action is convex, but for what hardens.
Problem chain(double k, double duration, double amplitude) {
  Values start(particles), end(particles);
  for (int a = 0; a < particles; ++a) {
    start[a] = amplitude * std::sin(0.05 * (a + 1));
    end[a] = amplitude * (0.7 * std::sin(0.05 * (a + 1)) + 0.3 * std::sin(0.6 * (a + 1)));
  }
  return fixed_ends(springs(k), start, end, duration);
}

/// Newton's method to the end on one mesh, from the values of another path if there is one.
struct Converged {
  Levels levels;
  NewtonIteration newton;
  Path path;
  NewtonReport report;

  Converged(const Problem& problem, bool raised, const Path* from = nullptr) {
    levels.bind(problem.lagrangian);
    const ElementTables& tables = levels.at(high_degree);
    newton.reset(problem, tables, chain_elements, raised ? &levels.at(low_degree) : nullptr);
    path.reset(tables, uniform_mesh(chain_elements), problem.duration.value);
    start_path(problem, starting_ends(problem), tables, path);
    if (from) path.copy_values(*from);
    path.set_duration(problem.duration.value);
    report = converge(newton, path, tables, {1e-13, 40}, {});
  }
};

double distance(const Path& a, const Path& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.nodes().size(); ++k)
    most = std::max(most, std::abs(a.nodes()[k] - b.nodes()[k]));
  return most;
}

TEST(Raised, FindsTheSamePathByManyCheapSteps) {
  const Problem problem = chain(1, 1.2, 1);
  Converged raised(problem, true), exact(problem, false);
  ASSERT_TRUE(raised.report.reached && exact.report.reached) << raised.report.failure << exact.report.failure;
  EXPECT_LT(distance(raised.path, exact.path), 1e-12);
  // The model is not the second variation, but near.
  EXPECT_GT(raised.newton.contraction(), 1e-5);
  EXPECT_LT(raised.newton.contraction(), 0.1);
}

TEST(Raised, LeavesStiffForcesToTheSecondVariation) {
  const Problem problem = chain(4000, 1.2, 1e-3);
  Converged raised(problem, true), exact(problem, false);
  ASSERT_TRUE(raised.report.reached && exact.report.reached) << raised.report.failure << exact.report.failure;
  EXPECT_LT(distance(raised.path, exact.path), 1e-11);
}

TEST(Raised, FindsADuration) {
  Problem problem = chain(1, 1.2, 1);
  Converged fixed(problem, false);
  ASSERT_TRUE(fixed.report.reached) << fixed.report.failure;
  double energy = potential(1, fixed.path.node(0));
  for (double p : fixed.newton.action().start_gradient()) energy += p * p / 2;
  problem.duration = {.value = 1.25, .free = true, .energy = energy, .where = {}};
  Converged raised(make_problem(problem), true, &fixed.path);
  ASSERT_TRUE(raised.report.reached) << raised.report.failure;
  EXPECT_NEAR(raised.path.duration(), 1.2, 1e-11);
  EXPECT_LT(distance(raised.path, fixed.path), 1e-11);
}

TEST(Raised, SuitsConstantMassesOnly) {
  Levels levels;
  const auto suits = [&](std::shared_ptr<const Lagrangian> lagrangian) {
    levels.bind(std::move(lagrangian));
    return RaisedModel::suits(levels.at(high_degree));
  };
  EXPECT_TRUE(suits(systems::kepler()));
  EXPECT_TRUE(suits(springs(1)));
  EXPECT_FALSE(suits(systems::double_pendulum()));
}

}  // namespace
}  // namespace extremal::laws
