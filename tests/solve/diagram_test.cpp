#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "machine/long_test.hpp"
#include "solve/branches.hpp"
#include "solve/scenes.hpp"

/// \file Branches that bifurcate, against closed forms, characteristic values and published orbits.

namespace extremal::laws {
namespace {

using std::numbers::pi;

struct Followed {
  std::vector<BranchPoint> points;
  std::vector<BranchRecord> branches;

  std::vector<BranchPoint> of(int branch) const {
    std::vector<BranchPoint> result;
    for (const BranchPoint& point : points)
      if (point.branch == branch) result.push_back(point);
    return result;
  }
  /// Parameters of the points of one kind on the first branch.
  std::vector<double> values(PointKind kind) const {
    std::vector<double> result;
    for (const BranchPoint& point : points)
      if (point.branch == 0 && point.kind == kind) result.push_back(point.parameter);
    return result;
  }
};

Followed follow_branches(const ProblemFamily& family, double tolerance, int points) {
  Diagram diagram(family, {.solve = within(tolerance), .points = points, .other_branches = true});
  Followed followed;
  while (diagram.advance()) followed.points.push_back(diagram.point());
  followed.branches = diagram.branches();
  return followed;
}

/// However long the step on which it lies: at the fold itself the factors are singular to roundoff. All
/// members are exp(y/2) = cosh θ / cosh θ(1 − 2t), with the energy 8θ² and λ = 8θ²/cosh²θ.
TEST(Diagram, TheFoldOfBratusProblem) {
  LONG_TEST();
  for (const double from : {0.3, 0.8, 1.0, 2.0})
    for (const int points : {60, 90, 120}) {
      const auto problem = [](double lambda) { return fixed_ends(systems::bratu(lambda), {0}, {0}, 1); };
      const Followed found = follow_branches(varied(problem, from, 5), 1e-9, points);
      const std::vector<double> folds = found.values(PointKind::fold);
      ASSERT_EQ(folds.size(), 1u) << from << ", " << points;
      EXPECT_NEAR(folds[0], 3.513830719125162, 1e-8);
      for (const BranchPoint& point : found.points) {
        EXPECT_GT(point.parameter, 0);
        ASSERT_TRUE(point.solution.energy);
        const double energy = *point.solution.energy, theta = std::sqrt(energy / 8);
        const double logarithm =
            std::log(4 * energy) - 2 * (theta + std::log1p(std::exp(-2 * theta)));  // of E / cosh² θ
        // Of numbers far below the distance wanted the energy is known less well.
        const double known = point.parameter > 1e-12 ? 1e-7 : 1e-3;
        EXPECT_NEAR(std::log(point.parameter), logarithm, known * std::max(1.0, theta));
      }
    }
}

/// q'' = −λ sin q with q(0) = q(1) = 0, Euler's buckled rod: m half waves of modulus k have √λ = 2m K(k) and
/// q'(0) = 2k√λ.
TEST(Diagram, BuckledRods) {
  const auto problem = [](double lambda) {
    return fixed_ends(trace(1, [=](auto q, auto v, auto) { return v[0] * v[0] / 2 + lambda * cos(q[0]); }),
                      {0}, {0}, 1);
  };
  const Followed found = follow_branches(varied(problem, 5, 50), 1e-10, 50);
  const std::vector<double> loads = found.values(PointKind::branch);
  ASSERT_EQ(loads.size(), 2u);
  EXPECT_NEAR(loads[0], pi * pi, 1e-8);
  EXPECT_NEAR(loads[1], 4 * pi * pi, 1e-8);
  ASSERT_EQ(found.branches.size(), 5u);
  for (int branch = 1; branch < 5; ++branch) {
    const std::vector<BranchPoint> rods = found.of(branch);
    EXPECT_GT(rods.size(), 4u);
    EXPECT_EQ(found.branches[branch].end, BranchEnd::target) << found.branches[branch].message;
    EXPECT_EQ(rods.back().parameter, 50);
    const int waves = branch < 3 ? 1 : 2;
    for (const BranchPoint& rod : rods) {
      const double slope = start_of(rod).v[0], root = std::sqrt(rod.parameter);
      EXPECT_EQ(slope > 0, start_of(rods.front()).v[0] > 0);
      EXPECT_NEAR(2 * waves * std::comp_ellint_1(slope / (2 * root)), root, 1e-8 * root);
      EXPECT_EQ(rod.solution.morse_index, waves - 1);
    }
  }
  EXPECT_LT(start_of(found.of(1).front()).v[0] * start_of(found.of(2).front()).v[0], 0);
}

/// A pendulum at rest for ever longer times, whose energy closes no equations: swings from the bottom to the
/// bottom in a half period, or two, begin at T = π and 2π. Those of energy E last 2m K(k), k² = (1 + E)/2.
TEST(Diagram, RestOverTheDuration) {
  const Problem rest =
      fixed_ends(trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); }), {0}, {0}, 1);
  const Followed found = follow_branches({rest, Varied::duration, 1, 8}, 1e-10, 40);
  const std::vector<double> branches = found.values(PointKind::branch);
  ASSERT_EQ(branches.size(), 2u);
  EXPECT_NEAR(branches[0], pi, 1e-9);
  EXPECT_NEAR(branches[1], 2 * pi, 1e-9);
  EXPECT_EQ(found.of(0).front().solution.morse_index, 0);
  EXPECT_EQ(found.of(0).back().solution.morse_index, 2);
  ASSERT_EQ(found.branches.size(), 5u);
  for (int branch = 1; branch < 5; ++branch)
    for (const BranchPoint& point : found.of(branch)) {
      const double k = std::sqrt((1 + *point.solution.energy) / 2);
      EXPECT_NEAR(point.solution.duration(), (branch > 2 ? 4 : 2) * std::comp_ellint_1(k), 1e-7);
      EXPECT_NEAR(point.parameter, point.solution.duration(), 1e-12);
    }
}

