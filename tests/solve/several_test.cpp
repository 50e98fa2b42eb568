#include <numbers>

#include "machine/long_test.hpp"
#include "rivals/verify.hpp"
#include "solve/motions.hpp"

/// \file Several extremals of one problem: all that exist where their number is known, each verified, none
/// twice.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// q(T) = q(0).
Problem closed(std::shared_ptr<const Lagrangian> lagrangian, double duration) {
  Problem problem = with_ends(std::move(lagrangian), duration, [](BoundaryRelation& r) {
    for (int a = 0; a < r.coordinates; ++a) {
      const int row = r.add_row(0);
      r.add(row, a, 1);
      r.add(row, r.coordinates + a, -1);
    }
  });
  problem.periodic = true;
  return problem;
}

/// Solves; every solution has converged, is verified by integration and differs from the others; they are
/// sorted by action.
std::vector<Solution> solve_all(const Problem& problem, int most) {
  constexpr double tolerance = 1e-9;
  Solver solver;
  std::vector<Solution> found = solver.solve_all(problem, within(tolerance), most);
  EXPECT_LE(static_cast<int>(found.size()), most);
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_TRUE(found[k].converged()) << found[k].message;
    if (!found[k].converged()) continue;
    const Verification check = verify(problem, found[k].trajectory, {.tolerance = tolerance});
    EXPECT_TRUE(check.verified) << found[k].strategy << ": " << check.message;
    EXPECT_TRUE(found[k].morse_index);
    EXPECT_FALSE(found[k].strategy.empty());
    if (k > 0) {
      EXPECT_GE(found[k].action, found[k - 1].action);
    }
    for (std::size_t j = 0; j < k; ++j) {
      double apart = std::abs(found[k].duration() - found[j].duration());
      for (int i = 0; i <= 100; ++i)
        apart = std::max(apart, largest_difference(at(found[k].trajectory, found[k].duration() * i / 100).q,
                                                   at(found[j].trajectory, found[j].duration() * i / 100).q));
      EXPECT_GT(apart, 1e-4) << j << " and " << k;
    }
  }
  return found;
}

/// The roots of f between neighbours of x where it changes its sign without a pole.
template <class F>
Values roots(const Values& x, const F& f) {
  Values result;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    double a = x[k], b = x[k + 1];
    const double fa = f(a);
    if (!(fa * f(b) < 0)) continue;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (a + b);
      (f(middle) * fa > 0 ? a : b) = middle;
    }
    result.push_back(a);
  }
  return result;
}

/// All actions of q'' = −sin q from 0 to `end` in (0, π) in a duration so long that no rotation is slow
/// enough. With k the sine of half the amplitude and sin φ = sin(q/2)/k, the time from 0 to q upwards is F(φ,
/// k), and ∫ q' dq = 4 (E(φ, k) − (1 − k²) F(φ, k)); S = ∫ q' dq − (2k² − 1) T.
Values pendulum_actions(double end, double duration) {
  const auto first = [&](double k) { return std::asin(std::min(1.0, std::sin(end / 2) / k)); };
  const auto work = [](double k, double phi) {
    return 4 * (std::ellint_2(k, phi) - (1 - k * k) * std::ellint_1(k, phi));
  };
  Values amplitudes;
  const double least = std::sin(end / 2);
  for (int i = 0; i <= 4000; ++i) amplitudes.push_back(1 - (1 - least) * std::exp(-i / 160.0));
  Values actions;
  // Passages of `end` in quarter swings: n ± φ, upwards and downwards.
  for (int quarters = 0; quarters < 40; quarters += 2)
    for (const double sign : {1.0, -1.0}) {
      const auto time = [&](double k) {
        return quarters * std::ellint_1(k, pi / 2) + sign * std::ellint_1(k, first(k)) - duration;
      };
      for (double k : roots(amplitudes, time))
        actions.push_back(quarters * work(k, pi / 2) + sign * work(k, first(k)) - (2 * k * k - 1) * duration);
    }
  std::sort(actions.begin(), actions.end());
  return actions;
}

