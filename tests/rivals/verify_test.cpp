#include "rivals/verify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "rivals/conditions.hpp"
#include "rivals/problems.hpp"

namespace extremal {
namespace {

using std::numbers::pi;

/// An oscillator that swings from sin(phase) for `duration`, with ends fixed.
struct Swing {
  double duration, phase = 0.3;
  Problem problem = fixed_ends(oscillator(), {std::sin(phase)}, {std::sin(duration + phase)}, duration);

  /// Its path and an error on top.
  template <class Error>
  Trajectory with(Error error) const {
    return sampled(1, 24, duration, [&](double t) { return std::vector{std::sin(t + phase) + error(t)}; });
  }
  Trajectory exact() const {
    return with([](double) { return 0.0; });
  }
};

void expect_verified(const Problem& problem, const Trajectory& trajectory, double tolerance) {
  const Verification found = verify(problem, trajectory, {.tolerance = tolerance});
  EXPECT_TRUE(found.verified) << found.message;
  EXPECT_LT(std::max(found.defect, found.velocity_defect), 10);
  EXPECT_GT(found.pieces, 0);
}

void expect_refuted(const Problem& problem, const Trajectory& trajectory, double tolerance,
                    const std::string& why) {
  const Verification found = verify(problem, trajectory, {.tolerance = tolerance});
  EXPECT_FALSE(found.verified);
  EXPECT_NE(found.message.find(why), std::string::npos) << found.message;
}

TEST(Verify, ExactMotions) {
  const Swing swing{10};
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12})
    expect_verified(swing.problem, swing.exact(), tolerance);
}

TEST(Verify, ReferenceSolutions) {
  for (const double tolerance : {1e-5, 1e-9, 1e-12}) {
    expect_verified(fixed_ends(kepler(), {1, 0}, {-0.6, 0.9}, 2.5),
                    reference_trajectory(*kepler(), "kepler-arc"), tolerance);
    // The mass depends on the configuration.
    expect_verified(fixed_ends(double_pendulum(), {0, 0}, {1, 2}, 1),
                    reference_trajectory(*double_pendulum(), "double-pendulum-1"), tolerance);
  }
}

TEST(Verify, LongChaoticMotion) {
  const Trajectory trajectory = reference_trajectory(*henon_heiles(), "henon-heiles-60");
  const auto n = std::size_t(2);
  const std::vector<double> start(trajectory.nodes.begin(), trajectory.nodes.begin() + n),
      end(trajectory.nodes.end() - n, trajectory.nodes.end());
  const Problem problem = fixed_ends(henon_heiles(), start, end, 60);
  for (const double tolerance : {1e-6, 1e-10, 1e-12}) expect_verified(problem, trajectory, tolerance);
  Trajectory wrong = trajectory;
  for (int k = 0; k < wrong.elements(); ++k)
    for (int j = 0; j <= 12; ++j) {
      const double t = wrong.times[k] + (wrong.times[k + 1] - wrong.times[k]) * lobatto_rule(13).nodes[j];
      wrong.nodes[(k * 13 + j) * 2] += 1e-8 * std::sin(pi * t / 60);
    }
  EXPECT_FALSE(verify(problem, wrong, {.tolerance = 1e-10}).verified);
}

/// A hundred tolerances, of any shape.
TEST(Verify, AnErrorAnywhereIsFound) {
  constexpr double tolerance = 1e-8, size = 2 * 100 * tolerance;
  for (const double duration : {2.0, 10.0, 100.5}) {
    const Swing swing{duration};
    for (const int waves : {1, 2, 5}) {
      expect_refuted(swing.problem,
                     swing.with([&](double t) { return size * std::sin(waves * pi * t / duration); }),
                     tolerance, "tolerances");
    }
    for (const double centre : {0.02, 0.5, 0.97}) {
      const auto bump = [&](double t) {
        const double x = (t / duration - centre) * 24;
        return std::abs(x) < 1 && t > 0 && t < duration ? size * std::pow(1 - x * x, 4) : 0.0;
      };
      expect_refuted(swing.problem, swing.with(bump), tolerance, "tolerances");
    }
    // One node out of place.
    for (const std::size_t node : {1u, 100u, 301u}) {
      Trajectory wrong = swing.exact();
      wrong.nodes[node] += size;
      expect_refuted(swing.problem, wrong, tolerance, "the motion has left it");
    }
  }
}

