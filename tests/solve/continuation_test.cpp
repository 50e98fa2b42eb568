#include <cmath>
#include <complex>
#include <numbers>

#include "machine/long_test.hpp"
#include "solve/branches.hpp"

/// \file Families of extremals against closed forms: amplitudes, periods, folds, crossings, closed curves.

namespace extremal::laws {
namespace {

using std::numbers::pi;

/// λ of q'' = −λ e^q, q(0) = q(1) = 0, by the parameter θ of its solution
/// q = −2 log(cosh((t − ½)θ/2) / cosh(θ/4)): λ = (θ²/2) / cosh²(θ/4).
double bratu_lambda(double theta) { return theta * theta / 2 / std::pow(std::cosh(theta / 4), 2); }

/// q'(0) = θ tanh(θ/4), which grows with θ.
double bratu_theta(double slope) {
  double low = 0, high = 60;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (middle * std::tanh(middle / 4) < slope ? low : high) = middle;
  }
  return (low + high) / 2;
}

TEST(Continuation, BratuFoldAndBothBranches) {
  const auto problem = [](double lambda) {
    return fixed_ends(trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 - lambda * exp(q[0]); }),
                      {0}, {0}, 1);
  };
  Continuation branch(varied(problem, 0.5, 4), {within(1e-10), 44});
  const std::vector<BranchPoint> points = follow(branch);
  const std::vector<double> folds = values(points, PointKind::fold);
  ASSERT_EQ(folds.size(), 1u);
  EXPECT_NEAR(folds[0], 3.513830719125162, 1e-8);
  EXPECT_TRUE(values(points, PointKind::branch).empty());
  EXPECT_EQ(branch.end(), BranchEnd::points);
  EXPECT_NE(branch.message().find("has turned at 3.5138307"), std::string::npos) << branch.message();
  for (const BranchPoint& point : points)
    EXPECT_NEAR(bratu_lambda(bratu_theta(start_of(point).v[0])), point.parameter, 1e-8 * point.parameter);
  // Far along the upper branch, where the index is one.
  EXPECT_LT(points.back().parameter, 0.5);
  EXPECT_EQ(points.front().solution.morse_index, 0);
  EXPECT_EQ(points.back().solution.morse_index, 1);
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
}

/// q'' = −q + 0.4 q³ from q(0) = 1 with p(T) = λ, or p(T) = 0.1 over T: dS = p(T) dq(T) − E dT.
TEST(Continuation, MomentaThatAreGiven) {
  const auto problem = [](double duration, double p) {
    const auto lagrangian = trace(1, [](auto q, auto v, auto) {
      return v[0] * v[0] / 2 - q[0] * q[0] / 2 + q[0] * q[0] * q[0] * q[0] / 10;
    });
    return with_ends(lagrangian, duration, [=](BoundaryRelation& b) {
      b.fix(0, false, 1);
      b.give_momentum(0, true, p);
    });
  };
  Continuation momenta(varied([&](double p) { return problem(1, p); }, 0.1, 1), {within(1e-10), 30});
  for (const BranchPoint& point : follow(momenta))
    EXPECT_NEAR(point.solution.momentum_end[0], point.parameter, 1e-9);
  EXPECT_EQ(momenta.end(), BranchEnd::target) << momenta.message();
  EXPECT_LE(momenta.worst_action_slope(), 1e-6);
  Continuation durations({problem(1, 0.1), Varied::duration, 1, 2.5, {}}, {within(1e-10), 60});
  const std::vector<BranchPoint> points = follow(durations);
  ASSERT_GT(points.size(), 3u);
  for (const BranchPoint& point : points) EXPECT_NEAR(point.solution.momentum_end[0], 0.1, 1e-9);
  EXPECT_LE(durations.worst_action_slope(), 1e-6);
}