TEST(Several, AllMotionsOfAPendulum) {
  LONG_TEST();
  struct Case {
    double end, duration;
    std::size_t count;
  };
  for (const Case& c : {Case{1, 20, 11}, Case{1, 10, 5}, Case{2.5, 15, 5}, Case{0.2, 14, 9}}) {
    const Values exact = pendulum_actions(c.end, c.duration);
    EXPECT_EQ(exact.size(), c.count);
    const std::vector<Solution> found =
        solve_all(fixed_ends(systems::pendulum(), {0}, {c.end}, c.duration), 20);
    ASSERT_EQ(found.size(), exact.size()) << c.end << ", " << c.duration;
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k].action, exact[k], 1e-8);
  }
}

/// Energies of all ellipses from r1 to r2 about a centre of strength 1, both ways round and with any number
/// of revolutions, by Lagrange's equation for the duration (Izzo, Revisiting Lambert's problem, Celest. Mech.
/// Dyn. Astron. 121, 2015, eq. 18 and 9): with λ² = 1 − c/s and y² = 1 − λ²(1 − x²),
///   T √(2/s³) = (ψ + Nπ)/(1 − x²)^(3/2) − (x − λy)/(1 − x²),  cos ψ = xy + λ(1 − x²);  energy −(1 − x²)/s.
Values lambert_energies(const Values& r1, const Values& r2, double duration) {
  const double a = std::hypot(r1[0], r1[1]), b = std::hypot(r2[0], r2[1]);
  const double chord = std::hypot(r2[0] - r1[0], r2[1] - r1[1]), s = (a + b + chord) / 2;
  Values grid, energies;
  for (int i = 1; i < 20000; ++i) grid.push_back(-std::cos(pi * i / 20000));
  for (int revolutions = 0; revolutions < 20; ++revolutions)
    for (const double side : {1.0, -1.0}) {
      const double lambda = side * std::sqrt(1 - chord / s);
      const auto time = [&](double x) {
        const double u = 1 - x * x, y = std::sqrt(1 - lambda * lambda * u);
        const double psi = std::acos(std::clamp(x * y + lambda * u, -1.0, 1.0));
        return (psi + revolutions * pi) / std::pow(u, 1.5) - (x - lambda * y) / u -
               duration * std::sqrt(2 / (s * s * s));
      };
      for (double x : roots(grid, time)) energies.push_back(-(1 - x * x) / s);
    }
  std::sort(energies.begin(), energies.end());
  return energies;
}

TEST(Several, LambertWithUpToTwoRevolutions) {
  LONG_TEST();
  struct Case {
    Values end;
    double duration;
  };
  for (const Case& c : {Case{{-0.6, 0.9}, 16}, Case{{0, -1.5}, 18}, Case{{0.23, -0.93}, 13.6}}) {
    const Values start{1, 0}, exact = lambert_energies(start, c.end, c.duration);
    EXPECT_EQ(exact.size(), 10u) << "both ways without a revolution, and twice with one and with two";
    Values energies;
    for (const Solution& s : solve_all(fixed_ends(systems::kepler(), start, c.end, c.duration), 20))
      energies.push_back(s.energy.value());
    std::sort(energies.begin(), energies.end());
    ASSERT_EQ(energies.size(), exact.size()) << c.end[0] << ", " << c.duration;
    EXPECT_LT(largest_difference(energies, exact), 1e-8);
  }
}

/// As from a low orbit to a high one: most of them pass the centre several times.
TEST(Several, LambertWithUpToSixRevolutions) {
  LONG_TEST();
  struct Case {
    Values end;
    double duration;
  };
  for (const Case& c : {Case{{-2.4, 4.3}, 198}, Case{{0.4, -2.1}, 60}, Case{{-1.7, -0.2}, 45}}) {
    const Values start{1, 0}, exact = lambert_energies(start, c.end, c.duration);
    EXPECT_GE(exact.size(), 18u);
    Values energies;
    for (const Solution& s : solve_all(fixed_ends(systems::kepler(), start, c.end, c.duration), 40))
      energies.push_back(s.energy.value());
    std::sort(energies.begin(), energies.end());
    ASSERT_EQ(energies.size(), exact.size()) << c.end[0] << ", " << c.duration;
    EXPECT_LT(largest_difference(energies, exact), 1e-7);
  }
}