/// A load across the rod, without a symmetry: branches pass near each other where they crossed, and none
/// meet.
TEST(Diagram, RodsUnderASmallLoadDoNotBranch) {
  LONG_TEST();
  for (const double load : {1e-6, 1e-5, 1e-4, 1e-3}) {
    const auto problem = [load](double lambda) {
      const auto lagrangian = trace(1, [=](auto q, auto v, auto t) {
        return v[0] * v[0] / 2 + lambda * cos(q[0]) + load * cos(t) * q[0];
      });
      return fixed_ends(lagrangian, {0}, {0}, 1);
    };
    const Followed found = follow_branches(varied(problem, 5, 50), 1e-8, 200);
    EXPECT_TRUE(found.values(PointKind::branch).empty()) << load;
    ASSERT_EQ(found.branches.size(), 1u) << load;
    EXPECT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  }
}

/// The lowest characteristic values of q'' + (a − 2θ cos 2t) q = 0 by Fourier series: even or odd ones of the
/// period π, or those that change sign over it (DLMF 28.4).
Values characteristic(bool changing, bool odd, double theta = 1) {
  const int count = 20;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
  for (int k = 0; k < count; ++k) {
    const int frequency = changing ? 2 * k + 1 : odd ? 2 * k + 2 : 2 * k;
    matrix(k, k) = frequency * frequency;
    if (k + 1 < count)
      matrix(k, k + 1) = matrix(k + 1, k) = theta * (!changing && !odd && k == 0 ? std::sqrt(2.0) : 1);
  }
  if (changing) matrix(0, 0) += odd ? -theta : theta;
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
  return Values(values.begin(), values.begin() + 6);
}

/// A spring that stiffens, shaken by 2θ at twice the frequency one.
ProblemFamily shaken_spring(double theta, double from, double to, double period = pi) {
  const auto problem = [=](double a) {
    const auto lagrangian = trace(1, [=](auto q, auto v, auto t) {
      const auto square = q[0] * q[0];
      return v[0] * v[0] / 2 - (a - 2 * theta * cos(2 * t)) * square / 2 - square * square / 4;
    });
    Problem periodic = with_ends(lagrangian, period, [](BoundaryRelation& r) {
      const int row = r.add_row(0);
      r.add(row, 0, -1);
      r.add(row, 1, 1);
    });
    periodic.periodic = true;
    return guessed(std::move(periodic), [](double) { return Values{0}; });
  };
  return varied(problem, from, to);
}

