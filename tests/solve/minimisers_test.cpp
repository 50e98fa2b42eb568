#include <numbers>

#include "machine/long_test.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/laws.hpp"
#include "solve/search/balance.hpp"
#include "solve/search/gradient_flow.hpp"
#include "solve/search/time_law.hpp"

/// \file Minimisers in intervals of any length, from the straight line. Exact actions of paths from rest to
/// rest are ∫ √(2V) along them; a fixed end at a rest costs e^−2rt more.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// (x² − 1)²/4: the kink x = tanh(t/√2) has the action 2√2/3.
Problem double_well(double T) {
  return fixed_ends(trace(1,
                          [](auto q, auto v, auto) {
                            const auto u = q[0] * q[0] - 1.0;
                            return v[0] * v[0] / 2.0 + u * u / 4.0;
                          }),
                    {-1}, {1}, T);
}

Problem sine_gordon(double T) {
  return fixed_ends(trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + cos(q[0]); }), {-pi}, {pi},
                    T);
}

/// Freidlin and Wentzell's action of the drift u − u³.
Problem against_the_drift(double T) {
  return fixed_ends(trace(1,
                          [](auto q, auto v, auto) {
                            const auto off = v[0] - q[0] + q[0] * q[0] * q[0];
                            return off * off / 2.0;
                          }),
                    {-1}, {0}, T);
}

/// Maier and Stein, β = 10.
Problem maier_stein(double T) {
  return fixed_ends(trace(2,
                          [](auto q, auto v, auto) {
                            const auto u = v[0] - q[0] + q[0] * q[0] * q[0] + 10.0 * q[0] * q[1] * q[1];
                            const auto w = v[1] + (1.0 + q[0] * q[0]) * q[1];
                            return (u * u + w * w) / 2.0;
                          }),
                    {-1, 0}, {0, 0}, T);
}

void expect_minimum(const Solution& s, double action, double error) {
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.action, action, error);
  EXPECT_EQ(s.morse_index, 0);
  EXPECT_TRUE(s.minimizing);
}

TEST(Minimisers, KinksInLongIntervals) {
  for (const double T : {24.0, 30.0, 100.0, 1000.0}) {
    const Solution s = solve(double_well(T), within(1e-8));
    expect_minimum(s, 2 * std::sqrt(2.0) / 3, 1e-9);
    EXPECT_NEAR(at(s.trajectory, T / 2).q[0], 0, 1e-7) << T;
    EXPECT_NEAR(at(s.trajectory, T / 2 + 1).q[0], std::tanh(1 / std::sqrt(2.0)), 1e-7) << T;
    EXPECT_NE(s.message.find("a shift in time"), std::string::npos);
  }
}

/// The odd kink is in the middle, whether forces hold it there (1e-9 of those of the motion for T = 20) or,
/// above 32 and 24, the energies of both rests alone. The sum of two places has the errors of both.
TEST(Minimisers, KinksThatForcesHardlyHold) {
  const auto expect_odd = [](const Problem& problem, double tolerance) {
    const Solution s = solve(problem, within(tolerance));
    const double T = problem.duration.value, range = 2 * at(s.trajectory, T).q[0];
    for (const double part : {0.3, 0.45, 0.5}) {
      const double sum = at(s.trajectory, part * T).q[0] + at(s.trajectory, (1 - part) * T).q[0];
      EXPECT_LT(std::abs(sum), 2 * std::max(tolerance, 1e-11) * range) << T << " " << tolerance;
      EXPECT_LT(std::abs(sum), 4 * s.error_estimate + 1e-14) << T << " " << tolerance;
    }
  };
  for (const double tolerance : {1e-5, 1e-9, 1e-11, 1e-12}) {
    for (const double T : {26.0, 29.0, 31.5, 32.0, 32.5}) expect_odd(sine_gordon(T), tolerance);
    for (const double T : {20.0, 22.0, 23.5, 24.0}) expect_odd(double_well(T), tolerance);
  }
}

