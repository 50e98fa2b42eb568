#include <chrono>
#include <numbers>

#include "machine/long_test.hpp"
#include "problem/closing.hpp"
#include "rivals/verify.hpp"
#include "solve/guess/loop.hpp"
#include "solve/periodic/repetition.hpp"
#include "solve/periodic/segment.hpp"
#include "solve/scenes.hpp"

/// \file Periodic orbits from random loops: each verified by integration, none twice, none that repeats
/// itself; those that are known among them.

namespace extremal::laws {
namespace {

using std::numbers::pi;

std::string list(int n, const std::string& item) {
  std::string text;
  for (int i = 0; i < n; ++i) text += (i ? ", " : "") + item;
  return "[" + text + "]";
}

/// n equal masses, each in the place of the next after T = 2π/n; guessed to be on a circle.
std::string choreography(int n) {
  std::string map;
  for (const char* q : {"x", "y"})
    for (int i = 1; i <= n; ++i) map += fmt::format("\"{0}[{1}]\" = \"{0}[{2}]\"\n", q, i, i % n + 1);
  return fmt::format(
      "[system]\nuse = \"nbody\"\nparameters = {{ n = {0}, m = {1} }}\n[boundary]\nperiodic = true\n"
      "duration = \"2*pi/{0}\"\n[boundary.map]\n{2}[guess]\nx = \"cos(2*pi*(t/T + i - 1)/{0})\"\n"
      "y = \"sin(2*pi*(t/T + i - 1)/{0})\"\n",
      n, list(n, "1.0"), map);
}

const char* three_bodies =
    "[system]\nuse = \"nbody\"\n[boundary]\nperiodic = true\nduration = \"2*pi\"\n[guess]\n"
    "x = \"cos(2*pi*(t/T + (i - 1)/3))\"\ny = \"sin(2*pi*(t/T + (i - 1)/3))\"\n";

const char* henon_heiles_at_an_eighth =
    "[system]\nuse = \"henon-heiles\"\n[boundary]\nperiodic = true\nduration = \"free\"\nenergy = "
    "0.125\n[guess]\n"
    "x = \"0.3*cos(2*pi*t/T)\"\ny = \"0.3*sin(2*pi*t/T)\"\nduration = 6.3\n";

/// All, of which each is an orbit by integration, moves, has its own action and is run through once.
std::vector<Solution> found(const Problem& problem, int most) {
  constexpr double tolerance = 1e-9;
  Solver solver;
  const std::vector<Solution> all = solver.solve_all(problem, within(tolerance), most);
  const ClosingMap map = closing_map(problem);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Solution& s = all[k];
    EXPECT_TRUE(s.converged()) << s.message;
    if (!s.converged()) continue;
    const Verification check = verify(problem, s.trajectory, {.tolerance = tolerance});
    EXPECT_TRUE(check.verified) << s.strategy << ": " << check.message;
    EXPECT_LT(largest_difference(at(s.trajectory, s.duration()).v,
                                 [&] {
                                   const Values v = at(s.trajectory, 0).v;
                                   const Eigen::VectorXd moved =
                                       map.r * Eigen::Map<const Eigen::VectorXd>(v.data(), std::ssize(v));
                                   return Values(moved.begin(), moved.end());
                                 }()),
              1e-6)
        << "not smooth where it closes";
    const int segments = segments_to_close(map);
    const int parts = repetitions(s.trajectory, map, segments, 1e-5);
    EXPECT_GT(parts, 0) << "at rest";
    EXPECT_EQ(segments % std::max(parts, 1), 0) << parts << " times";
    for (std::size_t j = 0; j < k; ++j) EXPECT_GT(std::abs(s.action - all[j].action), 1e-7);
  }
  return all;
}

std::vector<Solution> found(const std::string& scene, int most) {
  return found(study_of(scene).problem, most);
}

/// How near the values of `all` come to one.
double nearest(const std::vector<Solution>& all, double value, double (*of)(const Solution&)) {
  double least = INFINITY;
  for (const Solution& s : all) least = std::min(least, std::abs(of(s) - value));
  return least;
}
double energy(const Solution& s) { return s.energy.value(); }
double action(const Solution& s) { return s.action; }
double duration(const Solution& s) { return s.duration(); }

/// n unit masses on a regular polygon that turns once in nT: with U = c/r and 2K = U, ω²r³ = c/n and S =
/// 3UT/2.
double polygon(int n, double T) {
  double c = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) c += 1 / (2 * std::sin(pi * (i - j) / n));
  const double omega = 2 * pi / (n * T), r = std::cbrt(c / (n * omega * omega));
  return 1.5 * T * c / r;
}

TEST(Loops, FigureEightFromACircle) {
  const std::vector<Solution> all = found(choreography(3), 2);
  EXPECT_EQ(all.size(), 2u);
  const nlohmann::json eight = published("nbody_periodic_orbits.json", "choreo-3-D32-Thefigure-8");
  EXPECT_LT(nearest(all, decimal(eight["refined"]["energy"]), energy), 1e-7);
  EXPECT_LT(nearest(all, polygon(3, 2 * pi / 3), action), 1e-7);
}

TEST(Loops, ChoreographiesOfFourBodies) {
  LONG_TEST();
  const std::vector<Solution> all = found(choreography(4), 4);
  EXPECT_EQ(all.size(), 4u);
  EXPECT_LT(nearest(all, polygon(4, 2 * pi / 4), action), 1e-7);
}