TEST(Verify, AnotherMotionIsRefutedByItsDistance) {
  // The defect of q'' + q = 0 at frequency 1 + ε is small in each piece; over 10 its end is fixed by hand.
  const Swing swing{10};
  const auto slow = [](double t) { return 1e-6 * t * (10 - t) / 25; };
  const Verification found = verify(swing.problem, swing.with(slow), {.tolerance = 1e-8});
  ASSERT_TRUE(found.distance || !found.verified);
  expect_refuted(swing.problem, swing.with(slow), 1e-8, "tolerances");
}

TEST(Verify, DistanceIsTheError) {
  // Within the tolerance of the defects, so that the distance is computed: largest error over range.
  const Swing swing{10};
  const double size = 2e-8;
  const auto error = [&](double t) { return size * std::sin(pi * t / 10); };
  const Verification found = verify(swing.problem, swing.with(error), {.tolerance = 1e-8, .margin = 1000});
  ASSERT_TRUE(found.distance);
  EXPECT_NEAR(*found.distance, 1, 0.05);
}

TEST(Verify, EndsMustBeMet) {
  const Swing swing{10};
  Problem other = fixed_ends(oscillator(), {std::sin(0.3) + 1e-12}, {std::sin(10.3)}, 10);
  expect_refuted(other, swing.exact(), 1e-6, "condition 1 on the ends is missed by 1e-12");
  other = fixed_ends(oscillator(), {std::sin(0.3)}, {std::sin(10.3)}, 10.1);
  expect_refuted(other, swing.exact(), 1e-6, "it lasts 10 instead of 10.1");
  // Nor does a row that hardly knows the start make it less exact.
  other = swing.problem;
  other.boundary = {.coordinates = 1, .rows = 0, .matrix = {}, .value = {}};
  other.boundary.fix(0, false, std::sin(0.3) + 1e-12);
  const int row = other.boundary.add_row(1e-9 * std::sin(0.3) + std::sin(10.3));
  other.boundary.add(row, 0, 1e-9);
  other.boundary.add(row, 1, 1);
  other.ends = solve_relation(other.boundary);
  expect_refuted(other, swing.exact(), 1e-6, "condition 1 on the ends is missed by 1e-12");
}

/// x(0) = y(0) + 1, y(0) = x(T) + 1, x(T) = y(T) − 1e4: what is left of large numbers is as exact as they.
TEST(Verify, EndsFollowFromOthersInTurn) {
  Problem problem = fixed_ends(kepler(), {1, 0}, {0, 1}, 1);
  problem.boundary = {.coordinates = 2, .rows = 0, .matrix = {}, .value = {}};
  const auto differ = [&](int e, int from, double value) {
    const int row = problem.boundary.add_row(value);
    problem.boundary.add(row, e, 1);
    problem.boundary.add(row, from, -1);
  };
  differ(0, 1, 1);
  differ(1, 2, 1);
  differ(2, 3, -1e4);
  problem.ends = solve_relation(problem.boundary);
  const Eigen::Vector2d start(2.5, 1.5), end(0.5, 1e4 + 0.5), p = Eigen::Vector2d::Zero();
  const EndConditions::Values values = EndConditions(problem).at({start, p, p, end, p}, {});
  for (int row = 0; row < 3; ++row) {
    EXPECT_EQ(values.residual[row], 0) << row;
    EXPECT_GT(values.magnitude[row], 1e4) << row;
  }
}