/// x' > 0 throughout is a Jacobi field without a zero: there is no conjugate time, whatever elements make of
/// an eigenvalue that is less than the error which the tolerance leaves. At T = 18 roundoff hides the path of
/// the steeper wells from Newton's method alone.
TEST(Minimisers, MonotonePathsHaveNoConjugateTime) {
  const auto steep = [](double T) {
    return fixed_ends(trace(1,
                            [](auto q, auto v, auto) {
                              const auto u = 1.0 - q[0] * q[0];
                              return (v[0] * v[0] + u * u) / 2.0;
                            }),
                      {-1}, {1}, T);
  };
  for (const double tolerance : {1e-3, 1e-5}) {
    for (const double T : {24.0, 26.7, 32.5, 33.0})
      expect_minimum(solve(sine_gordon(T), within(tolerance)), 8 - T, 1e-2);
    for (const double T : {15.0, 18.0, 20.0, 22.0})
      expect_minimum(solve(steep(T), within(tolerance)), 4.0 / 3, 1e-3);
  }
}

/// Where the drift alone leads, Freidlin and Wentzell's momenta vanish, and energies: what roundoff leaves of
/// them is that of terms of size one. Forwards and backwards.
TEST(Minimisers, PathsOfTheDriftAlone) {
  const auto leaving = trace(1, [](auto q, auto v, auto) { return (v[0] - q[0]) * (v[0] - q[0]) / 2.0; });
  const auto settling = trace(1, [](auto q, auto v, auto) { return (v[0] + q[0]) * (v[0] + q[0]) / 2.0; });
  const auto across = trace(1, [](auto q, auto v, auto) {
    const auto noise = v[0] - q[0] + q[0] * q[0] * q[0];
    return noise * noise / 2.0;
  });
  for (const double T : {10.0, 25.0, 100.0}) {
    const Solution away = solve(fixed_ends(leaving, {0}, {1}, T), within(1e-9));
    const Solution back = solve(fixed_ends(settling, {1}, {0}, T), within(1e-9));
    expect_minimum(away, 1 / std::expm1(2 * T), 1e-15);
    expect_minimum(back, 1 / std::expm1(2 * T), 1e-15);
    const double t = T - 2, exact = std::sinh(t) / std::sinh(T);
    EXPECT_NEAR(at(away.trajectory, t).q[0], exact, 1e-9) << T;
    EXPECT_NEAR(at(back.trajectory, T - t).q[0], exact, 1e-9) << T;
    if (T > 20) expect_minimum(solve(fixed_ends(across, {0}, {1}, T), within(1e-9)), 0, 1e-13);
  }
}

/// All of a chain at once: each coordinate has the action of the kink.
TEST(Minimisers, KinksOfManyCoordinates) {
  LONG_TEST();
  constexpr int n = 50;
  const Problem chain = fixed_ends(trace(n,
                                         [](auto q, auto v, auto) {
                                           auto sum = 0.0 * q[0];
                                           for (int i = 0; i < n; ++i) {
                                             const auto u = q[i] * q[i] - 1.0;
                                             sum = sum + v[i] * v[i] / 2.0 + u * u / 4.0;
                                           }
                                           for (int i = 0; i + 1 < n; ++i) {
                                             const auto d = q[i + 1] - q[i];
                                             sum = sum + d * d / 4.0;
                                           }
                                           return sum;
                                         }),
                                   std::vector<double>(n, -1), std::vector<double>(n, 1), 100);
  const Solution s = solve(chain, within(1e-8));
  ASSERT_TRUE(s.converged()) << s.message;
  EXPECT_NEAR(s.action, n * 2 * std::sqrt(2.0) / 3, 1e-8);
  EXPECT_EQ(s.morse_index, 0);
}

/// The drift −V' with wells at −2, 0 and 2 and saddles at −1 and 1: shifts between the five rests are more
/// than motions beside the path. The action is twice the rise of V, 9/8 and 11/24.
TEST(Minimisers, SeveralRestsOfOneCoordinate) {
  const auto drift = trace(1, [](auto q, auto v, auto) {
    const auto off = v[0] + 0.5 * q[0] * (q[0] * q[0] - 1.0) * (q[0] * q[0] - 4.0);
    return off * off / 2.0;
  });
  for (const double T : {80.0, 150.0, 300.0}) {
    const Solution s = solve(fixed_ends(drift, {-2}, {2}, T), within(1e-8));
    expect_minimum(s, 19.0 / 6, 1e-9);
    EXPECT_EQ(s.nullity, 4) << T;
  }
}