/// Slow motions do not arrive, but fall to the centre time after time; or the ends are near to each other, so
/// that times of arrival hardly change along a curve.
TEST(Several, LambertTowardsTheCentre) {
  LONG_TEST();
  struct Case {
    Values end;
    double duration;
    std::size_t count;
  };
  for (const Case& c : {Case{{0.3, 0.2}, 10, 14}, Case{{0.3, 0.2}, 20, 30}, Case{{0.9, 0.1}, 12, 18}}) {
    const Values start{1, 0}, exact = lambert_energies(start, c.end, c.duration);
    EXPECT_EQ(exact.size(), c.count);
    Values energies;
    for (const Solution& s : solve_all(fixed_ends(systems::kepler(), start, c.end, c.duration), 40))
      energies.push_back(s.energy.value());
    std::sort(energies.begin(), energies.end());
    ASSERT_EQ(energies.size(), exact.size()) << c.end[0] << ", " << c.duration;
    EXPECT_LT(largest_difference(energies, exact), 1e-7);
  }
}

/// From a circle of 8,800 km to one of 42,900 km around the Earth in three days, in units of the first radius
/// and of its period by 2π: half of the ellipses pass the centre at a fifteenth of it, up to fourteen times.
TEST(Several, LambertByCloseEncounters) {
  LONG_TEST();
  const double unit = std::sqrt(std::pow(8800.0, 3) / 398600.4418), ratio = 42900 / 8800.0;
  const Values start{1, 0}, end{ratio * std::cos(0.7), ratio * std::sin(0.7)};
  const double duration = 3 * 86400 / unit;
  const Values exact = lambert_energies(start, end, duration);
  EXPECT_EQ(exact.size(), 30u);
  Values energies;
  for (const Solution& s : solve_all(fixed_ends(systems::kepler(), start, end, duration), 40))
    energies.push_back(s.energy.value());
  std::sort(energies.begin(), energies.end());
  ASSERT_EQ(energies.size(), exact.size());
  EXPECT_LT(largest_difference(energies, exact), 1e-7);
}

/// Soap films between rings of radius 1, y = a cosh(t/a) about the middle, a shallow and a deep one. Momenta
/// are bounded by y, and hardly depend on velocities as fast as those at the deep one's ends.
TEST(Several, Catenaries) {
  LONG_TEST();
  const auto film = trace(1, [](auto q, auto v, auto) { return q[0] * sqrt(1.0 + v[0] * v[0]); });
  for (const double width : {0.6, 1.0, 1.3}) {
    Values grid, exact;
    for (int k = 1; k < 5000; ++k) grid.push_back(k / 5000.0);
    for (const double a : roots(grid, [&](double a) { return a * std::cosh(width / (2 * a)) - 1; }))
      exact.push_back(a * a * (width / a + std::sinh(width / a)) / 2);
    ASSERT_EQ(exact.size(), 2u);
    std::ranges::sort(exact);
    const std::vector<Solution> found = solve_all(fixed_ends(film, {1}, {1}, width), 5);
    ASSERT_EQ(found.size(), 2u) << width;
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(found[k].action, exact[k], 1e-9);
      EXPECT_EQ(found[k].morse_index, k);
    }
  }
}

/// Actions of x'' = x − x³ from `start` to `end` in T: shooting finds every sign of q(T) − end on a fine grid
/// of velocities.
Values well_actions(double start, double end, double duration, double fastest) {
  constexpr int steps = 4000;
  const auto shoot = [&](double velocity, double* action) {
    double x = start, v = velocity, s = 0, h = duration / steps;
    const auto lagrangian = [](double x, double v) { return v * v / 2 - (x * x - 1) * (x * x - 1) / 4; };
    // Fourth order (Yoshida 1990), and the action by Simpson's rule over two steps.
    constexpr double w = 1.3512071919596578;  // 1/(2 − 2^(1/3))
    for (int k = 0; k < steps; ++k) {
      s += (k == 0 ? 1 : k % 2 ? 4 : 2) * lagrangian(x, v);
      for (const double c : {w, 1 - 2 * w, w}) {
        x += c * h / 2 * v;
        v += c * h * (x - x * x * x);
        x += c * h / 2 * v;
      }
    }
    if (action) *action = (s + lagrangian(x, v)) * h / 3;
    return x - end;
  };
  Values grid, actions;
  // Graded towards the velocity with which the barrier is just reached: there motions take long.
  const double depth = 1 - start * start, barrier = std::sqrt((1 - depth * depth) / 2);
  for (int i = 1; i <= 1000; ++i)
    for (const double sign : {1.0, -1.0}) {
      grid.push_back(sign * fastest * i / 1000);
      for (const double side : {1.0, -1.0})
        grid.push_back(sign * (barrier + side * fastest * std::exp(-i / 40.0)));
    }
  std::sort(grid.begin(), grid.end());
  for (const double velocity : roots(grid, [&](double v) { return shoot(v, nullptr); }))
    shoot(velocity, &actions.emplace_back());
  std::sort(actions.begin(), actions.end());
  return actions;
}