/// From rest, motions of the period π begin at a_0, b_2, a_2, and such of
/// twice the period at b_1, a_1. Rest is stable where none of them is negative.
TEST(Diagram, MathieusEquation) {
  LONG_TEST();
  const Followed found = follow_branches(shaken_spring(1, -1, 5), 1e-10, 40);
  const Values even = characteristic(false, false), odd = characteristic(false, true);
  const std::vector<double> crossings = found.values(PointKind::branch);
  ASSERT_EQ(crossings.size(), 3u);
  EXPECT_NEAR(crossings[0], even[0], 1e-8);
  EXPECT_NEAR(crossings[1], odd[0], 1e-8);
  EXPECT_NEAR(crossings[2], even[1], 1e-8);
  const std::vector<double> doublings = found.values(PointKind::period_doubling);
  ASSERT_EQ(doublings.size(), 2u);
  EXPECT_NEAR(doublings[0], characteristic(true, true)[0], 1e-8);
  EXPECT_NEAR(doublings[1], characteristic(true, false)[0], 1e-8);
  for (const BranchPoint& point : found.of(0)) {
    ASSERT_TRUE(point.solution.floquet);
    const double a = point.parameter;
    if (point.kind != PointKind::regular) continue;
    EXPECT_EQ(point.solution.floquet->stable(),
              (a > even[0] && a < doublings[0]) || (a > doublings[1] && a < odd[0]) || a > even[1])
        << a;
  }
  ASSERT_EQ(found.branches.size(), 9u);
  // In the order of a: a_0 both ways, b_1, a_1, b_2 and a_2 both ways.
  for (const int branch : {3, 4}) {
    const std::vector<BranchPoint> doubled = found.of(branch);
    ASSERT_GT(doubled.size(), 3u);
    for (const BranchPoint& point : doubled) {
      EXPECT_NEAR(point.solution.duration(), 2 * pi, 1e-15);
      for (const double t : {0.0, 0.7}) {
        const double now = at(point.solution.trajectory, t).q[0];
        EXPECT_NEAR(at(point.solution.trajectory, t + pi).q[0], -now, 1e-7);
      }
    }
  }
}

/// The published values at θ = 5 (DLMF 28.4), a_0 and b_1 almost one.
TEST(Diagram, MathieusEquationShakenHard) {
  Diagram diagram(shaken_spring(5, -8, 9), {.solve = within(1e-10), .points = 60});
  Followed found;
  while (diagram.advance()) found.points.push_back(diagram.point());
  const Values crossings = found.values(PointKind::branch),
               doublings = found.values(PointKind::period_doubling);
  const Values even{-5.80004602085, 2.09946044549, 7.44910973953}, changing{-5.79008059864, 1.85818754115};
  ASSERT_EQ(crossings.size(), even.size());
  ASSERT_EQ(doublings.size(), changing.size());
  for (std::size_t k = 0; k < even.size(); ++k) EXPECT_NEAR(crossings[k], even[k], 1e-8);
  for (std::size_t k = 0; k < changing.size(); ++k) EXPECT_NEAR(doublings[k], changing[k], 1e-8);
}

/// Of twice the period all of them cross, and two by two ever nearer to each other: on one step, whose
/// elements suffice for rest, and not for what crosses there.
TEST(Diagram, CrossingsInPairs) {
  LONG_TEST();
  for (const double theta : {1.0, 2.0}) {
    Diagram diagram(shaken_spring(theta, -1, 20, 2 * pi), {.solve = within(1e-9), .points = 200});
    Followed found;
    while (diagram.advance()) found.points.push_back(diagram.point());
    Values expected;
    for (const bool changing : {false, true})
      for (const bool odd : {false, true})
        for (const double a : characteristic(changing, odd, theta))
          if (a > -1 && a < 20) expected.push_back(a);
    std::sort(expected.begin(), expected.end());
    const std::vector<double> crossings = found.values(PointKind::branch);
    ASSERT_EQ(crossings.size(), expected.size()) << theta;
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(crossings[k], expected[k], 1e-7) << theta;
  }
}

/// Shaken ever so little it is unstable for so few a about 1 that both ends of them fall within one step.
TEST(Diagram, TwoDoublingsOnOneStep) {
  LONG_TEST();
  for (const double theta : {0.05, 0.01, 0.001}) {
    const Followed found = follow_branches(shaken_spring(theta, 0.3, 3), 1e-10, 60);
    const std::vector<double> doublings = found.values(PointKind::period_doubling);
    ASSERT_EQ(doublings.size(), 2u) << theta;
    EXPECT_NEAR(doublings[0], characteristic(true, true, theta)[0], 1e-8);
    EXPECT_NEAR(doublings[1], characteristic(true, false, theta)[0], 1e-8);
    for (const BranchPoint& point : found.of(0))
      EXPECT_TRUE(point.kind != PointKind::regular || point.solution.floquet->stable()) << point.parameter;
  }
}