TEST(Verify, NaturalConditions) {
  // From 1 at rest: the start at 0 alone is fixed, the end free where cos t has its momentum −sin t.
  Problem problem;
  problem.lagrangian = oscillator();
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 1);
  problem.duration.value = 3;
  problem = make_problem(problem);
  const double tangent = std::tan(3.0);
  // q = cos t + tan(T) sin t: q'(T) = 0.
  const auto free_end = [&](double t) { return std::vector{std::cos(t) + tangent * std::sin(t)}; };
  expect_verified(problem, sampled(1, 12, 3, free_end), 1e-9);
  const auto other = [&](double t) { return std::vector{std::cos(t) + (tangent + 1e-5) * std::sin(t)}; };
  expect_refuted(problem, sampled(1, 12, 3, other), 1e-9, "a natural or closing condition");
}

/// The range of the momenta, 1e-9 here, is no measure for what a natural condition may miss.
TEST(Verify, NaturalConditionOfANearlyUniformMotion) {
  Problem problem;
  problem.lagrangian =
      trace(2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2.0 + 1e-9 * q[0]; });
  problem.boundary.coordinates = 2;
  problem.boundary.fix(0, false, 0);
  problem.boundary.fix(1, false, 0);
  problem.boundary.fix(0, true, 1);
  problem.duration.value = 1;
  problem = make_problem(problem);
  const auto with_momentum = [](double p) {
    return sampled(2, 4, 1, [p](double t) { return std::vector{t + 5e-10 * t * (t - 1), p * t}; });
  };
  expect_verified(problem, with_momentum(0), 1e-6);
  expect_verified(problem, with_momentum(5e-9), 1e-6);
  expect_refuted(problem, with_momentum(1e-6), 1e-6, "a natural or closing condition");
}

Problem periodic_oscillator(double energy) {
  Problem problem;
  problem.lagrangian = oscillator();
  problem.boundary.coordinates = 1;
  const int row = problem.boundary.add_row(0);
  problem.boundary.add(row, 0, 1);
  problem.boundary.add(row, 1, -1);
  problem.periodic = true;
  problem.duration = {.value = 6, .free = true, .energy = energy, .where = {}};
  return make_problem(problem);
}

TEST(Verify, PeriodicOrbitOfGivenEnergy) {
  Trajectory circle = sampled(1, 16, 2 * pi, [](double t) { return std::vector{std::sin(t + 0.3)}; });
  circle.nodes.back() = circle.nodes.front();
  expect_verified(periodic_oscillator(0.5), circle, 1e-9);
  expect_refuted(periodic_oscillator(0.5001), circle, 1e-9, "a natural or closing condition");
  // Closed, but with a kick.
  Trajectory kicked = sampled(1, 16, 3, [](double t) { return std::vector{std::cos(t - 1.5)}; });
  kicked.nodes.back() = kicked.nodes.front();
  expect_refuted(periodic_oscillator(0.5), kicked, 1e-9, "a natural or closing condition");
}

TEST(Verify, DurationClosedByWhere) {
  // From 0 to 1 where q(T) = 1 at the first quarter: g = q(T) − 1 with q(T) free, so at rest there.
  Problem problem;
  problem.lagrangian = oscillator();
  problem.boundary.coordinates = 1;
  problem.boundary.fix(0, false, 0);
  problem.duration = {.value = 1.5, .free = true, .energy = {}, .where = [](auto, auto end, auto gradient) {
                        gradient[0] = 0;
                        gradient[1] = 1;
                        return end[0] - 1;
                      }};
  problem = make_problem(problem);
  const auto quarter = [](double size) {
    return sampled(1, 8, pi / 2, [size](double t) { return std::vector{size * std::sin(t)}; });
  };
  expect_verified(problem, quarter(1), 1e-9);
  expect_refuted(problem, quarter(1 + 1e-5), 1e-9, "a natural or closing condition");
}