/// q'' = q³ − εq − λ at rest, with free ends: λ = q³ − εq turns back at q = ∓√(ε/3), by less than a step.
TEST(Continuation, TwoFoldsOnOneStep) {
  const double epsilon = 0.01;
  const auto problem = [=](double lambda) {
    const auto lagrangian = trace(1, [=](auto q, auto v, auto) {
      const auto square = q[0] * q[0];
      return v[0] * v[0] / 2 + square * square / 4 - epsilon * square / 2 - lambda * q[0];
    });
    return guessed(with_ends(lagrangian, 1, [](BoundaryRelation&) {}), [](double) { return Values{-1}; });
  };
  Continuation branch(varied(problem, -0.99, 0.99), {within(1e-10), 60});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  const std::vector<double> folds = values(points, PointKind::fold);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0], 2 * std::pow(epsilon / 3, 1.5), 1e-10);
  EXPECT_NEAR(folds[1], -2 * std::pow(epsilon / 3, 1.5), 1e-10);
  for (const BranchPoint& point : points) {
    const double q = start_of(point).q[0];
    EXPECT_NEAR(q * (q * q - epsilon), point.parameter, 1e-9);
  }
}

TEST(Continuation, BucklingLoads) {
  const auto problem = [](double lambda) {
    return fixed_ends(trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 + lambda * cos(q[0]); }),
                      {0}, {0}, 1);
  };
  Continuation branch(varied(problem, 5, 50), {});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_EQ(points.back().parameter, 50);
  const std::vector<double> loads = values(points, PointKind::branch);
  ASSERT_EQ(loads.size(), 2u);
  EXPECT_NEAR(loads[0], pi * pi, 1e-8);
  EXPECT_NEAR(loads[1], 4 * pi * pi, 1e-8);
  EXPECT_TRUE(values(points, PointKind::fold).empty());
}

/// A load that passes the buckling load π² by little and falls again: between two points the index rises and
/// falls.
TEST(Continuation, TwoBranchPointsOnOneStep) {
  for (const double excess : {1e-2, 1e-3, 1e-4}) {
    const auto problem = [=](double lambda) {
      const double load = pi * pi + excess - lambda * lambda;
      return fixed_ends(trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 + load * cos(q[0]); }),
                        {0}, {0}, 1);
    };
    Continuation branch(varied(problem, -1, 1.1), {within(1e-9), 30});
    const std::vector<double> found = values(follow(branch), PointKind::branch);
    EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
    ASSERT_EQ(found.size(), 2u) << excess;
    EXPECT_NEAR(found[0], -std::sqrt(excess), 1e-7);
    EXPECT_NEAR(found[1], std::sqrt(excess), 1e-7);
  }
}

/// q'' = −ω²q from 0 to 1 in the time 1: q'(0) = ω/sin ω.
TEST(Continuation, OscillatorInItsFrequency) {
  const auto problem = [](double omega) {
    return fixed_ends(
        trace(1, [=](auto q, auto v, auto) { return (v[0] * v[0] - omega * omega * q[0] * q[0]) / 2; }), {0},
        {1}, 1);
  };
  Continuation branch(varied(problem, 0.5, 3), {within(1e-10), 60});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_EQ(points.back().parameter, 3);
  for (const BranchPoint& point : points) {
    const double omega = point.parameter, exact = omega / std::sin(omega);
    EXPECT_NEAR(start_of(point).v[0], exact, 1e-8 * exact);
    // S = q q'/2 at the end.
    EXPECT_NEAR(point.solution.action, omega / std::tan(omega) / 2, 1e-9 * std::abs(exact));
  }
}

/// Ends and the duration may depend on the parameter: a free particle from 0 to p² in the time p.
TEST(Continuation, EndsAndDurationThatVary) {
  const auto free = trace(1, [](auto, auto v, auto) { return v[0] * v[0] / 2; });
  const auto problem = [&](double p) { return fixed_ends(free, {0}, {p * p}, p); };
  Continuation branch(varied(problem, 1, 3), {});
  for (const BranchPoint& point : follow(branch)) {
    EXPECT_NEAR(start_of(point).v[0], point.parameter, 1e-12 * point.parameter);
    EXPECT_NEAR(point.solution.action, std::pow(point.parameter, 3) / 2, 1e-10);
  }
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_LE(branch.worst_action_slope(), 1e-7);
}

std::shared_ptr<const Lagrangian> pendulum() {
  return trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); });
}

/// Of a libration with the energy E: 4 K(k), k² = (E + 1)/2.
double period(double energy) { return 4 * std::comp_ellint_1(std::sqrt((energy + 1) / 2)); }