/// x'' = −(1 + a cos ωt) sin x from `start` to `end` in T. Near the separatrix pairs of motions leave at
/// velocities that differ by a thousandth. All counts are of a scan by shooting (RK4, 6001 velocities to 6,
/// cells halved where q(T) bends).
TEST(Several, PairsNearTheSeparatrixOfADrivenPendulum) {
  struct Case {
    double strength, rate, start, end, duration;
    std::size_t count;
    Values pair;
  };
  for (const Case& c : {Case{1.09, 0.51, 0.59, -0.06, 14.6, 15, {2.691140, 2.692712}},
                        Case{1.18, 0.81, -0.03, -0.29, 12.4, 19, {3.008638, 3.012937}}}) {
    const auto pendulum = trace(1, [c](auto q, auto v, auto t) {
      return 0.5 * v[0] * v[0] + (1 + c.strength * cos(c.rate * t)) * cos(q[0]);
    });
    const std::vector<Solution> found = solve_all(fixed_ends(pendulum, {c.start}, {c.end}, c.duration), 40);
    EXPECT_EQ(found.size(), c.count) << c.strength;
    for (const double velocity : c.pair)
      EXPECT_TRUE(std::ranges::any_of(found, [&](const Solution& s) {
        return std::abs(at(s.trajectory, 0).v[0] - velocity) < 1e-5;
      })) << velocity;
  }
}

/// Actions of two oscillators with V = (x² + y²)/2 + x² y², from `start` to `end` in T: where a triangle of a
/// grid of velocities goes round the end, Newton's method follows.
Values coupled_actions(const Eigen::Vector2d& start, const Eigen::Vector2d& end, double duration,
                       double fastest) {
  constexpr int steps = 300, grid = 150;
  const auto force = [](const Eigen::Vector2d& q) {
    return Eigen::Vector2d(-q[0] - 2 * q[0] * q[1] * q[1], -q[1] - 2 * q[0] * q[0] * q[1]);
  };
  const auto lagrangian = [](const Eigen::Vector2d& q, const Eigen::Vector2d& v) {
    return (v.squaredNorm() - q.squaredNorm()) / 2 - q[0] * q[0] * q[1] * q[1];
  };
  const auto miss = [&](const Eigen::Vector2d& velocity, double* action) -> Eigen::Vector2d {
    Eigen::Vector2d q = start, v = velocity;
    const double h = duration / steps;
    constexpr double w = 1.3512071919596578;  // Yoshida (1990), as for the double well
    double s = 0;
    for (int k = 0; k < steps; ++k) {
      s += lagrangian(q, v) * (k == 0 ? 1 : k % 2 == 0 ? 2 : 4) * h / 3;
      for (const double part : {w, 1 - 2 * w, w}) {
        q += part * h / 2 * v;
        v += part * h * force(q);
        q += part * h / 2 * v;
      }
    }
    if (action) *action = s + lagrangian(q, v) * h / 3;
    return q - end;
  };
  const auto at = [&](int k) { return fastest * (2.0 * k / grid - 1); };
  std::vector<Eigen::Vector2d> misses;
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) misses.push_back(miss({at(i), at(j)}, nullptr));
  const auto goes_round = [&](int a, int b, int c) {
    const auto turn = [&](int m, int n) {
      return misses[m][0] * misses[n][1] - misses[m][1] * misses[n][0] > 0;
    };
    return turn(a, b) == turn(b, c) && turn(b, c) == turn(c, a);
  };
  Values actions;
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j) {
      const int a = i * (grid + 1) + j, b = a + 1, c = a + grid + 1, d = c + 1;
      if (!goes_round(a, b, c) && !goes_round(b, c, d)) continue;
      Eigen::Vector2d v(at(i) + fastest / grid, at(j) + fastest / grid), step(1, 1);
      for (int k = 0; k < 12 && step.norm() > 1e-9; ++k) {
        const Eigen::Vector2d here = miss(v, nullptr);
        Eigen::Matrix2d slope;
        for (int m = 0; m < 2; ++m)
          slope.col(m) = (miss(v + 1e-6 * Eigen::Vector2d::Unit(m), nullptr) -
                          miss(v - 1e-6 * Eigen::Vector2d::Unit(m), nullptr)) /
                         2e-6;
        step = -slope.inverse() * here;
        v += step * std::min(1.0, 0.1 / step.norm());
      }
      double action = 0;
      miss(v, &action);
      const auto same = [&](double other) { return std::abs(other - action) < 1e-5; };
      if (step.norm() <= 1e-9 && v.cwiseAbs().maxCoeff() <= fastest && std::ranges::none_of(actions, same))
        actions.push_back(action);
    }
  std::ranges::sort(actions);
  return actions;
}