/// Three double wells, coupled: the middle one is passed first. The action by collocation of Hamilton's
/// equations (scipy's solve_bvp).
TEST(Minimisers, SeveralRestsOfCoupledCoordinates) {
  const auto wells = trace(3, [](auto q, auto v, auto) {
    const auto a = 0.1 * (q[0] - q[1]), b = 0.1 * (q[1] - q[2]);
    const auto x = v[0] + q[0] * q[0] * q[0] - q[0] + a, y = v[1] + q[1] * q[1] * q[1] - q[1] - a + b,
               z = v[2] + q[2] * q[2] * q[2] - q[2] - b;
    return (x * x + y * y + z * z) / 2.0;
  });
  const Solution s = solve(fixed_ends(wells, {-1, -1, -1}, {1, 1, 1}, 80), within(1e-8));
  expect_minimum(s, 1.2575036579, 1e-8);
}

TEST(Minimisers, MonotonePathsStayMonotone) {
  for (const double T : {60.0, 500.0, 1000.0}) {
    const Solution s = solve(sine_gordon(T), within(1e-8));
    expect_minimum(s, 8 - T, 1e-11 * T);
  }
}

/// The tail of the kink is e^−2t on one side and e^−t on the other: energies at the ends agree where the kink
/// is at T/3. In T = 18 the forces that hold it there are 1e-11, and elements and gradients must resolve
/// them.
TEST(Minimisers, UnequalTailsAreBalanced) {
  for (const double T : {15.0, 18.0, 40.0, 100.0}) {
    const Solution s = solve(against_the_drift(T), within(1e-8));
    expect_minimum(s, 0.5, 1e-8);
    EXPECT_NEAR(at(s.trajectory, T / 3).q[0], -1 / std::sqrt(2.0), 2e-3) << T;
  }
}

/// x' = x (1 − x)(1 + kx) of energy E → 0 needs ln(2/ε) + c₀ for x < 1/2 and ln(2r/ε)/r + c₁ beyond, with
/// ε = √(2E), r = 1 + k: so the duration determines ε and the time of x = 1/2. Neither tails whose rates
/// differ nor a loose tolerance moves it.
TEST(Minimisers, KinksBetweenRestsOfDifferentRates) {
  for (const auto& [k, T] :
       {std::pair(2.0, 30.0), std::pair(10.0, 45.0), std::pair(30.0, 18.0), std::pair(30.0, 20.0),
        std::pair(1.288, 115.37), std::pair(80.0, 20.0), std::pair(60.0, 26.0)}) {
    const Problem problem = fixed_ends(trace(1,
                                             [k = k](auto q, auto v, auto) {
                                               const auto w = q[0] * (1.0 - q[0]) * (1.0 + k * q[0]);
                                               return (v[0] * v[0] + w * w) / 2.0;
                                             }),
                                       {0}, {1}, T);
    const double r = 1 + k, log2 = std::log(2.0), part = k / r * std::log(1 + k / 2);
    const double c0 = -log2 + log2 / r - part, c1 = -k / r * std::log(r) + log2 - log2 / r + part;
    const double log_epsilon = -(T - log2 - c0 - c1 - std::log(2 * r) / r) / (1 + 1 / r);
    for (const double tolerance : {1e-10, 1e-9, 1e-3}) {
      const Solution s = Solver().solve(problem, within(tolerance));
      ASSERT_TRUE(s.converged()) << k << ": " << s.message;
      double x = 0, v = 0;
      s.trajectory.at(log2 - log_epsilon + c0, {&x, 1}, {&v, 1});
      EXPECT_NEAR(x, 0.5, 1e-8 * std::max(1.0, v)) << k << ", " << tolerance;
      // These times leave out about ε.
      EXPECT_LE(std::abs(x - 0.5), 10 * s.error_estimate + std::exp(log_epsilon) * std::max(1.0, v))
          << k << ", " << tolerance;
      EXPECT_EQ(s.morse_index, 0);
      EXPECT_TRUE(s.conjugate_times.empty()) << k << ", " << tolerance;
    }
  }
}

