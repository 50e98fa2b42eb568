#include <cmath>
#include <numbers>

#include "machine/long_test.hpp"
#include "rivals/verify.hpp"
#include "solve/branch/diagram.hpp"
#include "solve/scenes.hpp"

/// \file Periodic motions of chains: normal modes that grow, and one that stays where it is.

namespace extremal::laws {
namespace {

using std::numbers::pi;

Study scene(const std::string& name, const std::vector<std::string>& sets = {}) {
  return load(std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/" + name + ".toml", sets);
}

std::vector<BranchPoint> follow(const Study& study, double tolerance) {
  Continuation branch(study.continuation->family,
                      {.solve = within(tolerance), .points = study.continuation->points});
  std::vector<BranchPoint> points;
  while (branch.advance()) points.push_back(branch.point());
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
  return points;
}

/// q = (1, 0, −1, 0, …) a cn(ωt | k²) with ω² = 2 + 2a² and k² = a²/ω²: 16 masses of energy a² + a⁴/2 (Poggi
/// and Ruffo, Physica D 103 (1997) 251).
TEST(Lattices, ModeOfFourLatticeConstants) {
  LONG_TEST();
  const Study study =
      scene("fpu-mode-family", {"guess.q=\"0.02*sin(pi*i/2)*cos(2*pi*t/T)\"", "guess.duration=4.4428",
                                "boundary.energy=0.0064", "continuation.to=100", "system.parameters.n=31"});
  for (const BranchPoint& point : follow(study, 1e-10)) {
    const double square = std::sqrt(1 + *point.solution.energy / 8) - 1, rate = std::sqrt(2 + 2 * square);
    EXPECT_NEAR(point.solution.duration(), 4 * std::comp_ellint_1(std::sqrt(square) / rate) / rate, 1e-8)
        << point.parameter;
  }
}

/// The slowest mode: ω = ω₁ (1 + 9 E/(8 (n + 1)) + O(E²)) (S. Flach, M. V. Ivanchenko and O. I. Kanakov,
/// Phys. Rev. Lett. 95 (2005) 064102, β = 1).
TEST(Lattices, SlowestMode) {
  const std::vector<BranchPoint> points = follow(scene("fpu-mode-family"), 1e-10);
  const int n = 7;
  const double slowest = 2 * std::sin(pi / (2 * (n + 1)));
  const auto rate = [&](const BranchPoint& p) {
    return (2 * pi / p.solution.duration() / slowest - 1) / *p.solution.energy;
  };
  const double expected = 9.0 / (8 * (n + 1));
  EXPECT_NEAR(rate(points.front()), expected, 1e-3 * expected);
  EXPECT_NEAR(points.back().parameter, 1, 1e-12);
}

/// Harmonic k of site i, cosine and sine.
double harmonic(const Solution& s, int i, int k) {
  const double T = s.duration();
  const int samples = 64;
  double cosine = 0, sine = 0;
  for (int j = 0; j < samples; ++j) {
    const double u = at(s.trajectory, T * j / samples).q[i];
    cosine += u * std::cos(2 * pi * k * j / samples) * 2 / samples;
    sine += u * std::sin(2 * pi * k * j / samples) * 2 / samples;
  }
  return std::hypot(cosine, sine);
}

/// Far from the site that swings the lattice is linear: h² (ω² − 2λ) = 2 − 2 cosh κ for what falls like e^−κ
/// from site to site.
TEST(Lattices, BreatherIsLocal) {
  const Study study = scene("phi4-breather", {"solve.tolerance=1e-10"});
  const Solution s = run(study);
  ASSERT_TRUE(s.converged()) << s.message;
  ASSERT_EQ(s.trajectory.coordinates, 64);
  EXPECT_GT(harmonic(s, 31, 1), 0.3);
  const double rate = 2 * pi / s.duration(), h = 2;
  const double kappa = std::acosh(1 + h * h * (2 - rate * rate) / 2);
  for (const int side : {-1, 1}) {
    const double nearer = harmonic(s, 31 + 5 * side, 1), farther = harmonic(s, 31 + 8 * side, 1);
    EXPECT_NEAR(std::log(nearer / farther), 3 * kappa, 1e-3 * kappa);
  }
  for (const int end : {0, 63}) EXPECT_NEAR(at(s.trajectory, 0.3).q[end], 1, 1e-9);
  const Verification check = verify(study.problem, s.trajectory, {.tolerance = 1e-10});
  EXPECT_TRUE(check.verified) << check.message;
  ASSERT_TRUE(s.floquet);
  EXPECT_EQ(s.floquet->trivial_pairs, 1);
}

/// With h the coupling to the neighbours goes like 1/h²: alone a site swings as u = a dn(ωt | k²), ω² = a²/2
/// and k² = 2 − 1/ω², of period 2 K/ω and energy h (a² − 1)²/4.
TEST(Lattices, BreatherOfOneSite) {
  LONG_TEST();
  Study study =
      scene("phi4-breather", {"continuation.parameter=h", "continuation.to=20.0", "continuation.points=40"});
  const std::vector<BranchPoint> points = follow(study, 1e-9);
  const double T = study.problem.duration.value;
  double low = std::sqrt(0.5001), high = 0.99;  // ω of a swing with the period T
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (2 * std::comp_ellint_1(std::sqrt(2 - 1 / (middle * middle))) / middle < T ? low : high) = middle;
  }
  const double alone = std::pow(2 * low * low - 1, 2) / 4;
  const auto off = [&](const BranchPoint& p) {
    return (*p.solution.energy / p.parameter - alone) * p.parameter * p.parameter;
  };
  const BranchPoint &last = points.back(), &middle = points[points.size() / 2];
  EXPECT_NEAR(*last.solution.energy / last.parameter, alone, 0.03 * alone);
  EXPECT_NEAR(off(last) / off(middle), 1, 0.2);
}

}  // namespace
}  // namespace extremal::laws