/// In two coordinates: between those that are listed there is all that a dense scan by shooting finds.
TEST(Several, NoneIsMissingBetweenThoseOfCoupledOscillators) {
  LONG_TEST();
  const auto coupled = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] - q[0] * q[0] - q[1] * q[1]) / 2 - q[0] * q[0] * q[1] * q[1];
  });
  for (const double duration : {5.0, 7.0}) {
    const std::vector<Solution> found = solve_all(fixed_ends(coupled, {-0.5, 0.3}, {0.6, 0.2}, duration), 12);
    ASSERT_EQ(found.size(), 12u);
    const Values actions = coupled_actions({-0.5, 0.3}, {0.6, 0.2}, duration, 3);
    int compared = 0;
    for (const double action : actions) {
      if (action > found.back().action + 1e-5) break;
      ++compared;
      EXPECT_TRUE(
          std::ranges::any_of(found, [&](const Solution& s) { return std::abs(s.action - action) < 1e-4; }))
          << duration << ": " << action;
    }
    EXPECT_GE(compared, 6) << duration;
  }
}

/// Those of least action, without a gap, as many as are asked for.
TEST(Several, NoneIsMissingBetweenThoseOfADoubleWell) {
  LONG_TEST();
  const auto well = trace(1, [](auto q, auto v, auto) {
    const auto u = q[0] * q[0] - 1;
    return v[0] * v[0] / 2 - u * u / 4;
  });
  struct Case {
    double start, end, duration;
  };
  for (const Case& c : {Case{-1, 0.5, 10}, Case{-0.3, 1.2, 7}, Case{0.2, 0.9, 8}}) {
    const Values exact = well_actions(c.start, c.end, c.duration, 10);
    for (const int asked : {5, 10}) {
      const std::vector<Solution> found = solve_all(fixed_ends(well, {c.start}, {c.end}, c.duration), asked);
      ASSERT_EQ(static_cast<int>(found.size()), asked);
      ASSERT_GE(exact.size(), found.size());
      for (int k = 0; k < asked; ++k)
        EXPECT_NEAR(found[k].action, exact[k], 1e-5 * (1 + std::abs(exact[k])))
            << c.start << ", " << asked << ": " << k;
      EXPECT_NE(found[0].message.find("others may exist, also between them"), std::string::npos)
          << found[0].message;
    }
  }
}