TEST(Minimisers, RestsBetweenTheEnds) {
  const Solution two = solve(fixed_ends(trace(1,
                                              [](auto q, auto v, auto) {
                                                const auto u = q[0] * (q[0] * q[0] - 1.0);
                                                return (v[0] * v[0] + u * u) / 2.0;
                                              }),
                                        {-1}, {1}, 100),
                             within(1e-8));
  expect_minimum(two, 0.5, 1e-10);
  EXPECT_EQ(two.nullity, 2);
  EXPECT_NEAR(at(two.trajectory, 50).q[0], 0, 1e-6);
  Problem between = double_well(60);
  between = fixed_ends(between.lagrangian, {-2}, {1.5}, 60);
  expect_minimum(solve(between, within(1e-8)), (8.0 / 3 + 7.0 / 24) / std::sqrt(2.0), 1e-9);
}

/// The potential of three holes (Metzner, Schütte and Vanden-Eijnden, J. Chem. Phys. 125 (2006) 084110), from
/// one deep hole to the other over the saddle between: S = V(saddle) − V(hole). The path rests at all three.
/// Along the saddle's ridge it neither leaves nor approaches, and what roundoff makes of that, which falls
/// more slowly than the rest, must not move it. By symmetry it is at the saddle when half the time is over.
TEST(Minimisers, OverASaddleBetweenTwoHoles) {
  const auto holes = trace(2, [](auto q, auto v, auto) {
    const auto x = q[0], y = q[1], up = y - 1.0 / 3.0, hill = y - 5.0 / 3.0, left = x + 1.0, right = x - 1.0;
    const auto e1 = 3.0 * exp(-x * x - up * up), e2 = 3.0 * exp(-x * x - hill * hill);
    const auto e3 = 5.0 * exp(-right * right - y * y), e4 = 5.0 * exp(-left * left - y * y);
    const auto slope_x = 2.0 * (x * (e2 - e1) + right * e3 + left * e4) + 0.8 * x * x * x;
    const auto slope_y = 2.0 * (hill * e2 - up * e1 + y * (e3 + e4)) + 0.8 * up * up * up;
    const auto u = v[0] + slope_x, w = v[1] + slope_y;
    return (u * u + w * w) / 4.0;
  });
  const double x = 1.0480549928242194, y = -0.0420936663066778;
  for (const double T : {10.0, 20.0, 30.0, 100.0, 400.0}) {
    const Solution s = solve(fixed_ends(holes, {-x, y}, {x, y}, T), within(1e-8));
    expect_minimum(s, 2.61027396145577, 1e-10);
    EXPECT_LT(s.error_estimate, 1e-4) << T;
    EXPECT_LE(std::abs(at(s.trajectory, T / 2).q[0]), 10 * s.error_estimate) << T;
  }
}

/// Out to −1, across to 1 and back: where it crosses, the action is largest, by less than roundoff. It falls
/// to a path that rests at −1 or at 1 alone.
TEST(Minimisers, RestsThatThePathTurnsBackFrom) {
  const auto sharp = [](double sharpness) {
    return trace(1, [=](auto q, auto v, auto) {
      const auto u = v[0] / sharpness - sharpness * (1.0 - q[0] * q[0]);
      return u * u / 2.0;
    });
  };
  const auto well = trace(1, [](auto q, auto v, auto) {
    const auto u = 1.0 - q[0] * q[0];
    return (v[0] * v[0] + u * u) / 2.0;
  });
  const auto w = [](double x) { return x - x * x * x / 3; };
  const double left = w(-0.8) - w(-1) + w(0.9) - w(-1), right = w(1) - w(-0.8) + w(1) - w(0.9);
  for (const double T : {16.0, 100.0, 1000.0}) {
    const Solution s = solve(fixed_ends(well, {-0.8}, {0.9}, T), within(1e-8));
    expect_minimum(s, std::abs(s.action - left) < std::abs(s.action - right) ? left : right, 1e-8);
  }
  for (const double e : {1e-3, 1e-5})
    expect_minimum(solve(fixed_ends(sharp(1 / std::sqrt(e)), {-0.8}, {0.9}, 1), within(1e-8)),
                   2 * (w(1) - w(0.9)), 1e-8);
}