/// Two springs shaken at once, one a little stiffer: on one step a pair of each passes −1.
TEST(Diagram, TwoPairsOnOneStep) {
  LONG_TEST();
  const double theta = 0.2, stiffer = 1.001;
  const auto lagrangian = [=](double a) {
    return trace(2, [=](auto q, auto v, auto t) {
      const auto first = a - 2 * theta * cos(2 * t), second = a * stiffer - 2 * theta * cos(2 * t);
      return (v[0] * v[0] + v[1] * v[1] - first * q[0] * q[0] - second * q[1] * q[1]) / 2;
    });
  };
  const Problem first = guessed(periodic(lagrangian(0.4), pi), [](double) { return Values{0, 0}; });
  const auto problem = [=](double a) {
    Problem at = first;
    at.lagrangian = lagrangian(a);
    return at;
  };
  const Followed found = follow_branches(varied(problem, 0.4, 2), 1e-10, 60);
  std::vector<double> doublings = found.values(PointKind::period_doubling);
  std::sort(doublings.begin(), doublings.end());
  const double b = characteristic(true, true, theta)[0], a = characteristic(true, false, theta)[0];
  const Values expected{b / stiffer, b, a / stiffer, a};
  ASSERT_EQ(doublings.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(doublings[k], expected[k], 1e-8);
}

/// The halo orbits, north and south, where planar ones about L1 of Earth and Moon lose their stability out of
/// the plane; and an orbit of the catalogue on the way.
TEST(Diagram, HaloOrbits) {
  const nlohmann::json orbit = published("cr3bp_periodic_orbits.json", "cr3bp-earth-moon-L1haloN-f1");
  const double period = decimal(orbit["refined"]["period"]), jacobi = decimal(orbit["refined"]["jacobi"]);
  const Study study =
      load(std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/lyapunov-family.toml", {"continuation.to=3"});
  const ProblemFamily& family = study.continuation->family;
  const Followed found = follow_branches(family, 1e-11, 30);
  EXPECT_EQ(found.branches[0].end, BranchEnd::target) << found.branches[0].message;
  ASSERT_EQ(found.branches.size(), 3u);
  double heights[2] = {0, 0};
  for (const int branch : {1, 2}) {
    EXPECT_LE(found.branches[branch].worst_action_slope, 1e-6);
    EXPECT_LE(*found.branches[branch].worst_momentum, 1e-8);
    const std::vector<BranchPoint> halos = found.of(branch);
    // Two of the family share the period; the energy tells them apart.
    const auto distance = [&](const BranchPoint& a) {
      return std::hypot(a.parameter - period, 10 * (2 * *a.solution.energy + jacobi));
    };
    const BranchPoint& nearest = *std::min_element(
        halos.begin(), halos.end(), [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    Problem problem = family.problem;
    problem.guess = {};
    problem.duration.value = period;
    const Trajectory& path = nearest.solution.trajectory;
    const Solution halo =
        solve(guessed(std::move(problem), [&](double tau) { return at(path, tau * path.duration()).q; }),
              within(1e-11));
    // C = −2E in the catalogue's units.
    EXPECT_NEAR(-2 * *halo.energy, jacobi, 1e-9);
    const double largest = std::abs(halo.floquet->multipliers[0]);
    EXPECT_NEAR((largest + 1 / largest) / 2, orbit["stability_index_computed"].get<double>(), 1e-6);
    for (int k = 0; k < 100; ++k) heights[branch - 1] += at(halo.trajectory, k * period / 100).q[2];
  }
  EXPECT_NEAR(heights[0], -heights[1], 1e-6 * std::abs(heights[0]));
  EXPECT_GT(std::abs(heights[0]), 1);
}

/// Vertical orbits from the motion near the libration point to one of the catalogue; where their branch
/// crosses that of the axial orbits a pair of multipliers passes 1.
TEST(Diagram, VerticalOrbits) {
  const nlohmann::json orbit = published("cr3bp_periodic_orbits.json", "cr3bp-earth-moon-vertical-1002");
  ProblemFamily family =
      load(std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/vertical-family.toml").continuation->family;
  family.to = -decimal(orbit["refined"]["jacobi"]) / 2;
  Continuation branch(family, {.solve = within(1e-11), .points = 40});
  BranchPoint last;
  while (branch.advance()) {
    last = branch.point();
    const auto& multipliers = last.solution.floquet->multipliers;
    const auto near_one = [](const std::complex<double>& value) { return std::abs(value - 1.0) < 0.05; };
    if (last.kind == PointKind::branch) {
      EXPECT_EQ(std::count_if(multipliers.begin(), multipliers.end(), near_one), 4);
    } else {
      EXPECT_EQ(last.solution.floquet->trivial_pairs, 1);
    }
  }
  EXPECT_EQ(branch.end(), BranchEnd::target) << branch.message();
  EXPECT_NEAR(last.solution.duration(), decimal(orbit["refined"]["period"]), 1e-8);
  const double largest = std::abs(last.solution.floquet->multipliers[0]);
  EXPECT_NEAR((largest + 1 / largest) / 2 / orbit["stability_index_computed"].get<double>(), 1, 1e-7);
}

}  // namespace
}  // namespace extremal::laws