/// From 0 to 0 in half a period.
TEST(Continuation, PendulumInTheDuration) {
  const Problem problem =
      guessed(fixed_ends(pendulum(), {0}, {0}, 3.3), [](double tau) { return Values{std::sin(pi * tau)}; });
  Continuation branch({problem, Varied::duration, 3.3, 6, {}}, {within(1e-10), 60});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_EQ(points.back().parameter, 6);
  EXPECT_GT(points.size(), 8u);
  for (const BranchPoint& point : points) {
    EXPECT_EQ(point.parameter, point.solution.duration());
    EXPECT_NEAR(period(*point.solution.energy) / 2, point.parameter, 1e-7);
  }
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
}

TEST(Continuation, LibrationsInTheEnergy) {
  Problem problem = with_ends(pendulum(), 6.4, [](BoundaryRelation& r) {
    const int row = r.add_row(0);
    r.add(row, 0, 1);
    r.add(row, 1, -1);
  });
  problem.periodic = true;
  problem.duration = {.value = 6.4, .free = true, .energy = -0.9, .where = {}};
  problem = guessed(std::move(problem), [](double tau) { return Values{0.45 * std::sin(2 * pi * tau)}; });
  Continuation branch({problem, Varied::energy, -0.9, 0.9, {}}, {within(1e-9), 80});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_NEAR(points.back().parameter, 0.9, 1e-12);
  for (const BranchPoint& point : points) {
    EXPECT_NEAR(*point.solution.energy, point.parameter, 1e-7);
    EXPECT_NEAR(point.solution.duration(), period(point.parameter), 1e-7);
    EXPECT_EQ(point.kind, PointKind::regular);
  }
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
}

/// From rest at the angle 1 down to 0, g rising: the time is a quarter period, K(sin ½)/√g.
TEST(Continuation, WhereAConditionClosesTheDuration) {
  const auto problem = [](double g) {
    const auto swing = trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 + g * cos(q[0]); });
    Problem falling = with_ends(swing, 1.6, [](BoundaryRelation& r) { r.fix(0, true, 0); });
    falling.duration.free = true;
    falling.duration.where = [](std::span<const double> start, std::span<const double>,
                                std::span<double> gradient) {
      gradient[0] = 1;
      gradient[1] = 0;
      return start[0] - 1;
    };
    return guessed(std::move(falling), [](double tau) { return Values{std::cos(pi / 2 * tau)}; });
  };
  Continuation branch(varied(problem, 1, 9), {within(1e-10), 40});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_EQ(points.back().parameter, 9);
  for (const BranchPoint& point : points) {
    EXPECT_NEAR(point.solution.duration() * std::sqrt(point.parameter), std::comp_ellint_1(std::sin(0.5)),
                1e-8);
    EXPECT_NEAR(start_of(point).q[0], 1, 1e-12);
  }
  EXPECT_LE(branch.worst_action_slope(), 1e-7);
}

/// Rest at the zeros of V' = q² + p² − 1, with both ends free: a circle in (p, q).
TEST(Continuation, ClosedFamily) {
  const auto problem = [](double p) {
    const auto lagrangian = trace(1, [=](auto q, auto v, auto) {
      return v[0] * v[0] / 2 - q[0] * q[0] * q[0] / 3 - (p * p - 1) * q[0];
    });
    return guessed(with_ends(lagrangian, 1, [](BoundaryRelation&) {}), [](double) { return Values{1}; });
  };
  Continuation branch(varied(problem, 0.1, 2), {within(1e-10), 600});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::closed) << branch.message();
  const std::vector<double> folds = values(points, PointKind::fold);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0], 1, 1e-8);
  EXPECT_NEAR(folds[1], -1, 1e-8);
  for (const BranchPoint& point : points) {
    const double q = start_of(point).q[0], p = point.parameter;
    EXPECT_NEAR(q * q + p * p, 1, 1e-9);
  }
}

/// Librations that shrink: near rest E = −1 + a²/2 and the period is 2π(1 + a²/16).
TEST(Continuation, ShrinksOntoAnEquilibrium) {
  Problem problem = with_ends(pendulum(), 6.4, [](BoundaryRelation& r) {
    const int row = r.add_row(0);
    r.add(row, 0, 1);
    r.add(row, 1, -1);
  });
  problem.periodic = true;
  problem.duration = {.value = 6.4, .free = true, .energy = -0.8, .where = {}};
  problem = guessed(std::move(problem), [](double tau) { return Values{0.6 * std::sin(2 * pi * tau)}; });
  Continuation branch({problem, Varied::energy, -0.8, -1.5, {}}, {within(1e-9), 80});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::rest) << branch.message();
  EXPECT_NE(branch.message().find("shrink onto an equilibrium"), std::string::npos) << branch.message();
  EXPECT_NEAR(points.back().parameter, -1, 1e-5);
  EXPECT_NEAR(points.back().solution.duration(), 2 * pi, 1e-5);
  EXPECT_GE(points.back().parameter, -1);
}

