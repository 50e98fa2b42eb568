#include <cmath>

#include "solve/laws.hpp"

/// \file Paths that forces hold in time by less than the errors of elements, or than roundoff.

namespace extremal::laws {
namespace {

/// Freidlin and Wentzell's action of the drift r' = −r(1 − r²), θ' = ω, from its equilibrium to the limit
/// cycle r = 1, guessed by the path of infinite duration that passes r = 1/2 at t₀.
Problem to_limit_cycle(double omega, double T, double t0) {
  const Problem problem = fixed_ends(trace(2,
                                           [=](auto q, auto v, auto) {
                                             const auto fall = 1.0 - q[0] * q[0] - q[1] * q[1];
                                             const auto x = v[0] + q[0] * fall + omega * q[1],
                                                        y = v[1] + q[1] * fall - omega * q[0];
                                             return (x * x + y * y) / 2.0;
                                           }),
                                     {0, 0}, {1, 0}, T);
  return guessed(problem, [=](double tau) -> Values {
    const double r = 1 / std::sqrt(1 + 3 * std::exp(-2 * (tau * T - t0))), angle = omega * T * (tau - 1);
    const double held = tau == 0 ? 0 : tau == 1 ? 1 : r;
    return {held * std::cos(angle), held * std::sin(angle)};
  });
}

/// The time of r = 1/2 is that at the energy E with T = ∫₀¹ dr/√(r²(1 − r²)² + 2E), by quadrature in 60
/// digits. Along the cycle the path moves, without a rest.
TEST(Isolation, HeldBetweenAnEquilibriumAndALimitCycle) {
  const std::pair<double, double> passages[] = {
      {10, 6.11863749061}, {20, 12.7840288086}, {50, 32.784027189}, {100, 66.1173605223}};
  for (const double omega : {0.3, 3.0})
    for (const auto& [T, passage] : passages)
      for (const double tolerance : {1e-3, 1e-5, 1e-9}) {
        SolveOptions options = within(tolerance);
        options.max_iterations = 100;
        const Solution s = Solver().solve(to_limit_cycle(omega, T, T < 20 ? passage : 0.5 * T), options);
        EXPECT_TRUE(s.converged() || T > 10) << omega << ' ' << tolerance << ": " << s.message;
        if (!s.converged()) continue;
        const Values q = at(s.trajectory, passage).q;
        EXPECT_NEAR(std::hypot(q[0], q[1]), 0.5, 10 * s.error_estimate + 1e-11)
            << omega << ' ' << T << ' ' << tolerance;
      }
}

/// A path that is no extremal to the last digit, T = 20 and all digits that there are: the guess is 0.05 off,
/// where the forces that hold it are 1e-12.
TEST(Isolation, NoFamilyWhereForcesAreSmall) {
  for (const double tolerance : {1e-3, 1e-9}) {
    SolveOptions options = within(tolerance);
    options.max_iterations = 100;
    const Solution s = Solver().solve(to_limit_cycle(1, 20, 12.737), options);
    if (!s.converged()) continue;
    const Values q = at(s.trajectory, 12.7840288086).q;
    EXPECT_NEAR(std::hypot(q[0], q[1]), 0.5, 10 * s.error_estimate + 1e-11) << tolerance;
  }
}

}  // namespace
}  // namespace extremal::laws
