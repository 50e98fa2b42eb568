#include <complex>
#include <numbers>

#include "analysis/independent.hpp"
#include "analysis/multipliers.hpp"
#include "solve/published.hpp"

/// \file Multipliers of orbits that are solved for, against published values and the linearised flow.

namespace extremal::laws {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double tolerance = 1e-12;

/// λ² − μλ + 1 = 0 with the trace μ, driven through resonance: x'' + sin x = 0.8 cos 1.3 t.
TEST(MultipliersOfOrbits, DrivenPendulum) {
  const auto lagrangian = trace(
      1, [](auto q, auto v, auto t) { return v[0] * v[0] / 2 + cos(q[0]) + 0.8 * cos(1.3 * t) * q[0]; });
  const double T = 2 * pi / 1.3;
  const Solution s = solve(
      guessed(periodic(lagrangian, T), [](double tau) { return Values{-1.1 * std::cos(2 * pi * tau)}; }),
      within(tolerance));
  ASSERT_TRUE(s.floquet);
  const Complex sum = s.floquet->multipliers[0] + s.floquet->multipliers[1];
  EXPECT_NEAR(sum.real(), linearised_flow(*lagrangian, s).trace(), 1e-10);
  EXPECT_LT(std::abs(sum.imag()), 1e-15);
}

/// Every multiplier is 1: three equal frequencies in space, two in the plane.
TEST(MultipliersOfOrbits, KeplerEllipse) {
  for (int n : {2, 3}) {
    const auto lagrangian = trace(n, [=](auto q, auto v, auto) {
      auto r2 = q[0] * q[0], v2 = v[0] * v[0];
      for (int a = 1; a < n; ++a) r2 = r2 + q[a] * q[a], v2 = v2 + v[a] * v[a];
      return v2 / 2 + 1 / sqrt(r2);
    });
    const auto ellipse = [=](double tau) {
      const double e = 0.3, l = 2 * pi * tau;
      double anomaly = l;
      for (int i = 0; i < 50; ++i) anomaly = l + e * std::sin(anomaly);
      Values q{std::cos(anomaly) - e, std::sqrt(1 - e * e) * std::sin(anomaly)};
      if (n == 3) q.push_back(0.2 * q[1]), q[1] *= std::sqrt(0.96);
      return q;
    };
    const Solution s = solve(guessed(periodic(lagrangian, 2 * pi), ellipse), within(tolerance));
    ASSERT_TRUE(s.floquet);
    EXPECT_EQ(s.floquet->multipliers, std::vector<Complex>(2 * n, 1.0));
    EXPECT_EQ(s.floquet->krein, std::vector<int>(2 * n, 0));
    EXPECT_EQ(s.floquet->trivial_pairs, n);
  }
}

/// On a circle the rotation is the shift in time, and what is left of the others is 1 as well.
TEST(MultipliersOfOrbits, KeplerCircle) {
  const auto lagrangian = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
  const auto circle = [](double tau) { return Values{std::cos(2 * pi * tau), std::sin(2 * pi * tau)}; };
  for (double accuracy : {1e-6, 1e-9, 1e-12}) {
    const Solution s = solve(guessed(periodic(lagrangian, 2 * pi), circle), within(accuracy));
    ASSERT_TRUE(s.floquet);
    EXPECT_EQ(s.floquet->multipliers, std::vector<Complex>(4, 1.0)) << accuracy;
    EXPECT_EQ(s.floquet->trivial_pairs, 2) << accuracy;
  }
}

/// C. Simó, Dynamical properties of the figure eight solution (2002): exp(±2πi ν), ν = 0.00842272 and
/// 0.29809253; the others are 1 by two translations, the rotation and the shift in time.
TEST(MultipliersOfOrbits, FigureEight) {
  Study study = load(bench_data("figure-eight.toml"));
  study.options.tolerance = tolerance;
  const Solution s = run(study);
  ASSERT_TRUE(s.converged() && s.floquet) << s.message;
  EXPECT_TRUE(s.floquet->stable());
  EXPECT_EQ(s.floquet->trivial_pairs, 4);
  EXPECT_EQ(s.floquet->circle_pairs, 2);
  const auto& found = s.floquet->multipliers;
  const std::size_t first = 8;  // after those at argument 0
  EXPECT_NEAR(std::arg(found[first]) / (2 * pi), 0.00842272, 6e-9);
  EXPECT_NEAR(std::arg(found[first + 2]) / (2 * pi), 0.29809253, 6e-9);
}

/// Stability index (|λ| + 1/|λ|)/2 of the catalogue, and every multiplier that is not trivial.
TEST(MultipliersOfOrbits, OfTheRestrictedProblem) {
  for (const char* id :
       {"cr3bp-earth-moon-L1haloN-f1", "cr3bp-earth-moon-L1lyap-416", "cr3bp-earth-moon-L1halo-231",
        "cr3bp-sun-earth-halo-1197", "cr3bp-earth-moon-dro-s2", "cr3bp-saturn-enceladus-L1halo-66",
        "cr3bp-earth-moon-vertical-1002"}) {
    const nlohmann::json c = published("cr3bp_periodic_orbits.json", id);
    const Solution s = solved(c, tolerance);
    ASSERT_TRUE(s.converged() && s.floquet) << s.message;
    const double largest = std::abs(s.floquet->multipliers[0]);
    EXPECT_NEAR((largest + 1 / largest) / 2 / c["stability_index_computed"].get<double>(), 1, 1e-9) << id;
    EXPECT_EQ(s.floquet->trivial_pairs, 1) << id;
    EXPECT_LT(s.floquet->symplectic_defect, 1e-14);
    for (const auto& pair : c["floquet_multipliers"]) {
      const Complex truth(pair[0], pair[1]);
      if (std::abs(truth - 1.0) < 1e-4) continue;
      double nearest = INFINITY;
      for (const Complex& value : s.floquet->multipliers)
        nearest = std::min(nearest, std::abs(value / truth - 1.0));
      EXPECT_LT(nearest, 1e-9) << id << " " << truth;
    }
  }
}

/// Choreographies of three bodies of mass 1/3 with multipliers above a million: two translations, the
/// rotation and the shift in time leave four pairs at 1.
TEST(MultipliersOfOrbits, OfUnstableChoreographies) {
  for (const char* id : {"3b-simo-004", "3b-simo-003"}) {
    const nlohmann::json c = published("nbody_periodic_orbits.json", id);
    const Solution s = solved(c, tolerance);
    ASSERT_TRUE(s.converged() && s.floquet) << s.message;
    EXPECT_NEAR(std::abs(s.floquet->multipliers[0]) / c["max_abs_multiplier"].get<double>(), 1, 1e-8) << id;
    EXPECT_EQ(s.floquet->trivial_pairs, 4) << id;
    EXPECT_LT(s.floquet->symplectic_defect, 1e-14);
    EXPECT_FALSE(s.floquet->stable());
  }
}

/// Two more pairs than those that are trivial, after an encounter at 3e-4; a rotation of the centre of mass
/// alone leaves all equations as they are, but moves nothing. By integration of the linearised flow to 1e-13,
/// which the encounter amplifies a million times, one is exp(±i arccos 0.62188).
TEST(MultipliersOfOrbits, OfFreeFall) {
  const Solution s = solved(published("nbody_periodic_orbits.json", "3b-ff-F1_1_1_1_"), 1e-8);
  ASSERT_TRUE(s.converged() && s.floquet) << s.message;
  EXPECT_EQ(s.floquet->trivial_pairs, 4);
  EXPECT_EQ(s.floquet->real_pairs, 1);
  ASSERT_EQ(s.floquet->circle_pairs, 1);
  EXPECT_NEAR(s.floquet->multipliers[0].real(), 5533, 1);
  double nearest = INFINITY;
  for (const Complex& value : s.floquet->multipliers)
    nearest = std::min(nearest, std::abs(value.real() - 0.62188));
  EXPECT_LT(nearest, 1e-5);
}

/// A rotating pendulum closes up to 2π; its only multipliers are those of the shift in time. From one lowest
/// point to the next it is the extremal between these ends.
TEST(MultipliersOfOrbits, RotatingPendulum) {
  for (double T : {1.0, 5.0, 10.0, 15.0, 20.0}) {
    const Solution s = solve(fixed_ends(systems::pendulum(), {0}, {2 * pi}, T), within(tolerance));
    ASSERT_NEAR(s.momentum_start[0], s.momentum_end[0], 1e-11);
    SecondVariation variation;
    ASSERT_TRUE(variation.assemble(systems::pendulum(), s.trajectory));
    const ClosedOrbit orbit{.map = {}, .relative_error = 1e-12, .autonomous = true};
    EXPECT_EQ(floquet(variation, orbit).value().multipliers, std::vector<Complex>(2, 1.0)) << T;
  }
}

TEST(MultipliersOfOrbits, OfPeriodicOnesAlone) {
  const Solution s = solve(fixed_ends(systems::oscillator(1), {0}, {1}, 1), within(1e-9));
  EXPECT_FALSE(s.floquet);
}

/// With so many coordinates they are left out, and the message says so.
TEST(MultipliersOfOrbits, AreLimitedInCoordinates) {
  for (int n : {128, 129}) {
    const auto lagrangian = trace(n, [=](auto q, auto v, auto) {
      auto l = 0 * v[0];
      for (int a = 0; a < n; ++a) l = l + (v[a] * v[a] - q[a] * q[a]) / 2;
      return l;
    });
    const Solution s = solve(guessed(periodic(lagrangian, 1), [=](double) { return Values(n, 0.0); }),
                             pinned(lobatto(4), 2));
    EXPECT_EQ(s.floquet.has_value(), n == 128);
    EXPECT_EQ(s.message.find("multipliers are only found for up to 128 coordinates") != std::string::npos,
              n == 129);
  }
}

}  // namespace
}  // namespace extremal::laws
