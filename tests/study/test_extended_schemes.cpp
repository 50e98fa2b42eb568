#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "scenes.hpp"

/// \file Schemes in problems with waypoints, nonlinear conditions, integrals and unknown constants.

using namespace extremal;
using namespace extremal::test;

namespace {

class ExtendedSchemes : public Scenes {};

constexpr double duration = 1.5;

/// A problem, and its x(t) and x'(t).
struct Known {
  std::string scene;
  std::function<std::array<double, 2>(double)> at;
};

std::string spring(const std::string& boundary) {
  return fmt::format(
      "[system]\ncoordinates = [\"x\"]\nparameters = {{ k = 1.0 }}\nlagrangian = \"x'^2/2 - k*x^2/2\"\n"
      "[boundary]\nduration = {}\n{}\n",
      duration, boundary);
}

Known waypoint() {
  return {spring("start = { x = 0 }\nend = { x = 1 }\n[[waypoints]]\nat = 0.7\nx = 0.5"),
          [](double t) -> std::array<double, 2> {
            if (t <= 0.7) return {0.5 * std::sin(t) / std::sin(0.7), 0.5 * std::cos(t) / std::sin(0.7)};
            const double back = duration - t, on = t - 0.7;
            return {(0.5 * std::sin(back) + std::sin(on)) / std::sin(0.8),
                    (std::cos(on) - 0.5 * std::cos(back)) / std::sin(0.8)};
          }};
}

Known nonlinear_end() {
  return {spring("conditions = [\"x(0) = 0\", \"x(T)^2 = 4\"]\n[guess]\nx = \"1.5*t/T\""),
          [](double t) -> std::array<double, 2> {
            return {2 * std::sin(t) / std::sin(duration), 2 * std::cos(t) / std::sin(duration)};
          }};
}

Known integral() {
  return {spring("start = { x = 0 }\nend = { x = 0 }\nintegrals = [\"x = 1\"]"),
          [](double t) -> std::array<double, 2> {
            const double half = duration / 2, force = 1 / (duration - 2 * std::tan(half));
            return {force * (1 - std::cos(t - half) / std::cos(half)),
                    force * std::sin(t - half) / std::cos(half)};
          }};
}

Known unknown() {
  return {spring("start = { x = 1 }\nunknowns = { k = 1.0 }\nwhere = [\"x(T) = 3\"]"),
          [](double t) -> std::array<double, 2> {
            const double omega = std::acos(1.0 / 3) / duration, back = omega * (duration - t);
            return {3 * std::cos(back), 3 * omega * std::sin(back)};
          }};
}

/// The largest errors of x and x', relative to their ranges.
std::array<double, 2> errors(const Known& known, const Trajectory& path) {
  std::array<double, 2> worst{}, least{1e300, 1e300}, most{-1e300, -1e300};
  for (int k = 0; k < path.elements(); ++k)
    for (const double tau : {0.0, 0.11, 0.37, 0.5, 0.82, 1.0}) {
      std::array<double, 1> x{}, v{};
      path.in_element(k, tau, x, v);
      // Velocities at a corner are those of the element.
      const double start = path.times[k], end = path.times[k + 1], inside = 1e-13;
      const auto exact = known.at(std::clamp(start + tau * (end - start), start + inside, end - inside));
      const std::array<double, 2> found{x[0], v[0]};
      for (int i = 0; i < 2; ++i) {
        worst[i] = std::max(worst[i], std::abs(found[i] - exact[i]));
        least[i] = std::min(least[i], exact[i]);
        most[i] = std::max(most[i], exact[i]);
      }
    }
  return {worst[0] / (most[0] - least[0]), worst[1] / (most[1] - least[1])};
}

}  // namespace

