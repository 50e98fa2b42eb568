#include "analysis/bounds.hpp"

#include <numbers>

#include "solve/laws.hpp"

/// \file Sharp bounds of windows: closed forms, and the sign of the discrete second variation beside them.

namespace extremal::laws {
namespace {

using std::numbers::pi;

TEST(WindowBound, ClosedForms) {
  for (int n : {2, 3, 7, 40}) {
    EXPECT_NEAR(window_bound(scheme("midpoint"), n), 2 * n * std::tan(pi / (2 * n)), 1e-13);
    EXPECT_NEAR(window_bound(scheme("trapezoid"), n), 2 * n * std::sin(pi / (2 * n)), 1e-13);
    EXPECT_NEAR(window_bound(scheme("rectangle"), n), 2 * n * std::sin(pi / (2 * n)), 1e-13);
    // cos θ = (1 − z²/3)/(1 + z²/6) with θ = π/n.
    const double c = std::cos(pi / n);
    EXPECT_NEAR(window_bound(scheme("linear"), n), n * std::sqrt((1 - c) / (1.0 / 3 + c / 6)), 1e-13);
  }
  EXPECT_NEAR(window_bound(lobatto(2), 1), std::sqrt(8.0), 1e-14);
  EXPECT_NEAR(window_bound(scheme("quadratic"), 1), std::sqrt(10.0), 1e-14);
  EXPECT_TRUE(std::isinf(window_bound(scheme("trapezoid"), 1)));
}

/// Müller and Ortiz 4.2: paths of an element are paths, so with exact quadrature they cannot do better.
TEST(WindowBound, OfExactQuadratureIsAtLeastPi) {
  for (const Scheme& s : {scheme("linear"), scheme("quadratic"), gauss(2), gauss(3), gauss(4)})
    for (int n : {1, 2, 5}) EXPECT_GE(window_bound(s, n), pi) << s.name;
}

TEST(WindowBound, ConvergesWithItsOrder) {
  for (const Scheme& s : schemes_and_families()) {
    if (one_sided(s)) continue;
    const double coarse = std::abs(window_bound(s, 4) - pi), fine = std::abs(window_bound(s, 8) - pi);
    if (fine <= 1e-11) continue;
    EXPECT_NEAR(std::log2(coarse / fine), s.order, 0.2) << s.name;
  }
}

TEST(WindowBound, RefusesNoElements) {
  EXPECT_THROW(window_bound(scheme("midpoint"), 0), std::invalid_argument);
}

/// On either side of the bound the discrete second variation has index 0 and 1.
TEST(WindowBound, IsWhereTheDiscreteSecondVariationChangesItsSign) {
  for (const Scheme& s : schemes_and_families())
    for (int n : {1, 2, 3, 8})
      for (double omega : {1.0, 2.5}) {
        const double bound = window_bound(s, n) / omega;
        if (!std::isfinite(bound)) continue;
        const auto index = [&](double T) {
          return solve(fixed_ends(systems::oscillator(omega), {0}, {1}, T), pinned(s, n)).morse_index;
        };
        EXPECT_EQ(index(bound * (1 - 1e-4)), 0) << s.name << ' ' << n;
        EXPECT_EQ(index(bound * (1 + 1e-4)), 1) << s.name << ' ' << n;
      }
}

}  // namespace
}  // namespace extremal::laws
