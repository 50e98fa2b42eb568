#include "solve/laws.hpp"
#include "system/formula.hpp"

/// \file Formulas and C++ functors are two doors to one room; and the same problem has the same solution
/// whoever solved what before.

namespace extremal::laws {
namespace {

struct Pair {
  std::shared_ptr<const Lagrangian> functor;
  SystemText text;
  Values start, end;
  double duration;
};

std::vector<Pair> pairs() {
  return {
      {trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); }),
       {.coordinates = {"q"}, .lagrangian = "q'^2/2 + cos(q)"},
       {0},
       {1.5},
       2},
      {trace(2, [](auto q, auto v,
                   auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]); }),
       {.coordinates = {"x", "y"}, .lagrangian = "(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)"},
       {1, 0},
       {-0.6, 0.9},
       2.5},
      {trace(2,
             [](auto q, auto v, auto) {
               return v[0] * v[0] + v[1] * v[1] / 2 + v[0] * v[1] * cos(q[0] - q[1]) + 2 * 9.81 * cos(q[0]) +
                      9.81 * cos(q[1]);
             }),
       {.coordinates = {"q[2]"},
        .parameters = {{"g", {{9.81}}}},
        .lagrangian = "q[1]'^2 + q[2]'^2/2 + q[1]'*q[2]'*cos(q[1] - q[2]) + 2*g*cos(q[1]) + g*cos(q[2])"},
       {0, 0},
       {1, 2},
       1},
      {trace(1, [](auto q, auto v,
                   auto t) { return v[0] * v[0] / 2 + cos(q[0]) + q[0] * sin(2 * t) + t * v[0] * q[0]; }),
       {.coordinates = {"q"}, .lagrangian = "q'^2/2 + cos(q) + q*sin(2*t) + t*q'*q"},
       {0},
       {1},
       2},
  };
}

/// The same but for the order in which sums are added up.
void expect_near(const Solution& a, const Solution& b, const std::string& what) {
  const double bound = 1e-14;
  ASSERT_EQ(a.trajectory.nodes.size(), b.trajectory.nodes.size()) << what;
  EXPECT_LT(largest_difference(a.trajectory.nodes, b.trajectory.nodes), bound * largest(a.trajectory.nodes))
      << what;
  EXPECT_NEAR(a.action, b.action, bound * std::abs(a.action)) << what;
  EXPECT_LT(largest_difference(a.momentum_start, b.momentum_start), bound * largest(a.momentum_start))
      << what;
  EXPECT_LT(largest_difference(a.momentum_end, b.momentum_end), bound * largest(a.momentum_end)) << what;
  EXPECT_EQ(a.trajectory.degree, b.trajectory.degree) << what;
  EXPECT_EQ(a.iterations, b.iterations) << what;
  EXPECT_EQ(a.morse_index, b.morse_index) << what;
}

void expect_same(const Solution& a, const Solution& b, const std::string& what) {
  EXPECT_EQ(a.trajectory.times, b.trajectory.times) << what;
  EXPECT_EQ(a.trajectory.nodes, b.trajectory.nodes) << what;
  EXPECT_EQ(a.action, b.action) << what;
  EXPECT_EQ(a.momentum_start, b.momentum_start) << what;
  EXPECT_EQ(a.momentum_end, b.momentum_end) << what;
  EXPECT_EQ(a.energy, b.energy) << what;
  EXPECT_EQ(a.error_estimate, b.error_estimate) << what;
  EXPECT_EQ(a.iterations, b.iterations) << what;
  EXPECT_EQ(a.morse_index, b.morse_index) << what;
}

TEST(Routes, FormulaAndFunctorGiveTheSameSolution) {
  for (const Pair& pair : pairs()) {
    const Problem by_functor = fixed_ends(pair.functor, pair.start, pair.end, pair.duration);
    const Problem by_formula = fixed_ends(compile(pair.text).lagrangian, pair.start, pair.end, pair.duration);
    for (const SolveOptions& options :
         {within(1e-6), within(1e-12), pinned(gauss(3), 6), pinned(lobatto(1), 20)})
      expect_near(solve(by_functor, options), solve(by_formula, options), pair.text.lagrangian);
  }
}

TEST(Routes, ASolverRemembersNothing) {
  Solver solver;
  for (int round = 0; round < 2; ++round)
    for (const Pair& pair : pairs()) {
      const Problem problem = fixed_ends(pair.functor, pair.start, pair.end, pair.duration);
      for (const SolveOptions& options : {within(1e-4), within(1e-12), pinned(gauss(2), 9)})
        expect_same(solve(solver, problem, options), solve(problem, options), pair.text.lagrangian);
    }
}

}  // namespace
}  // namespace extremal::laws
