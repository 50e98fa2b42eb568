#include <random>

#include "solve/external/displacement.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/scenes.hpp"

/// \file Solvers of other libraries lead to the extremals that Newton's method finds.

namespace extremal::laws {
namespace {

struct EndsCase {
  std::string name, text;
  friend void PrintTo(const EndsCase& test, std::ostream* to) { *to << test.name; }
};

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int k = 0; k < times; ++k) result += text;
  return result;
}

std::vector<EndsCase> ends_cases() {
  const std::string kepler = "[system]\nuse = \"kepler\"\n[boundary]\n";
  const std::string pendulum = "[system]\nuse = \"pendulum\"\nparameters = { g = 1.0 }\n[boundary]\n";
  return {
      {"FixedEnds", kepler + "start = { x = 1, y = 0 }\nend = { x = -0.6, y = 0.9 }\nduration = 2.5\n"},
      {"NaturalEnd", pendulum + "start = { theta = 1 }\nduration = 4\n"},
      {"CoupledEnds", pendulum + "conditions = [\"theta(0) + theta(T) = 1\"]\nduration = 2\n"},
      {"FreeDuration", kepler + "start = { x = 1, y = 0 }\nend = { x = -0.6, y = 0.9 }\nduration = \"free\"\n"
                                "energy = -0.4\n[guess]\nduration = 2.4\n"},
      {"Periodic", pendulum + "periodic = true\nduration = \"free\"\nwhere = \"theta(0) = 1\"\n"
                              "[guess]\ntheta = \"cos(2*pi*t/T)\"\nduration = 6.5\n"},
      {"Pinned", pendulum + "start = { theta = 0 }\nend = { theta = 1.5 }\nduration = 2\n"
                            "[solve]\nscheme = \"midpoint\"\nelements = 40\n"},
      {"SparseChain", "[system]\nuse = \"fpu-chain\"\nparameters = { n = 40 }\n[boundary]\nstart = { q = [0" +
                          repeated(", 0", 39) + "] }\nend = { q = [0.1" + repeated(", 0.1", 39) +
                          "] }\nduration = 1\n"},
  };
}

class Methods : public ::testing::TestWithParam<EndsCase> {};

TEST_P(Methods, FindTheSameExtremal) {
  Study study = study_of(GetParam().text);
  const Solution newton = run(study, 1);
  ASSERT_TRUE(newton.converged()) << newton.message;
  EXPECT_EQ(newton.strategy, "newton from the guess");
  for (const Method method : {Method::ceres, Method::ipopt}) {
    if (!available(method)) continue;
    study.options.method = method;
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    const Solution other = run(study, 1);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << name(method);
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "") << name(method);
    ASSERT_TRUE(other.converged()) << name(method) << ": " << other.message;
    EXPECT_NE(other.strategy.find(", led by "), std::string::npos);
    const double duration = newton.trajectory.duration(), allowed = 2e-9 * largest(newton.trajectory.nodes);
    EXPECT_NEAR(other.trajectory.duration(), duration, 2e-9 * duration) << name(method);
    EXPECT_EQ(other.morse_index, newton.morse_index) << name(method);
    Values a(study.problem.coordinates()), b(a), v(a);
    for (const double t : {0.0, 0.3, 0.5, 0.8, 1.0}) {
      newton.trajectory.at(t * duration, a, v);
      other.trajectory.at(t * other.trajectory.duration(), b, v);
      EXPECT_LT(largest_difference(a, b), allowed) << name(method) << " at " << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Methods, ::testing::ValuesIn(ends_cases()),
                         [](const auto& info) { return info.param.name; });

TEST(MethodEffort, IsBounded) {
  Study study = study_of(
      "[system]\nuse = \"pendulum\"\n[boundary]\nstart = { theta = 0 }\nend = { theta = 1 }\n"
      "duration = 40\n");
  study.options.max_iterations = 3;
  for (const Method method : {Method::ceres, Method::ipopt}) {
    if (!available(method)) continue;
    study.options.method = method;
    const Solution solution = run(study, 1);
    EXPECT_FALSE(solution.converged()) << name(method);
    EXPECT_LE(solution.iterations, 5) << name(method);
  }
}

/// F' beside differences of F.
TEST(Displacement, DerivativesAreThoseOfTheEquations) {
  for (const EndsCase& test : ends_cases()) {
    const Study study = study_of(test.text);
    const Problem& problem = study.problem;
    Levels levels;
    levels.bind(problem.lagrangian);
    const ElementTables& tables = levels.at(4);
    Path path;
    path.reset(tables, Values{0, 0.2, 0.45, 0.7, 1}, problem.duration.value);
    start_path(problem, starting_ends(problem), tables, path);
    Displacement equations(problem, tables, path);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int size = equations.size();
    Values z(size), direction(size);
    for (int u = 0; u < size; ++u) {
      z[u] = 0.05 * uniform(random);
      direction[u] = uniform(random);
    }
    ASSERT_TRUE(equations.evaluate(z, true)) << test.name;
    const Eigen::Map<const Eigen::VectorXd> along(direction.data(), size);
    const Eigen::VectorXd expected = equations.derivatives() * along;
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(size);
    constexpr double step = 1e-5;
    for (const double sign : {1.0, -1.0}) {
      Values moved = z;
      for (int u = 0; u < size; ++u) moved[u] += sign * step * direction[u];
      ASSERT_TRUE(equations.evaluate(moved, false)) << test.name;
      difference += sign / (2 * step) * equations.values();
    }
    EXPECT_LT((difference - expected).norm(), 1e-7 * expected.norm()) << test.name;
  }
}

}  // namespace
}  // namespace extremal::laws