/// Between -1/2 and 1/2 two such paths have the action 4/3; one end is beside the rest that the path turns
/// back from, and slower than its tails.
TEST(Minimisers, RestsBesideTheEnds) {
  const auto well = trace(1, [](auto q, auto v, auto) {
    const auto u = 1.0 - q[0] * q[0];
    return (v[0] * v[0] + u * u) / 2.0;
  });
  const auto w = [](double x) { return x - x * x * x / 3; };
  for (const double T : {150.0, 1e4, 1e5})
    expect_minimum(solve(fixed_ends(well, {-0.5}, {0.5}, T), within(1e-8)), 4.0 / 3, 1e-8);
  for (const double T : {300.0, 1e4})
    expect_minimum(solve(fixed_ends(well, {-0.99}, {0.9999}, T), within(1e-9)),
                   2 * w(1) - w(0.9999) + w(0.99), 1e-9);
}

/// The drift u (u - 1) (u - 0.3) is overcome to 0.3 only. In a rest at each of its zeros the energy is about
/// 1e-8 or 1e-14: digits of second derivatives are lost, but it is not hidden. Energies by quadrature of
/// T = ∫ du / √(f² + 2E).
TEST(Minimisers, WeaklyHeldPathsAreBalanced) {
  const auto drift = trace(1, [](auto q, auto v, auto) {
    const auto f = q[0] * (q[0] - 1.0) * (q[0] - 0.3);
    return (v[0] * v[0] + f * f) / 2.0;
  });
  const std::pair<double, double> energies[] = {{100, 1.09490783653211834e-8},
                                                {200, 9.12537667048072505e-15}};
  for (const auto& [T, energy] : energies) {
    const Solution s = solve(fixed_ends(drift, {0}, {1}, T), within(1e-9));
    expect_minimum(s, T < 150 ? 0.0409834116019365 : 0.0409833333333985, 1e-12);
    EXPECT_NEAR(s.energy.value(), energy, 1e-6 * energy) << T;
    EXPECT_EQ(s.nullity, 0);
  }
}

/// A rest where L is larger than at another gives its time to that. Actions by quadrature at the energy of
/// the lower equilibrium.
TEST(Minimisers, RestsThatCostMore) {
  const auto tilted = trace(1, [](auto q, auto v, auto) {
    const auto u = 1.0 - q[0] * q[0];
    return (v[0] * v[0] + u * u) / 2.0 + 0.1 * q[0];
  });
  for (const auto& [T, action] : {std::pair{3e3, -302.0749309142135}, {1e4, -1010.616451121092}})
    expect_minimum(solve(fixed_ends(tilted, {-0.9}, {0.9}, T), within(1e-9)), action, 1e-9 * T);
  const auto valleys = trace(2, [](auto q, auto v, auto) {
    const auto x = q[0] * q[0] - 1.0, y = q[1] * q[1] - 1.0;
    return (v[0] * v[0] + v[1] * v[1] + x * x + y * y) / 2.0 + 0.1 * q[0] * q[0] * q[1] * q[1];
  });
  // All rests cost 1/11; what is beyond that does not change with the duration. At T = 40 by scipy's
  // solve_bvp, with the action as an unknown.
  const double beyond = 5.941051708659 - 40.0 / 11;
  for (const double T : {60.0, 200.0, 400.0})
    expect_minimum(solve(fixed_ends(valleys, {-1, -0.95}, {0.9, 0.9}, T), within(1e-9)), T / 11 + beyond,
                   1e-8);
}

TEST(Minimisers, SaddlesAreLeftBothWays) {
  const Problem paraboloid = fixed_ends(trace(2,
                                              [](auto q, auto v, auto) {
                                                const auto rise = 2.0 * (q[0] * v[0] + q[1] * v[1]);
                                                return (v[0] * v[0] + v[1] * v[1] + rise * rise) / 2.0;
                                              }),
                                        {3, 0}, {-3, 0}, 1);
  EXPECT_NEAR(solve(paraboloid, within(1e-9)).action, 190.0114785, 1e-6);
  const std::vector<Solution> lowest = Solver().solve_all(paraboloid, within(1e-9), 2);
  ASSERT_EQ(lowest.size(), 2u);
  for (const Solution& s : lowest) expect_minimum(s, 43.40811328, 1e-7);
  EXPECT_NEAR(at(lowest[0].trajectory, 0.5).q[1], -at(lowest[1].trajectory, 0.5).q[1], 1e-7);
}

