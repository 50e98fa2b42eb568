#include <fmt/format.h>

#include <functional>
#include <numbers>

#include "machine/long_test.hpp"
#include "solve/branches.hpp"
#include "system/formula.hpp"

/// \file Extremals that cross kinks of L, against solutions pieced together by hand.

namespace extremal::laws {
namespace {

using std::numbers::pi;

std::shared_ptr<const Lagrangian> written(std::vector<std::string> coordinates, std::string lagrangian) {
  return compile({.coordinates = std::move(coordinates), .lagrangian = std::move(lagrangian)}).lagrangian;
}

/// The least distance of an end of an element from t.
double distance_to_node(const Trajectory& trajectory, double t) {
  double least = INFINITY;
  for (const double node : trajectory.times) least = std::min(least, std::abs(node - t));
  return least;
}

/// The distance is within the tolerance and the estimate within a factor of ten of honest.
void expect_honest(const Solution& s, double distance, double tolerance, double range) {
  EXPECT_LT(distance, tolerance * range);
  EXPECT_LT(distance, 10 * s.error_estimate);
  EXPECT_LT(s.error_estimate, tolerance * range);
}

/// q'' = −sign q: parabolas, from 1 with the velocity −1/2 through 0 at t = 1.
Values falling(double t) {
  const double s = t - 1;
  return {t < 1 ? 1 - t / 2 - t * t / 2 : -1.5 * s + s * s / 2};
}

TEST(Kinks, AbsoluteValueIsCrossedAtANode) {
  const auto lagrangian = written({"x"}, "x'^2/2 - abs(x)");
  for (const double tolerance : {1e-6, 1e-9, 1e-13}) {
    const Solution s = solve(fixed_ends(lagrangian, {1}, {-1}, 2), within(tolerance));
    expect_honest(s, distance(s.trajectory, falling), tolerance, 2);
    EXPECT_NEAR(s.momentum_start[0], -0.5, 10 * tolerance);
    EXPECT_NEAR(s.action, -1.0 / 12, tolerance);
    EXPECT_LT(distance_to_node(s.trajectory, 1), tolerance);
    EXPECT_LT(*s.energy_drift, 1e-12);
    EXPECT_EQ(s.morse_index, 0);
    EXPECT_TRUE(s.conjugate_times.empty());
  }
}

/// The second variation at a crossing is that of 2w δ(u): a Jacobi field has η'' = 0 but for a jump of η' by
/// −2 η/|q'|. That which starts as t has the slope −1 from t = 1 on, and vanishes again at t = 2.
TEST(Kinks, ConjugateTimesCountTheKink) {
  const auto lagrangian = written({"x"}, "x'^2/2 - abs(x)");
  const double T = 2.6;
  const auto truth = [](double t) {
    return Values{t < 1 ? (1 - t * t) / 2 : (1 - t) + (1 - t) * (1 - t) / 2};
  };
  const Problem problem = guessed(fixed_ends(lagrangian, truth(0), truth(T), T), [&](double tau) {
    return Values{truth(T * tau)[0] + 0.02 * std::sin(pi * tau)};
  });
  const Solution s = solve(problem, within(1e-11));
  EXPECT_LT(distance(s.trajectory, truth), 1e-10);
  EXPECT_LT(distance_to_node(s.trajectory, 1), 1e-10);
  EXPECT_EQ(s.morse_index, 1);
  ASSERT_EQ(s.conjugate_times.size(), 1u);
  EXPECT_NEAR(s.conjugate_times[0], 2, 1e-9);
}

/// Between walls that are springs of frequency w, a motion of speed v: half a period π/w in a wall, 1/v
/// across.
class Walls {
 public:
  explicit Walls(double w, double v) : w_(w), v_(v) {}
  double inside() const { return pi / w_; }
  double across() const { return 1 / v_; }
  Values at(double t) const {
    const double turn = 2 * (inside() + across());
    double s = std::fmod(t, turn);  // from the middle, to the right
    if (s < across() / 2) return {0.5 + v_ * s};
    s -= across() / 2;
    if (s < inside()) return {1 + v_ / w_ * std::sin(w_ * s)};
    s -= inside();
    if (s < across()) return {1 - v_ * s};
    s -= across();
    if (s < inside()) return {-v_ / w_ * std::sin(w_ * s)};
    return {v_ * (s - inside())};
  }