/// The Kepler arc between two places at the distance 1 in the time 1.5, the long way round: where the angle
/// comes to 2π it falls into the centre.
TEST(Continuation, EndsInACollision) {
  LONG_TEST();
  const auto at = [](double angle) {
    return guessed(fixed_ends(trace(2,
                                    [](auto q, auto v, auto) {
                                      return (v[0] * v[0] + v[1] * v[1]) / 2 +
                                             1 / sqrt(q[0] * q[0] + q[1] * q[1]);
                                    }),
                              {1, 0}, {std::cos(angle), std::sin(angle)}, 1.5),
                   [=](double tau) {
                     const double r = 1 - 1.6 * tau * (1 - tau);
                     return Values{r * std::cos(angle * tau), r * std::sin(angle * tau)};
                   });
  };
  Continuation branch(varied(at, 4, 7), {within(1e-6), 400});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::collision) << branch.message();
  EXPECT_GT(points.back().parameter, 5);
  EXPECT_LT(points.back().parameter, 2 * pi);
  // The angular momentum falls all the way, within what the tolerance leaves of velocities: ten times itself
  // of their range.
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double fastest = largest(points[k].solution.trajectory.slopes);
    EXPECT_LT(start_of(points[k]).v[1], start_of(points[k - 1]).v[1] + 1e-5 * std::max(1.0, fastest));
  }
}

/// Every point meets the tolerance: each is solved for anew, ten times as accurately.
TEST(Continuation, PointsMeetTheTolerance) {
  const auto problem = [](double lambda) {
    return fixed_ends(trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 - lambda * exp(q[0]); }),
                      {0}, {0}, 1);
  };
  const double tolerance = 1e-7;
  Continuation branch(varied(problem, 0.5, 4), {within(tolerance), 40});
  for (const BranchPoint& point : follow(branch)) {
    if (point.kind != PointKind::regular) continue;
    const Trajectory& path = point.solution.trajectory;
    const Solution again =
        solve(guessed(problem(point.parameter), [&](double tau) { return at(path, tau).q; }),
              within(0.1 * tolerance));
    double largest = 0, worst = 0;
    for (int k = 0; k <= 100; ++k) {
      const double t = k / 100.0, q = at(again.trajectory, t).q[0];
      largest = std::max(largest, std::abs(q));
      worst = std::max(worst, std::abs(at(path, t).q[0] - q));
    }
    EXPECT_LE(worst, 1.1 * tolerance * largest) << point.parameter;
  }
}

/// Elements of half a period move while their ends hardly do, and near ω T = 9 π the amplitude grows without
/// bound: x = A sin(ω t + φ) over four periods.
TEST(Continuation, ElementsOfHalfAPeriod) {
  const double omega = 0.5668702589175848, first = 0.47716577761206347, last = 0.040722748193568886;
  const auto oscillator =
      trace(1, [=](auto q, auto v, auto) { return (v[0] * v[0] - omega * omega * q[0] * q[0]) / 2; });
  const double tolerance = 1.6e-6;
  const double from = 44.79060741239736, to = 50.71882131675967;
  Continuation branch({fixed_ends(oscillator, {first}, {last}, from), Varied::duration, from, to, {}},
                      {within(tolerance), 40});
  for (const BranchPoint& point : follow(branch)) {
    const double angle = omega * point.parameter;
    const double sine = (last - first * std::cos(angle)) / std::sin(angle);
    for (int k = 0; k <= 40; ++k) {
      const double t = k / 40.0 * point.parameter,
                   exact = first * std::cos(omega * t) + sine * std::sin(omega * t);
      EXPECT_NEAR(at(point.solution.trajectory, t).q[0], exact, tolerance * std::hypot(first, sine)) << angle;
    }
  }
}