TEST(Verify, TimeAndVelocityInTheLagrangian) {
  // Damped, L = e^{t/5} (v² − q²)/2.
  const auto damped =
      trace(1, [](auto q, auto v, auto t) { return exp(t / 5.0) * (v[0] * v[0] - q[0] * q[0]) / 2.0; });
  const double omega = std::sqrt(0.99);
  const auto fall = [&](double t) { return std::vector{std::exp(-0.1 * t) * std::cos(omega * t)}; };
  expect_verified(fixed_ends(damped, fall(0), fall(7), 7), sampled(1, 16, 7, fall), 1e-11);
  // A charge in its field, q'' = −2 J q'.
  const auto charge = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2.0 + (q[0] * v[1] - q[1] * v[0]);
  });
  const auto turn = [](double t) { return std::vector{std::cos(2 * t), -std::sin(2 * t)}; };
  expect_verified(fixed_ends(charge, turn(0), turn(1.25), 1.25), sampled(2, 8, 1.25, turn), 1e-11);
  // Relativistic: q = 2 (√(1 + t²/4) − 1).
  const auto rocket = trace(1, [](auto q, auto v, auto) { return q[0] / 2.0 - sqrt(1.0 - v[0] * v[0]); });
  const auto flight = [](double t) { return std::vector{2 * (std::sqrt(1 + t * t / 4) - 1)}; };
  expect_verified(fixed_ends(rocket, flight(0), flight(8), 8), sampled(1, 32, 8, flight), 1e-11);
}

TEST(Verify, NearCollisionEndsSoon) {
  // Head on through the centre: no motion at all, and nothing that hangs.
  const auto through = [](double t) { return std::vector{1 - 2 * t, 1e-9}; };
  const Problem problem = fixed_ends(kepler(), {1, 1e-9}, {-1, 1e-9}, 1);
  const Verification found = verify(problem, sampled(2, 8, 1, through), {.tolerance = 1e-9});
  EXPECT_FALSE(found.verified);
  EXPECT_LE(found.steps, 100000);
}

TEST(Verify, GivenPieces) {
  const Swing swing{10};
  const Verification found =
      verify(swing.problem, swing.exact(), {.tolerance = 1e-9, .ends = {1, 2.5, 5, 10}});
  EXPECT_TRUE(found.verified) << found.message;
  EXPECT_EQ(found.pieces, 4);
}

TEST(Verify, ManyCoordinates) {
  constexpr int n = 50;
  const auto chain = trace(n, [](auto q, auto v, auto) {
    auto sum = v[0] * v[0] - q[0] * q[0] - q[n - 1] * q[n - 1];
    for (int i = 1; i < n; ++i) sum = sum + v[i] * v[i] - (q[i] - q[i - 1]) * (q[i] - q[i - 1]);
    return sum / 2.0;
  });
  const double omega = 2 * std::sin(pi / (2 * (n + 1)));
  const auto mode = [&](double t) {
    std::vector<double> q(n);
    for (int i = 0; i < n; ++i) q[i] = std::sin(pi * (i + 1) / (n + 1)) * std::cos(omega * t);
    return q;
  };
  const Problem problem = fixed_ends(chain, mode(0), mode(20), 20);
  expect_verified(problem, sampled(n, 10, 20, mode), 1e-9);
  const auto wrong = [&](double t) {
    std::vector<double> q = mode(t);
    q[7] += 2e-7 * std::sin(pi * t / 20);
    return q;
  };
  expect_refuted(problem, sampled(n, 10, 20, wrong), 1e-9, "the motion has left it");
}

TEST(Verify, NumbersThatAreNone) {
  const Swing swing{10};
  Trajectory broken = swing.exact();
  broken.nodes[40] = std::numeric_limits<double>::quiet_NaN();
  expect_refuted(swing.problem, broken, 1e-6, "not finite");
  broken = swing.exact();
  broken.times[3] = broken.times[2];
  expect_refuted(swing.problem, broken, 1e-6, "element 3 runs from");
}

TEST(Verify, MalformedIsRefused) {
  const Swing swing{10};
  Trajectory short_one = swing.exact();
  short_one.nodes.pop_back();
  EXPECT_THROW(verify(swing.problem, short_one), std::invalid_argument);
  EXPECT_THROW(verify(swing.problem, swing.exact(), {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW(verify(swing.problem, swing.exact(), {.ends = {5, 3}}), std::invalid_argument);
  EXPECT_THROW(verify(swing.problem, swing.exact(), {.ends = {11}}), std::invalid_argument);
  EXPECT_THROW(verify(fixed_ends(kepler(), {1, 0}, {0, 1}, 1), swing.exact()), std::invalid_argument);
}

}  // namespace
}  // namespace extremal