/// The straight line keeps the mirror symmetry, and runs over the top of a hill: round it the action is less.
TEST(Minimisers, SymmetricSaddlesAreLeft) {
  for (const double height : {2.0, 4.0}) {
    const auto hill = trace(2, [=](auto q, auto v, auto) {
      return (v[0] * v[0] + v[1] * v[1]) / 2.0 + height * exp(-(q[0] * q[0] + 2.0 * q[1] * q[1]));
    });
    const Solution s = solve(fixed_ends(hill, {3, 0}, {-3, 0}, 25), within(1e-9));
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_EQ(s.morse_index, 0) << height;
    EXPECT_GT(std::abs(at(s.trajectory, 12.5).q[1]), 0.1);
  }
}

/// The action of Freidlin and Wentzell for two coupled double wells, V = Σ (x⁴/4 − x²/2) + k (x − y)²/2. The
/// most probable path from (−1, −1) to (1, 1) turns one of them after the other: up to a saddle, where xy =
/// −k and x² + y² = 1 − k, down to (a, −a) with a² = 1 − 2k, and over a second saddle. Each ascent costs
/// twice its height.
TEST(Minimisers, OneWellAfterTheOther) {
  const double k = 0.1, a = std::sqrt(1 - 2 * k), T = 60;
  const double saddle = ((1 - k) * (1 - k) - 2 * k * k) / 4 - (1 - k) / 2 + k * (1 + k) / 2;
  const double between = a * a * a * a / 2 - a * a + 2 * k * a * a;
  const auto drift = trace(2, [=](auto q, auto v, auto) {
    const auto x = v[0] + q[0] * q[0] * q[0] - q[0] + k * (q[0] - q[1]);
    const auto y = v[1] + q[1] * q[1] * q[1] - q[1] + k * (q[1] - q[0]);
    return (x * x + y * y) / 2.0;
  });
  expect_minimum(solve(fixed_ends(drift, {-1, -1}, {1, 1}, T), within(1e-9)),
                 2 * (saddle + 0.5) + 2 * (saddle - between), 2e-7);
}

TEST(Minimisers, MostProbablePaths) {
  LONG_TEST();
  for (const double T : {12.0, 30.0, 100.0}) {
    const std::vector<Solution> lowest = Solver().solve_all(maier_stein(T), within(1e-8), 2);
    ASSERT_EQ(lowest.size(), 2u) << T;
    for (const Solution& s : lowest) expect_minimum(s, 0.3400414, T > 20 ? 1e-7 : 1e-6);
    EXPECT_GT(std::abs(at(lowest[0].trajectory, T / 2).q[1] - at(lowest[1].trajectory, T / 2).q[1]), 1e-9)
        << T;
  }
}

/// Slope at the end √(2 cosh μ − 2), by the energy at 0 where the path is at rest but for e^−μ.
TEST(Minimisers, Layers) {
  const Problem layer = fixed_ends(
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + cosh(50.0 * q[0]); }), {0}, {1}, 1);
  const Solution s = solve(layer, within(1e-8));
  ASSERT_TRUE(s.converged()) << s.message;
  const double slope = std::sqrt(2 * std::cosh(50.0) - 2);
  EXPECT_NEAR(s.momentum_end[0], slope, 1e-7 * slope);
  const Problem free =
      with_ends(trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + cosh(q[0]); }), 5,
                [](BoundaryRelation& b) { b.fix(0, false, -38.94); });
  const Solution long_fall = solve(free, within(1e-8));
  ASSERT_TRUE(long_fall.converged()) << long_fall.message;
  const double fastest = 2 * std::sinh(19.47);
  EXPECT_NEAR(long_fall.momentum_start[0], fastest, 1e-6 * fastest);
}

/// Fastest fall over 10 from y to 5 metres below the level of rest: y = a(1 − cos θ), x = a(θ − sin θ) with
/// a = 2.5860 takes the time √(a/g) Δθ. Near the level the slope is √(2a/y).
TEST(Minimisers, FallsFromNearlyRest) {
  for (const auto& [y, time] : {std::pair(1e-3, 1.7870175119174), std::pair(1e-4, 1.7967802611542)}) {
    const Problem fall = fixed_ends(
        trace(1, [](auto q, auto v, auto) { return sqrt((1.0 + v[0] * v[0]) / (2 * 9.81 * q[0])); }), {y},
        {5}, 10);
    expect_minimum(solve(fall, within(1e-8)), time, 1e-9);
  }
}