/// Three particles in a ring with exponential forces: the first of those that 3000 motions of chance, each
/// corrected by shooting, lead to.
TEST(Several, NoneIsMissingBetweenThoseOfTheTodaRing) {
  LONG_TEST();
  const auto toda = trace(3, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 - exp(q[0] - q[1]) - exp(q[1] - q[2]) -
           exp(q[2] - q[0]);
  });
  const Values exact = {-14.908579, -14.891467, -13.949683, -13.244967, -13.176991, -4.788814, -4.672683,
                        -2.670263,  -1.654593,  -0.808701,  1.234080,   2.094573,   3.445402};
  for (const int asked : {5, 13}) {
    const std::vector<Solution> found =
        solve_all(fixed_ends(toda, {0.5, -0.2, -0.3}, {-0.3, 0.4, -0.1}, 5), asked);
    ASSERT_EQ(static_cast<int>(found.size()), asked);
    for (int k = 0; k < asked; ++k) EXPECT_NEAR(found[k].action, exact[k], 2e-6) << asked << ": " << k;
  }
}

/// Away from conjugate ends a linear system has one extremal.
TEST(Several, OfAnOscillatorThereIsOne) {
  const std::vector<Solution> found = solve_all(fixed_ends(systems::oscillator(1), {0}, {1}, 20), 4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].action, std::cos(20) / (2 * std::sin(20)), 1e-8);
  EXPECT_NE(found[0].message.find("1 of up to 4 extremals found"), std::string::npos) << found[0].message;
}

/// q'' = −λ eᑫ between zeros: 2 ln cosh(√(λ e^θ/8)) = θ for the maximum θ of each.
TEST(Several, BothSolutionsOfBratu) {
  for (double lambda : {1e-3, 0.1, 1.0, 2.0, 3.3}) {
    const std::vector<Solution> found = solve_all(fixed_ends(systems::bratu(lambda), {0}, {0}, 1), 5);
    ASSERT_EQ(found.size(), 2u);
    Values grid;
    for (int i = 0; i <= 200; ++i) grid.push_back(1e-4 * std::pow(20 / 1e-4, i / 200.0));
    const Values peaks = roots(grid, [&](double theta) {
      return 2 * std::log(std::cosh(std::sqrt(lambda * std::exp(theta) / 8))) - theta;
    });
    ASSERT_EQ(peaks.size(), 2u);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(at(found[k].trajectory, 0.5).q[0], peaks[k], 1e-7);
  }
}

/// q'' = −q² between zeros, beside rest.
TEST(Several, TheOtherSolutionOfEmden) {
  const auto emden = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 - q[0] * q[0] * q[0] / 3; });
  const std::vector<Solution> found = solve_all(fixed_ends(emden, {0}, {0}, 1), 4);
  ASSERT_EQ(found.size(), 2u);
  // With m the maximum, T = 2 sqrt(3/2) ∫ dq/sqrt(m^3 - q^3) from 0 to m = sqrt(6/m) B(1/3, 1/2)/3.
  const double m = 6 * std::pow(std::beta(1.0 / 3, 0.5) / 3, 2);
  EXPECT_NEAR(at(found[1].trajectory, 0.5).q[0], m, 1e-7);
  EXPECT_NEAR(found[1].momentum_start[0], std::sqrt(2 * m * m * m / 3), 1e-6);
}

TEST(Several, WhereThereIsNone) {
  Solver solver;
  const std::vector<Solution> found =
      solver.solve_all(fixed_ends(systems::bratu(4), {0}, {0}, 1), within(1e-9), 3);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FALSE(found[0].converged());
  EXPECT_TRUE(found[0].trajectory.nodes.empty());
}

TEST(Several, AsManyAsAreWanted) {
  const Problem problem = fixed_ends(systems::pendulum(), {0}, {1}, 20);
  for (int most : {1, 3}) {
    const std::vector<Solution> found = solve_all(problem, most);
    ASSERT_EQ(static_cast<int>(found.size()), most);
    EXPECT_EQ(found[0].message.rfind("converged", 0), 0u);
  }
}

TEST(Several, ChaoticSystems) {
  LONG_TEST();
  EXPECT_EQ(solve_all(ends_of_motion(systems::double_pendulum(), {0, 0}, {1, 2}, 3), 6).size(), 6u);
  EXPECT_EQ(solve_all(ends_of_motion(systems::henon_heiles(), {0.1, 0.2}, {0.4, 0.1}, 10), 6).size(), 6u);
}