TEST(Loops, ChoreographiesOfFiveBodies) {
  LONG_TEST();
  const std::vector<Solution> all = found(choreography(5), 5);
  EXPECT_EQ(all.size(), 5u);
  EXPECT_LT(nearest(all, polygon(5, 2 * pi / 5), action), 1e-7);
}

TEST(Loops, ThreeBodies) {
  LONG_TEST();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(found(three_bodies, 5).size(), 5u);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 60);
}

/// Straight along x = 0: y'²/2 + y²/2 − y³/3 = E, the period by Gauss-Chebyshev between the turning points.
double straight_period(double energy) {
  // y³/3 − y²/2 + E = (y − a)(y − b)(y − c)/3; with y = 1/2 + cos φ the roots are those of cos 3φ = 1 − 12E.
  const double phi = std::acos(1 - 12 * energy) / 3;
  const double c = 0.5 + std::cos(phi), a = 0.5 + std::cos(phi + 2 * pi / 3),
               b = 0.5 + std::cos(phi - 2 * pi / 3);
  double sum = 0;
  const int points = 2000;
  for (int k = 0; k < points; ++k) {
    const double y = (a + b) / 2 + (b - a) / 2 * std::cos(pi * (k + 0.5) / points);
    sum += pi / points / std::sqrt((c - y) * 2 / 3);
  }
  return 2 * sum;
}

TEST(Loops, ShortFamiliesOfHenonAndHeiles) {
  const std::vector<Solution> all = found(henon_heiles_at_an_eighth, 3);
  EXPECT_EQ(all.size(), 3u);
  for (const char* id : {"hh-E1_8-0", "hh-E1_8-1"})
    EXPECT_LT(nearest(all, decimal(published("other_systems.json", id)["refined"]["period"]), duration), 1e-8)
        << id;
  EXPECT_LT(nearest(all, straight_period(0.125), duration), 1e-8);
}

/// Swings of a pendulum in T = 20 with one, two and three turns, of which those with two and three are
/// shorter orbits; without a guess, too.
TEST(Loops, WhatRepeatsItselfIsLeftOut) {
  for (const Solution& s : found(periodic(systems::pendulum(), 20), 2))
    EXPECT_NEAR(s.minimal_period.value(), 20, 1e-9);
}

/// Noise closes as the problem asks, its slope as well.
TEST(Loops, Close) {
  const double c = std::cos(1.0), s = std::sin(1.0);
  const std::vector<Eigen::MatrixXd> maps = {Eigen::MatrixXd::Identity(3, 3),
                                             Eigen::MatrixXd{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                             Eigen::MatrixXd{{c, -s, 0}, {s, c, 0}, {0, 0, -1}}};
  for (const Eigen::MatrixXd& r : maps) {
    Problem problem = with_ends(trace(3,
                                      [](auto q, auto v, auto) {
                                        return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 -
                                               (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) / 2;
                                      }),
                                2, [&](BoundaryRelation& b) {
                                  for (int a = 0; a < 3; ++a) {
                                    const int row = b.add_row(0);
                                    b.add(row, 3 + a, 1);
                                    for (int k = 0; k < 3; ++k) b.add(row, k, -r(a, k));
                                  }
                                });
    problem.periodic = true;
    ClosedNoise noise(make_problem(problem));
    ASSERT_TRUE(noise.usable());
    for (unsigned seed = 0; seed < 5; ++seed) {
      noise.draw(seed, 4, 1);
      const auto at = [&](double tau) {
        Eigen::VectorXd q(3);
        noise.at(tau, {q.data(), 3});
        return q;
      };
      for (double tau : {0.0, 0.01, 0.3}) EXPECT_LT((at(1 + tau) - r * at(tau)).norm(), 1e-12);
      EXPECT_GT((at(0.5) - at(0.2)).norm(), 1e-3);
    }
  }
}

/// Symmetries are drawn that L has, each once, and of which so many segments make a whole.
TEST(Loops, Symmetries) {
  const Study study = study_of(three_bodies);
  SegmentSource source(study.problem);
  int count = 0;
  for (; const auto segment = source.draw(); ++count) {
    Eigen::MatrixXd power = segment->map.r;
    for (int k = 1; k < segment->parts; ++k) power = segment->map.r * power;
    EXPECT_TRUE(power.isIdentity(1e-12));
    EXPECT_NEAR(segment->problem.duration.value * segment->parts, 2 * pi, 1e-12);
    if (count == 40) break;
  }
  EXPECT_GT(count, 8);
  EXPECT_FALSE(SegmentSource(fixed_ends(systems::pendulum(), {0}, {1}, 2)).draw());
}

/// A guess through collisions is no reason to call ends conjugate.
TEST(Loops, FromSketchesThatCollide) {
  const std::string scene = choreography(4), start = scene.substr(0, scene.find("[guess]"));
  for (const char* guess :
       {"x = \"sin(2*pi*(t/T + i - 1)/4)\"\ny = \"0.4*sin(6*pi*(t/T + i - 1)/4)\"\n",
        "x = \"1.3*sin(2*pi*(t/T + i - 1)/4)\"\ny = \"0.6*sin(4*pi*(t/T + i - 1)/4)\"\n"}) {
    const Study study = study_of(start + "[guess]\n" + guess);
    const Solution s = run(study);
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_TRUE(verify(study.problem, s.trajectory).verified);
  }
}

}  // namespace
}  // namespace extremal::laws