/// A rod of th'(1) = 0 that a load slightly off its axis buckles, from a guess that is all but straight: the
/// minimiser, which is far from it. Integrated with the slope at 0 for which th'(1) = 0.
TEST(Minimisers, FarFromASmallGuess) {
  Problem rod = with_ends(
      trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 3.0 * cos(q[0]) + 0.3 * sin(q[0]); }), 1,
      [](BoundaryRelation& b) { b.fix(0, false, 0); });
  rod = guessed(std::move(rod), [](double tau) { return Values{0.01 * tau}; });
  expect_minimum(solve(rod, within(1e-9)), 2.693260443820, 1e-9);
}

/// A path of linear elements at the guess.
struct Flow {
  explicit Flow(const Problem& given) : problem(given) {
    w.levels.bind(problem.lagrangian);
    const ElementTables& tables = GradientFlow::linear_elements(w.levels);
    path.reset(tables, uniform_mesh(256), problem.duration.value);
    start_path(problem, starting_ends(problem), tables, path);
  }
  const Problem& problem;
  Workspace w;
  Path path;
};

TEST(GradientFlow, ActionFallsAndOrderIsKept) {
  const Problem problem = double_well(40);
  Flow flow(problem);
  std::vector<double> actions;
  GradientFlow descent(problem, flow.path, flow.w, [&] {
    actions.push_back(flow.w.iteration.action().action());
    return true;
  });
  ASSERT_TRUE(descent.run());
  EXPECT_LT(actions.back(), 0.5 * actions.front());
  EXPECT_NEAR(actions.back(), 2 * std::sqrt(2.0) / 3, 1e-2);
  for (int k = 0; k < flow.path.elements(); ++k) EXPECT_LE(flow.path.node(k)[0], flow.path.node(k + 1)[0]);
}

TEST(GradientFlow, StopsWhenToldTo) {
  const Problem problem = double_well(40);
  Flow flow(problem);
  int left = 3;
  GradientFlow descent(problem, flow.path, flow.w, [&] { return --left > 0; });
  EXPECT_FALSE(descent.run());
  EXPECT_EQ(left, 0);
}

/// Without a minimum: the action falls without bound.
TEST(GradientFlow, GivesUpWhereThereIsNoMinimum) {
  const Problem problem = fixed_ends(systems::oscillator(1), {0.5}, {0.3}, 20);
  Flow flow(problem);
  GradientFlow descent(problem, flow.path, flow.w, [] { return true; });
  EXPECT_FALSE(descent.run());
}

/// Of a straight line between the wells, each element with the energy of all: the kink, but for the elements.
TEST(TimeLaw, OneEnergyInAllElements) {
  const Problem problem = double_well(30);
  Flow flow(problem);
  TimeLaw times;
  times.reset(problem, GradientFlow::linear_elements(flow.w.levels), flow.path.elements());
  ASSERT_TRUE(times.apply(flow.path, 30));
  EXPECT_EQ(flow.path.duration(), 30);
  for (int k = 0; k < flow.path.elements(); ++k) {
    const double t = 30 * (flow.path.mesh()[k] - 0.5), q = flow.path.node(k)[0];
    if (std::abs(q) < 0.9) {
      EXPECT_NEAR(q, std::tanh(t / std::sqrt(2.0)), 1e-2);
    }
  }
  ASSERT_TRUE(times.apply(flow.path, 30, 0.1));
  EXPECT_LT(flow.path.duration(), 10);
}

TEST(TimeLaw, NeedsAnActionWithoutTime) {
  const Problem problem =
      fixed_ends(trace(1, [](auto, auto v, auto t) { return v[0] * v[0] / 2.0 + cos(t); }), {0}, {1}, 5);
  Flow flow(problem);
  TimeLaw times;
  times.reset(problem, GradientFlow::linear_elements(flow.w.levels), flow.path.elements());
  EXPECT_FALSE(times.apply(flow.path, 5));
}

/// Ends that are not at rest hold a path in time.
TEST(Balance, NeedsTwoRests) {
  const Problem problem = fixed_ends(systems::oscillator(1), {0.5}, {0.3}, 2);
  Flow flow(problem);
  EXPECT_FALSE(Balance(problem, flow.path).exists());
}

}  // namespace
}  // namespace extremal::laws