/// Where orbits grow while their period hardly does, points are orbits of their own period: distant
/// retrograde orbits of Hill's problem, whose periods tend to 2π.
TEST(Continuation, OrbitsOfTheirOwnPeriod) {
  const auto hill = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + q[0] * v[1] - q[1] * v[0] + 1.5 * q[0] * q[0] +
           1 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
  const Problem first = guessed(periodic(hill, 5.9), [](double tau) {
    return Values{2 * std::cos(2 * pi * tau), -4 * std::sin(2 * pi * tau)};
  });
  const auto farthest = [](const Trajectory& path) {
    double most = 0;
    for (int k = 0; k < 4000; ++k) {
      const Values q = at(path, k / 4000.0 * path.duration()).q;
      most = std::max(most, std::hypot(q[0], q[1]));
    }
    return most;
  };
  const double tolerance = 1e-5;
  Continuation branch({first, Varied::duration, 5.9, 6.5, {}}, {within(tolerance), 16});
  for (const BranchPoint& point : follow(branch)) {
    const Trajectory& path = point.solution.trajectory;
    const Solution again = solve(guessed(periodic(hill, path.duration()),
                                         [&](double tau) { return at(path, tau * path.duration()).q; }),
                                 within(1e-10));
    ASSERT_TRUE(again.converged()) << path.duration();
    EXPECT_NEAR(farthest(path) / farthest(again.trajectory), 1, 3 * tolerance) << path.duration();
  }
}

/// There is no extremal where the parameter is negative.
TEST(Continuation, EndsWhereThereIsNoProblem) {
  const auto at = [](double p) -> std::optional<Problem> {
    if (p <= 0) return std::nullopt;
    return fixed_ends(trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 + p * cos(q[0]); }), {0},
                      {1}, 1);
  };
  Continuation branch({*at(1), Varied::parameter, 1, -1, at}, {});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::limit);
  EXPECT_GT(points.size(), 3u);
  EXPECT_GT(points.back().parameter, 0);
  EXPECT_LT(points.back().parameter, 1e-3);
  EXPECT_NE(branch.message().find("cannot be followed"), std::string::npos) << branch.message();
}

/// Pendula whose energy leads to that of the point of rest above: rotations from above it, librations from
/// below. With one degree of freedom all multipliers are one, and there are no bifurcations.
TEST(Continuation, EndsWhereThePeriodDiverges) {
  struct Case {
    double from, to, duration;
    bool turns;
  };
  for (const auto& [from, to, duration, turns] : {Case{3, 0.5, 2.6, true}, Case{-0.8, 1.2, 6.6, false}}) {
    Problem problem = periodic(pendulum(), duration, turns ? 2 * pi : 0);
    problem.duration = {.value = duration, .free = true, .energy = from, .where = {}};
    problem = guessed(std::move(problem), [turns = turns](double tau) {
      return Values{turns ? 2 * pi * tau : 0.63 * std::sin(2 * pi * tau)};
    });
    Continuation branch({problem, Varied::energy, from, to, {}}, {within(1e-9), 100});
    const std::vector<BranchPoint> points = follow(branch);
    EXPECT_EQ(branch.end(), BranchEnd::infinite_period) << branch.message();
    EXPECT_EQ(branch.message(), "the period diverges at energy 1: a homoclinic or heteroclinic orbit");
    EXPECT_NEAR(points.back().parameter, 1, 1e-6);
    for (const BranchPoint& point : points) {
      EXPECT_EQ(point.kind, PointKind::regular) << point.parameter;
      EXPECT_EQ(point.solution.morse_index, turns ? 0 : 1) << point.parameter;
      ASSERT_TRUE(point.solution.floquet);
      for (const auto& multiplier : point.solution.floquet->multipliers) EXPECT_EQ(multiplier, 1.0);
    }
  }
}

/// x'²/2 − x²/2 + x⁴/4 turns slower with the amplitude; the mass 1/p slows it, so that at the energy 0.2 the
/// period is that of p = 1 over √p: no limit of the period, nothing to end at.
TEST(Continuation, GoesOnWhereThePeriodOnlyGrows) {
  const auto at = [](double p) {
    const auto lagrangian = trace(1, [=](auto q, auto v, auto) {
      const auto square = q[0] * q[0];
      return v[0] * v[0] / (2 * p) - square / 2 + square * square / 4;
    });
    Problem problem = periodic(lagrangian, 8 / std::sqrt(p));
    problem.duration = {.value = 8 / std::sqrt(p), .free = true, .energy = 0.2, .where = {}};
    return guessed(std::move(problem), [](double tau) { return Values{0.72 * std::sin(2 * pi * tau)}; });
  };
  Continuation branch(varied(at, 1, 0.01), {within(1e-9), 80});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  for (const BranchPoint& point : points)
    EXPECT_NEAR(point.solution.duration() * std::sqrt(point.parameter), points.front().solution.duration(),
                1e-6);
}