 private:
  double w_, v_;
};

TEST(Kinks, BouncesBetweenWalls) {
  const auto lagrangian = written({"x"}, "x'^2/2 - 400*(max(0, -x)^2 + max(0, x - 1)^2)/2");
  const Walls walls(20, 1.3);
  const double T = 3.1;  // three walls
  const auto truth = [&](double t) { return walls.at(t); };
  const Problem problem = guessed(fixed_ends(lagrangian, {0.5}, truth(T), T), [&](double tau) {
    return Values{truth(T * tau)[0] + 0.01 * std::sin(pi * tau)};
  });
  for (const double tolerance : {1e-7, 1e-12}) {
    const Solution s = solve(problem, within(tolerance));
    expect_honest(s, distance(s.trajectory, truth), tolerance, 1.13);
    for (const double t : {walls.across() / 2, walls.across() / 2 + walls.inside()})
      EXPECT_LT(distance_to_node(s.trajectory, t), 10 * tolerance);
    EXPECT_LT(s.trajectory.elements(), 60);
  }
}

/// x'' + x = step(t − 1) − step(t − 5/2).
/// A ball on a hard floor, from a guess that bounces a tenth of a bounce too early.
TEST(Kinks, BouncesMoveInTime) {
  const auto lagrangian = written({"x"}, "x'^2/2 - x - 1000*max(0, -x)^2/2");
  // In the floor x'' = −1 − 1000 x: from (0, −u) to (0, u) in the time `inside`.
  const double w = std::sqrt(1000.0), T = 6;
  const auto path = [&](double up, double t) {
    const double u = std::sqrt(2 + up * up), phase = std::atan2(1 / (w * w), -u / w),
                 inside = (2 * pi - 2 * phase + pi) / w, size = std::hypot(1 / (w * w), u / w);
    double s = t - up - u;
    if (s < 0) return 1 + up * t - t * t / 2;
    s = std::fmod(s, 2 * u + inside);
    if (s < inside) return -1 / (w * w) + size * std::sin(w * s + phase);
    s -= inside;
    return u * s - s * s / 2;
  };
  const auto truth = [&](double t) { return Values{path(0.1, t)}; };
  const Problem problem = guessed(fixed_ends(lagrangian, {1}, truth(T), T),
                                  [&](double tau) { return Values{path(0.09, T * tau)}; });
  const Solution s = solve(problem, within(1e-10));
  EXPECT_LT(distance(s.trajectory, truth), 1e-9);
}

TEST(Kinks, StepsInTimeAreNodes) {
  const auto lagrangian = written({"x"}, "x'^2/2 - x^2/2 + x*(step(t - 1) - step(2*t - 5))");
  const auto push = [](double t) { return t > 0 ? 1 - std::cos(t) : 0; };
  const auto response = [&](double t) { return push(t - 1) - push(t - 2.5); };
  const double T = 4, a = (1 - response(T)) / std::sin(T);
  const auto truth = [&](double t) { return Values{a * std::sin(t) + response(t)}; };
  for (const double tolerance : {1e-8, 1e-13}) {
    const Solution s = solve(fixed_ends(lagrangian, {0}, {1}, T), within(tolerance));
    expect_honest(s, distance(s.trajectory, truth), tolerance, 5);
    for (const double t : {1.0, 2.5}) EXPECT_LT(distance_to_node(s.trajectory, t), 1e-12);
    EXPECT_FALSE(s.energy.has_value());
  }
}

/// L that jumps at t = 1: the mass becomes 4. The momentum is continuous, the velocity is not.
TEST(Kinks, VelocityJumpsWhereTheMassDoes) {
  const auto lagrangian = written({"x"}, "(1 + 3*step(t - 1))*x'^2/2");
  const Solution s = solve(fixed_ends(lagrangian, {0}, {1}, 2), within(1e-11));
  EXPECT_LT(distance(s.trajectory, [](double t) { return Values{t < 1 ? 0.8 * t : 0.8 + 0.2 * (t - 1)}; }),
            1e-11);
  EXPECT_NEAR(s.momentum_end[0], 0.8, 1e-11);
}

/// Two bodies that attract each other with a constant force pass through each other; centre of mass in a
/// well. With r = x − y: r'' = −2 sign r; with c = x + y: c'' = −c.
TEST(Kinks, BodiesPassThroughEachOther) {
  const auto lagrangian = written({"q[2]"}, "(q[1]'^2 + q[2]'^2)/2 - abs(q[1] - q[2]) - (q[1] + q[2])^2/4");
  const double T = 2.7, crossing = 1.2, u = 1.7;  // at the crossing, r' = −u
  const auto r = [&](double t) {
    const double s = t - crossing;
    return -u * s - std::copysign(s * s, -s);
  };
  const auto c = [](double t) { return 0.4 * std::cos(t) - 0.7 * std::sin(t); };
  const auto truth = [&](double t) { return Values{(c(t) + r(t)) / 2, (c(t) - r(t)) / 2}; };
  const Problem problem = guessed(fixed_ends(lagrangian, truth(0), truth(T), T), [&](double tau) {
    const Values q = truth(T * tau);
    return Values{q[0] + 0.03 * std::sin(pi * tau), q[1] - 0.02 * std::sin(2 * pi * tau)};
  });
  const Solution s = solve(problem, within(1e-11));
  EXPECT_LT(distance(s.trajectory, truth), 1e-10);
  EXPECT_LT(distance_to_node(s.trajectory, crossing), 1e-10);
}

TEST(Kinks, PeriodicOrbitOfGivenEnergy) {
  const auto lagrangian = written({"x"}, "x'^2/2 - abs(x)");
  for (const double phase : {0.0, 0.7, pi / 2}) {
    Problem problem = periodic(lagrangian, 6);
    problem.duration = {.value = 6, .free = true, .energy = 1.0, .where = {}};
    problem = guessed(problem, [&](double tau) { return Values{1.1 * std::cos(2 * pi * tau + phase)}; });
    const Solution s = solve(problem, within(1e-11));
    const double T = 4 * std::sqrt(2.0);
    EXPECT_NEAR(s.duration(), T, 1e-9);
    EXPECT_NEAR(s.action, 8 * std::sqrt(2.0) / 3 - T, 1e-9);
    EXPECT_NEAR(*s.energy, 1, 1e-10);
    ASSERT_TRUE(s.floquet.has_value());
    for (const auto& multiplier : s.floquet->multipliers) EXPECT_LT(std::abs(multiplier - 1.0), 1e-6);
    EXPECT_EQ(s.nullity, 1);
  }
}

/// Where the force pushes away from the kink, x'' = sign x, only fast paths cross: −1 → 1 in T < 2√2. Slower
/// ones would stay on the kink for a while, where there is no force to balance.
TEST(Kinks, PathsThatWouldStickAreNotSolutions) {
  LONG_TEST();
  const auto lagrangian = written({"x"}, "x'^2/2 + abs(x)");
  const double T = 2.5;
  const auto truth = [&](double t) {
    const auto half = [&](double s) { return -1 + (2 / T + T / 4) * s - s * s / 2; };
    return Values{t < T / 2 ? half(t) : -half(T - t)};
  };
  const Solution fast = solve(fixed_ends(lagrangian, {-1}, {1}, T), within(1e-10));
  EXPECT_LT(distance(fast.trajectory, truth), 1e-9);
  for (const double slow : {3.0, 4.0, 8.0}) {
    Solver solver;
    const Solution s = solver.solve(fixed_ends(lagrangian, {-1}, {1}, slow), within(1e-9));
    EXPECT_FALSE(s.converged()) << slow;
    EXPECT_FALSE(s.message.empty());
  }
}

/// A parabola whose top touches the wall.
TEST(Kinks, GrazingIsNoCrossing) {
  const auto lagrangian = written({"x"}, "x'^2/2 - x - 100*max(0, x - 1)^2/2");
  const double T = 2 * std::sqrt(2.0);
  Solver solver;
  const Solution s = solver.solve(fixed_ends(lagrangian, {0}, {0}, T), within(1e-9));
  if (s.converged()) {
    EXPECT_LT(distance(s.trajectory, [&](double t) { return Values{t * (T - t) / 2}; }), 1e-8);
  }
}

/// x'' = −x to the right of 0, −(1 + k) x to the left: from x, v at 0 on, arc by arc.
State wall_motion(double k, double x, double v, double T) {
  for (double t = 0;;) {
    const bool right = x > 0 || (x == 0 && v > 0);
    const double w = right ? 1 : std::sqrt(1 + k), phase = std::atan2(v / w, x);
    // x = A cos(w s − phase) vanishes next where w s − phase is an odd multiple of π/2.
    double turn = (right ? pi / 2 : 3 * pi / 2) + phase;
    if (turn <= 1e-9) turn += 2 * pi;
    if (turn > 2 * pi) turn -= 2 * pi;
    const double rest = T - t, s = std::min(rest, turn / w);
    const double cosine = std::cos(w * s), sine = std::sin(w * s);
    const double next = x * cosine + v / w * sine;
    v = v * cosine - w * x * sine;
    x = s < rest ? 0 : next;
    if (s == rest) return {{x}, {v}};
    t += s;
  }
}

/// Between two crossings to the left of 0 lies half a swing, whose ends are conjugate; to rest at T, which
/// varies, after 13 crossings.
TEST(Kinks, FamiliesCrossThemManyTimes) {
  const double k = 4.65, start = 0.84;
  const auto lagrangian = written({"x"}, "x'^2/2 - x^2/2 - 4.65*max(0, -x)^2/2");
  Problem problem = with_ends(lagrangian, 29.2, [&](BoundaryRelation& b) { b.fix(0, false, start); });
  const double v = 0.155;
  problem = guessed(problem, [&](double tau) { return wall_motion(k, start, v, 29.2 * tau).q; });
  Continuation branch({problem, Varied::duration, 29.2, 28.5, {}}, {within(1e-10), 60});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
  for (const BranchPoint& point : points) {
    const State first = start_of(point);
    EXPECT_NEAR(wall_motion(k, start, first.v[0], point.parameter).v[0], 0, 1e-7) << point.parameter;
  }
}

/// x'' = −sign x from 1 to −1: one crossing, which moves along the family.
TEST(Kinks, FamiliesFollowACrossing) {
  const auto lagrangian = written({"x"}, "x'^2/2 - abs(x)");
  Continuation branch({fixed_ends(lagrangian, {1}, {-0.2}, 2), Varied::duration, 2, 3, {}},
                      {within(1e-10), 30});
  const std::vector<BranchPoint> points = follow(branch);
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_LT(points.size(), 20u);
  for (const BranchPoint& point : points) {
    // v²/2 + |x| = E on both sides.
    const double v = start_of(point).v[0], crossing = v + std::sqrt(v * v + 2),
                 rest = point.parameter - crossing;
    const double end = -std::sqrt(v * v + 2) * rest + rest * rest / 2;
    EXPECT_NEAR(end, -0.2, 1e-8) << point.parameter;
  }
}

/// Elements that the user chose stay where they are. The error is that of a kink inside an element, estimated
/// against a path whose elements end there, and the message says it.
TEST(Kinks, PinnedElementsStay) {
  const auto lagrangian = written({"x"}, "x'^2/2 - x^2/2 - 3*max(0, -x)^2/2");
  // x'' = −x, then −4x: sin(π − t) up to t = π − 0.7 …
  const auto truth = [](double t) {
    const double s = t - 1.1;
    return Values{s < 0 ? -std::sin(s) : -std::sin(2 * s) / 2};
  };
  const Problem problem = fixed_ends(lagrangian, truth(0), truth(2), 2);
  for (const int elements : {7, 15}) {
    const Solution s = solve(problem, pinned(lobatto(3), elements));
    const double error = distance(s.trajectory, truth);
    EXPECT_LT(error, 10 * s.error_estimate);
    EXPECT_LT(s.error_estimate, 10 * error);
    EXPECT_NE(s.message.find("inside 1 of its elements"), std::string::npos) << s.message;
    for (int k = 0; k <= elements; ++k) EXPECT_NEAR(s.trajectory.times[k], 2.0 * k / elements, 1e-15);
  }
  const Solution s = solve(problem, within(1e-12));
  EXPECT_LT(distance(s.trajectory, truth), 1e-12);
}

/// Two wells that meet in a cusp, and a path much longer than their windows: no guess leads there. There are
/// three extremals, by shooting with located crossings.
TEST(Kinks, MotionsAreBracketedWhereNoGuessLeads) {
  LONG_TEST();
  const auto wells = written({"x"}, "x'^2/2 - min(1.78*x^2, 2.876*(x - 1)^2 + 0.1)/2");
  const Solution s = solve(fixed_ends(wells, {-0.376}, {-0.153}, 6.74), within(1e-6));
  ASSERT_TRUE(s.converged()) << s.message;
  const Values known{-0.73140, 0.59266, 0.87649};
  EXPECT_TRUE(std::ranges::any_of(known, [&](double v) { return std::abs(s.momentum_start[0] - v) < 1e-5; }))
      << s.momentum_start[0];
}

TEST(Kinks, PathsOnOneSideOfAMomentumJumpAreFound) {
  const auto lagrangian = written({"x"}, "x'^2/2 + 0.2*abs(x') - x^2/2");
  const Solution s = solve(fixed_ends(lagrangian, {0}, {-0.7}, 1.2), within(1e-11));
  const double size = -0.7 / std::sin(1.2);
  EXPECT_LT(distance(s.trajectory, [&](double t) { return Values{size * std::sin(t)}; }), 1e-10);
  EXPECT_NEAR(s.momentum_start[0], size - 0.2, 1e-10);
}

/// p jumps with the sign of a velocity: a path that changes it is no extremal.
TEST(Kinks, PathsAcrossAMomentumJumpAreNone) {
  LONG_TEST();
  const auto refused = [](const Problem& problem, const SolveOptions& options) {
    Solver solver;
    const Solution s = solver.solve(problem, options);
    EXPECT_FALSE(s.converged());
    EXPECT_NE(s.message.find("the momentum jumps by 0.4"), std::string::npos) << s.message;
  };
  for (const char* jump : {"+ 0.2*abs(x')", "- 0.2*abs(x')", "+ 0.4*max(0, x' - 0.1)"}) {
    const auto lagrangian = written({"x"}, std::string("x'^2/2 - x^2/2 ") + jump);
    refused(fixed_ends(lagrangian, {0}, {0.4}, 2.3), within(1e-8));
  }
  refused(fixed_ends(written({"x"}, "x'^2/2 - x^2/2 + 0.4*max(0, x' - 0.1)"), {0}, {0.4}, 2.3),
          pinned(scheme("midpoint"), 24));
  const auto pair = written({"x", "y"}, "(x'^2 + y'^2)/2 + 0.2*abs(x' - y') - x^2/2 - y^2");
  refused(fixed_ends(pair, {0, 0.8}, {0.6, 0.2}, 2), within(1e-8));
}

/// A momentum that is continuous across a kink in the velocity: x'' = −x/2 where x' > 0, else −x.
TEST(Kinks, MomentaWithoutAJumpAreCrossed) {
  const auto lagrangian = written({"x"}, "x'^2/2 + max(0, x')^2/2 - x^2/2");
  const double w = std::sqrt(0.5), turn = pi / 2 / w;
  const auto truth = [&](double t) { return Values{t < turn ? std::sin(w * t) : std::cos(t - turn)}; };
  const double T = turn + 0.6;
  const Problem problem = guessed(fixed_ends(lagrangian, truth(0), truth(T), T), [&](double tau) {
    return Values{truth(T * tau)[0] + 0.01 * std::sin(pi * tau)};
  });
  EXPECT_LT(distance(solve(problem, within(1e-10)).trajectory, truth), 1e-9);
}

/// A driven orbit that begins a little before it crosses a kink, or after, has the multipliers of any other
/// beginning.
TEST(Kinks, MultipliersDoNotDependOnTheBeginning) {
  const double w = 1.7, T = 2 * pi / w;
  const auto driven = [&](double phase) {
    return periodic(
        written({"x"},
                fmt::format("x'^2/2 - x^2/2 - 0.5*max(0, x - 0.3)^2/2 + x*cos({}*t + {:.17g})", w, phase)),
        T);
  };
  const Solution first = solve(
      guessed(driven(0), [](double tau) { return Values{-0.6 * std::cos(2 * pi * tau)}; }), within(1e-11));
  double before = 0, after = T / 2;
  for (int k = 0; k < 60; ++k) {
    const double t = 0.5 * (before + after);
    (at(first.trajectory, t).q[0] < 0.3 ? before : after) = t;
  }
  const auto trace = [](const Solution& s) { return s.floquet->multipliers[0] + s.floquet->multipliers[1]; };
  for (const double early : {1e-2, 1e-4, 3e-6, 1e-7, -1e-4}) {
    const double start = before - early;
    const Problem shifted = guessed(
        driven(w * start), [&](double tau) { return at(first.trajectory, std::fmod(start + tau * T, T)).q; });
    const Solution s = solve(shifted, within(1e-11));
    if (!s.floquet) {
      EXPECT_NE(s.message.find("beside t = 0"), std::string::npos) << s.message;
      EXPECT_LT(std::abs(early), 1e-5);
      continue;
    }
    EXPECT_LT(std::abs(trace(s) - trace(first)), 1e-6) << early;
  }
}

/// The time that x'²/2 + V = E takes from 1 to −1.
double time_of_flight(double energy, const std::function<double(double)>& potential) {
  const int steps = 200000;
  double sum = 0;
  for (int k = 0; k < steps; ++k)
    sum += 2.0 / steps / std::sqrt(2 * (energy - potential(-1 + (k + 0.5) * 2.0 / steps)));
  return sum;
}

TEST(Kinks, PowersOfAKinkAreCrossed) {
  for (const double power : {1.3, 1.5, 2.2, 2.5, 3.5})
    for (const bool both : {true, false}) {
      const std::string text = fmt::format("x'^2/2 - {}^{}", both ? "abs(x)" : "max(0, x)", power);
      const Solution s = solve(fixed_ends(written({"x"}, text), {1}, {-1}, 1.5), within(1e-9));
      const auto potential = [&](double x) { return std::pow(both ? std::abs(x) : std::max(0.0, x), power); };
      EXPECT_NEAR(time_of_flight(*s.energy, potential), 1.5, 1e-8) << text;
      EXPECT_EQ(s.morse_index, 0) << text;
      EXPECT_TRUE(s.conjugate_times.empty()) << text;
    }
}

}  // namespace
}  // namespace extremal::laws
