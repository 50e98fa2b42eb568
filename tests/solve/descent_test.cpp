#include "solve/search/descent.hpp"

#include <numbers>

#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/laws.hpp"

/// \file Minimisation in windows: downhill where the action is convex, to a saddle where it is not.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// The guess of a problem on `elements` equal elements of degree 4.
struct Begun {
  Begun(const Problem& problem, int elements) {
    w.levels.bind(problem.lagrangian);
    tables = &w.levels.at(4);
    w.iteration.reset(problem, *tables, elements);
    path.reset(*tables, uniform_mesh(elements), problem.duration.value);
    start_path(problem, starting_ends(problem), *tables, path);
  }
  Path path;
  Workspace w;
  const ElementTables* tables = nullptr;
};

/// V'' <= 0, e^q over a range of e^±60.
Problem convex(double size) {
  return guessed(
      fixed_ends(trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + exp(q[0]) + exp(-q[0]); }), {1},
                 {-1}, 2),
      [=](double tau) { return Values{1 - 2 * tau + size * std::sin(3 * pi * tau)}; });
}

TEST(Descent, ActionFallsAtEveryStep) {
  const Problem problem = convex(60);
  Begun begun(problem, 16);
  std::vector<double> actions;
  Descent descent(begun.path, begun.w, [&] {
    actions.push_back(begun.w.iteration.action().action());
    return true;
  });
  ASSERT_TRUE(descent.run(*begun.tables, 1e-3));
  ASSERT_GT(actions.size(), 20u);
  for (std::size_t k = 1; k + 1 < actions.size(); ++k) EXPECT_LT(actions[k], actions[k - 1]) << k;
  const Solution solution = solve(convex(0), within(1e-10));
  EXPECT_NEAR(actions.back(), solution.action, 1e-3 * solution.action);
}

/// The whole is a saddle: ω0 T = 20 is more than six half swings.
TEST(Descent, ArrivesAtASaddle) {
  const Problem problem = guessed(fixed_ends(systems::oscillator(1), {0.5}, {0.3}, 20),
                                  [](double tau) { return Values{0.5 - tau}; });
  Begun begun(problem, 40);
  Descent descent(begun.path, begun.w, [] { return true; });
  ASSERT_TRUE(descent.run(*begun.tables, 1e-3));
  const double slope = (0.3 - 0.5 * std::cos(20.0)) / std::sin(20.0);
  for (int k = 0; k <= 40; ++k) {
    const double t = 0.5 * k;
    EXPECT_NEAR(begun.path.node(k)[0], 0.5 * std::cos(t) + slope * std::sin(t), 1e-4);
  }
}

/// Half a swing in one element: no window is short enough.
TEST(Descent, NeedsElementsWithinAWindow) {
  const Problem problem = fixed_ends(systems::oscillator(1), {0.5}, {0.3}, 20);
  Begun begun(problem, 4);
  Descent descent(begun.path, begun.w, [] { return true; });
  EXPECT_FALSE(descent.run(*begun.tables, 1e-3));
}

TEST(Descent, StopsWhenToldTo) {
  const Problem problem = convex(60);
  Begun begun(problem, 16);
  int left = 5;
  Descent descent(begun.path, begun.w, [&] { return --left > 0; });
  EXPECT_FALSE(descent.run(*begun.tables, 1e-3));
  EXPECT_EQ(left, 0);
}

}  // namespace
}  // namespace extremal::laws