TEST_F(ExtendedSchemes, DenseOutputMeetsTheTolerance) {
  struct Case {
    const char* scheme;
    double tolerance;
  };
  for (const Known& known : {waypoint(), nonlinear_end(), integral(), unknown()})
    for (const auto& [scheme, tolerance] :
         {Case{"gauss(2)", 1e-9}, Case{"gauss(3)", 1e-9}, Case{"lobatto(4)", 1e-9}, Case{"midpoint", 1e-5},
          Case{"simpson", 1e-5}, Case{"trapezoid", 1e-4}, Case{"linear", 1e-5}, Case{"quadratic", 1e-9}}) {
      const Solution found = run(
          study(known.scene + fmt::format("[solve]\nscheme = \"{}\"\ntolerance = {}\n", scheme, tolerance)));
      ASSERT_TRUE(found.converged()) << scheme << '\n' << known.scene << found.message;
      const auto [q, v] = errors(known, found.trajectory);
      EXPECT_LE(q, tolerance) << scheme << '\n' << known.scene;
      EXPECT_LE(v, 10 * tolerance) << scheme << '\n' << known.scene;
    }
}

TEST_F(ExtendedSchemes, PinnedElementsKnowTheErrorsBetweenNodes) {
  // The estimate compares at the nodes of finer elements, the largest error may be between these.
  for (const Known& known : {waypoint(), nonlinear_end(), integral(), unknown()})
    for (const char* scheme :
         {"gauss(2)", "gauss(3)", "lobatto(4)", "midpoint", "trapezoid", "linear", "quadratic"}) {
      const Solution found =
          run(study(known.scene + fmt::format("[solve]\nscheme = \"{}\"\nelements = 32\n", scheme)));
      ASSERT_TRUE(found.converged()) << scheme << '\n' << known.scene << found.message;
      std::array<double, 2> range{1e300, -1e300};
      for (const double x : found.trajectory.nodes) range = {std::min(range[0], x), std::max(range[1], x)};
      EXPECT_LE(errors(known, found.trajectory)[0] * (range[1] - range[0]), 1.2 * found.error_estimate)
          << scheme << '\n'
          << known.scene;
    }
}

TEST_F(ExtendedSchemes, ExactQuadratureHasItsOrder) {
  // L and the integral are not polynomials: no number of points integrates them exactly.
  struct Case {
    const char* scheme;
    double order;
  };
  const std::string given =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 + cos(x)\"\n"
      "[boundary]\nstart = { x = 0.2 }\nend = { x = 0.9 }\nduration = 2\nintegrals = [\"exp(x) = 5\"]\n"
      "[guess]\nx = \"0.2 + 0.35*t + sin(pi*t/2)/2\"\n";
  const Solution exact = run(study(given));
  ASSERT_TRUE(exact.converged()) << exact.message;
  for (const auto& [scheme, order] : {Case{"linear", 2}, Case{"quadratic", 4}}) {
    std::array<double, 2> differences{};
    for (const int half : {0, 1}) {
      const Solution found =
          run(study(given + fmt::format("[solve]\nscheme = \"{}\"\nelements = {}\n", scheme, 8 << half)));
      ASSERT_TRUE(found.converged()) << scheme << ": " << found.message;
      for (int k = 1; k < found.trajectory.elements(); ++k) {
        std::array<double, 1> x{}, v{}, y{};
        found.trajectory.in_element(k, 0, x, v);
        exact.trajectory.at(found.trajectory.times[k], y, v);
        differences[half] = std::max(differences[half], std::abs(x[0] - y[0]));
      }
    }
    EXPECT_NEAR(std::log2(differences[0] / differences[1]), order, 0.15) << scheme;
  }
}

TEST_F(ExtendedSchemes, WhatIsSpentIsTold) {
  Study none = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { k = 1.0 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - k*((x^2 + 1.3*y^2)/2 + 0.1*x^2*y)\"\n"
      "[boundary]\nstart = { x = 0.2, y = 0.1 }\nend = { x = 1.0 }\nduration = 1.5\n"
      "unknowns = { k = 1.0 }\nwhere = [\"y(T) = -0.3\"]\n");
  none.options.max_iterations = 40;
  const Solution found = run(none);
  EXPECT_EQ(found.status, Status::iteration_limit) << found.message;
  EXPECT_NE(found.message.find("40 steps of Newton's method are spent"), std::string::npos) << found.message;
}
