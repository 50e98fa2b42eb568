#include <numbers>

#include "solve/laws.hpp"

/// \file Closed paths of a scheme on equal steps: of all phases of an orbit a few are extremals.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// ∂S_h/∂q_k of closed paths for L = |q'|²/2 + 0.6 (x y' − y x') − V, V = (x⁴ + y⁴)/4 + xy: of `midpoint`
/// with the force at the middle of elements, of `trapezoid` with that at nodes.
double residual(const Trajectory& path, bool midpoint) {
  const int count = path.elements();
  const auto at_node = [&](int k) { return node(path, (k + count) % count); };
  const auto force = [](const Values& q) {
    return Values{-q[0] * q[0] * q[0] - q[1], -q[1] * q[1] * q[1] - q[0]};
  };
  const double h = path.duration() / count;
  double most = 0;
  for (int k = 0; k < count; ++k) {
    const Values before = at_node(k - 1), here = at_node(k), after = at_node(k + 1);
    const auto mean = [&](const Values& q) { return Values{(q[0] + here[0]) / 2, (q[1] + here[1]) / 2}; };
    const Values a = force(midpoint ? mean(before) : here), b = force(midpoint ? mean(after) : here);
    const Values across{after[0] - before[0], after[1] - before[1]};
    const Values turned{0.6 * across[1], -0.6 * across[0]};  // of 0.6 (x_k y_{k+1} − y_k x_{k+1})
    for (const int i : {0, 1})
      most = std::max(most,
                      std::abs((2 * here[i] - before[i] - after[i]) / h + turned[i] + h * (a[i] + b[i]) / 2));
  }
  return most;
}

/// The force along the shift is 1e-9 to 1e-5 of the momentum: Newton's method alone ends at it.
TEST(Phases, AllEquationsHoldToRoundoff) {
  const auto lagrangian = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 0.6 * (q[0] * v[1] - q[1] * v[0]) -
           (q[0] * q[0] * q[0] * q[0] + q[1] * q[1] * q[1] * q[1]) / 4 - q[0] * q[1];
  });
  const Problem problem = guessed(periodic(lagrangian, 5), [](double tau) {
    return Values{std::cos(2 * pi * tau), -0.8 * std::sin(2 * pi * tau)};
  });
  for (const char* name : {"midpoint", "trapezoid"})
    for (const int elements : {12, 16, 20, 24, 28, 32}) {
      const Solution s = solve(problem, pinned(scheme(name), elements));
      EXPECT_LT(residual(s.trajectory, std::string(name) == "midpoint"), 1e-13) << name << elements;
      EXPECT_GT(s.trajectory.nodes[0] * s.trajectory.nodes[0], 0.01);
    }
}

/// An orbit that returns on its way is an extremal where a turning point is a node or the middle of an
/// element: there are no others. From each phase the next of these is reached.
TEST(Phases, TurningPointsAreNodesOrMiddles) {
  const auto quartic =
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 - q[0] * q[0] * q[0] * q[0] / 4; });
  const int elements = 16;
  for (const double phase : {0.1, 0.2, 0.3, 0.4}) {
    const Problem problem = guessed(periodic(quartic, 4), [&](double tau) {
      return Values{1.8 * std::cos(2 * pi * (tau - phase / elements))};
    });
    const Solution s = solve(problem, pinned(scheme("midpoint"), elements));
    const auto x = [&](int k) { return node(s.trajectory, (k + elements) % elements)[0]; };
    const double beside_node = std::abs(x(1) - x(-1)), beside_middle = std::abs(x(1) - x(0));
    EXPECT_LT(phase < 0.25 ? beside_node : beside_middle, 1e-6) << phase;
    EXPECT_GT(phase < 0.25 ? beside_middle : beside_node, 0.01) << phase;
  }
}

}  // namespace
}  // namespace extremal::laws