/// The times at which a pendulum of energy 1/2 passes 1, from either start.
TEST(Several, FreeDurations) {
  Problem problem = fixed_ends(systems::pendulum(), {0}, {1}, 3);
  problem.duration.free = true;
  problem.duration.energy = 0.5;
  const double k = std::sqrt(0.75), first = std::ellint_1(k, std::asin(std::sin(0.5) / k));
  const double half = 2 * std::ellint_1(k, pi / 2);
  for (const Solution& s : solve_all(make_problem(problem), 5)) {
    const double swings = std::min(std::abs(std::remainder(s.duration() - first, half)),
                                   std::abs(std::remainder(s.duration() + first, half)));
    EXPECT_LT(swings, 1e-8) << s.duration();
  }
}

/// From 0.5 to rest in T = 10: quarter swings and three quarters more, by Landau's quadrature as above.
TEST(Several, NaturalEnds) {
  const Problem problem =
      with_ends(systems::pendulum(), 10, [](BoundaryRelation& r) { r.fix(0, false, 0.5); });
  const std::vector<Solution> found = solve_all(problem, 10);
  Values grid, energies;
  const double least = std::sin(0.25);
  for (int i = 1; i <= 4000; ++i) grid.push_back(1 - (1 - least) * std::exp(-i / 160.0));
  for (int quarters = 1; quarters < 40; quarters += 2)
    for (const double sign : {1.0, -1.0})
      for (double k : roots(grid, [&](double k) {
             return quarters * std::ellint_1(k, pi / 2) + sign * std::ellint_1(k, std::asin(least / k)) - 10;
           }))
        energies.push_back(2 * k * k - 1);
  Values reached;
  for (const Solution& s : found) reached.push_back(s.energy.value());
  std::sort(energies.begin(), energies.end());
  std::sort(reached.begin(), reached.end());
  ASSERT_EQ(reached.size(), energies.size());
  EXPECT_LT(largest_difference(reached, energies), 1e-8);
}

/// Time shifts of one orbit are one solution.
TEST(Several, PeriodicOrbitsCountOnce) {
  Problem problem = closed(systems::henon_heiles(), 6.5);
  problem.duration.free = true;
  problem.duration.energy = 0.08;
  const std::vector<Solution> found =
      solve_all(guessed(problem,
                        [](double t) {
                          return Values{0.3 * std::cos(2 * pi * t), 0.3 * std::sin(2 * pi * t)};
                        }),
                6);
  EXPECT_GE(found.size(), 3u);
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].nullity, 1);
    EXPECT_NEAR(found[k].energy.value(), 0.08, 1e-8);
    for (std::size_t j = 0; j < k; ++j) EXPECT_GT(std::abs(found[k].action - found[j].action), 1e-6);
  }
}

TEST(Several, EquilibriaCountOnce) {
  Solver solver;
  int at_rest = 0;
  const Problem problem = with_ends(systems::pendulum(), 10, [](BoundaryRelation&) {});
  for (const Solution& s : solver.solve_all(problem, within(1e-9), 8))
    at_rest += largest(s.trajectory.nodes) < 1e-6;
  EXPECT_EQ(at_rest, 1);
}

TEST(Several, OnElementsThatAreNamed) {
  const Problem problem = fixed_ends(systems::pendulum(), {0}, {1}, 20);
  Solver solver;
  const std::vector<Solution> exact = solver.solve_all(problem, within(1e-9), 20);
  const std::vector<Solution> found = solver.solve_all(problem, pinned(scheme("midpoint"), 400), 20);
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].trajectory.elements(), 400);
    EXPECT_LT(node_distance(found[k].trajectory, exact[k].trajectory), 10 * found[k].error_estimate);
  }
}

TEST(Several, IsTheSameEachTime) {
  const Problem problem = fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 9);
  Solver used;
  const std::vector<Solution> first = used.solve_all(problem, within(1e-9), 6),
                              again = used.solve_all(problem, within(1e-9), 6);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(first[k].trajectory.nodes, again[k].trajectory.nodes);
    EXPECT_EQ(first[k].strategy, again[k].strategy);
    EXPECT_EQ(first[k].iterations, again[k].iterations);
  }
}

}  // namespace
}  // namespace extremal::laws