/// −√(1 − y'²) − y²/2: E = γ + y²/2, so that velocities within 1e-9 tell nothing of the energy where γ is
/// 1000. Those of the points come from momenta.
TEST(Continuation, EnergiesOfARelativisticOscillator) {
  const auto lagrangian =
      trace(1, [](auto q, auto v, auto) { return -sqrt(1 - v[0] * v[0]) - q[0] * q[0] / 2; });
  Problem problem = periodic(lagrangian, 6.6);
  problem.duration = {.value = 6.6, .free = true, .energy = 1.1, .where = {}};
  problem = guessed(std::move(problem), [](double tau) { return Values{0.44 * std::sin(2 * pi * tau)}; });
  Continuation branch({problem, Varied::energy, 1.1, 1000, {}}, {within(1e-9), 80});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  for (const BranchPoint& point : points) {
    EXPECT_NEAR(*point.solution.energy / point.parameter, 1, 1e-7);
    const State start = start_of(point);
    const double gamma = point.parameter - start.q[0] * start.q[0] / 2;
    EXPECT_NEAR(std::abs(start.v[0]), std::sqrt(1 - 1 / (gamma * gamma)), 1e-10) << point.parameter;
  }
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
}

/// Driven springs: without any symmetry the index is odd where det(M − 1) > 0, M the linearised flow, since
/// both change their signs where a multiplier passes 1. It is small where the drive hardly matters.
TEST(Continuation, IndexAgreesWithMultipliers) {
  LONG_TEST();
  struct Case {
    double from, to, drive, linear;
  };
  for (const auto& [from, to, drive, linear] :
       {Case{0.3, 1.5, 0.1, -1}, Case{1, 0.2, 0.3, 1}, Case{0.6, 2, 0.5, -1}}) {
    const auto at = [drive = drive, linear = linear](double frequency) {
      const auto lagrangian = trace(1, [=](auto q, auto v, auto t) {
        const auto square = q[0] * q[0];
        return v[0] * v[0] / 2 + linear * square / 2 - square * square / 4 +
               drive * q[0] * cos(frequency * t);
      });
      return guessed(periodic(lagrangian, 2 * pi / frequency),
                     [](double tau) { return Values{1 + 0.1 * std::cos(2 * pi * tau)}; });
    };
    Continuation branch(varied(at, from, to), {within(1e-9), 120});
    // An eigenvalue that roundoff hides is null, and negative or positive beside.
    std::pair<int, int> before;
    bool event = false, known = false;
    for (const BranchPoint& point : follow(branch)) {
      event = event || point.kind == PointKind::fold || point.kind == PointKind::branch;
      if (point.kind != PointKind::regular || !point.solution.floquet) continue;
      std::complex<double> determinant = 1;
      for (const auto& multiplier : point.solution.floquet->multipliers) determinant *= multiplier - 1.0;
      const std::optional<int> index = point.solution.morse_index;
      if (index) {
        const std::pair now = {*index, *index + point.solution.nullity.value()};
        const bool meets = now.first <= before.second && before.first <= now.second;
        EXPECT_TRUE(event || !known || meets) << point.parameter;
        if (std::abs(determinant) > 1e-9) {
          EXPECT_EQ(*index % 2 == 1, determinant.real() > 0) << point.parameter;
          EXPECT_EQ(point.solution.nullity, 0) << point.parameter;
        }
        before = now;
      }
      known = index.has_value();
      event = false;
    }
  }
}

/// No extremal to begin with: half a period of the oscillator between different ends.
TEST(Continuation, WithoutAFirstPoint) {
  const auto oscillator = trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2; });
  Continuation branch({fixed_ends(oscillator, {0}, {1}, pi), Varied::duration, pi, 4, {}}, {});
  EXPECT_FALSE(branch.advance());
  EXPECT_EQ(branch.end(), BranchEnd::not_started);
  EXPECT_NE(branch.message().find("no extremal to begin with: "), std::string::npos) << branch.message();
}

}  // namespace
}  // namespace extremal::laws
