#include <fmt/format.h>

#include <complex>
#include <numbers>

#include "solve/branches.hpp"
#include "solve/published.hpp"

/// \file Families that begin with the linear motion about a point of rest, followed to published orbits.

namespace extremal::laws {
namespace {

Study family_scene(const std::string& name, const std::vector<std::string>& sets = {}) {
  return load(std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/" + name + ".toml", sets);
}

nlohmann::json orbit_of_earth_and_moon(const std::string& id) {
  return published("cr3bp_periodic_orbits.json", "cr3bp-earth-moon-" + id);
}

double period_of(const nlohmann::json& orbit) { return decimal(orbit["refined"]["period"]); }

/// To the published orbit, where the branch has its duration, or energy.
void expect_led_to(const Study& study, const nlohmann::json& orbit) {
  ProblemFamily family = study.continuation->family;
  family.to = family.varied == Varied::duration ? period_of(orbit) : -decimal(orbit["refined"]["jacobi"]) / 2;
  Continuation branch(family, {.solve = within(1e-11), .points = study.continuation->points});
  const std::vector<BranchPoint> points = follow(branch);
  ASSERT_EQ(branch.end(), BranchEnd::target) << orbit["id"] << ": " << branch.message();
  EXPECT_LT(distance(orbit, points.back().solution), 1e-8) << orbit["id"];
  const double largest = std::abs(points.back().solution.floquet->multipliers[0]);
  EXPECT_NEAR((largest + 1 / largest) / 2 / orbit["stability_index_computed"].get<double>(), 1, 1e-7);
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
  EXPECT_LE(branch.worst_momentum(), 1e-8);
}

TEST(Families, DistantRetrograde) {
  for (const char* id : {"dro-s4", "dro-s2"})
    expect_led_to(family_scene("distant-retrograde-family"), orbit_of_earth_and_moon(id));
}

TEST(Families, LyapunovAboutL1) {
  for (const char* id : {"L1lyap-416", "L1lyap-33"})
    expect_led_to(family_scene("lyapunov-family", {"continuation.points=60"}), orbit_of_earth_and_moon(id));
}

TEST(Families, LyapunovAboutL2) {
  expect_led_to(family_scene("lyapunov-l2-family", {"continuation.points=60"}),
                orbit_of_earth_and_moon("L2lyap-431"));
}

TEST(Families, VerticalAboutL1) {
  for (const char* id : {"vertical-1002", "vertical-57"})
    expect_led_to(family_scene("vertical-family", {"continuation.points=100"}), orbit_of_earth_and_moon(id));
}

/// The problem of another period, guessed by a path: densely, where that is fast.
Problem near_to(const Trajectory& path, Problem problem, double period) {
  problem.guess = {};
  problem.duration.value = period;
  const int each = 40;
  for (int k = 0; k <= each * path.elements(); ++k) {
    const int element = std::min(k / each, path.elements() - 1);
    const double share = static_cast<double>(k - each * element) / each;
    const double t = path.times[element] + share * (path.times[element + 1] - path.times[element]);
    problem.guess.tau.push_back(t / path.duration());
    for (const double q : at(path, t).q) problem.guess.q.push_back(q);
  }
  problem.guess.tau.back() = 1;
  return make_problem(std::move(problem));
}

/// Halo orbits, north and south, begin where Lyapunov orbits lose their stability out of the plane. To the
/// one of a published period, where a branch comes there with its energy.
void expect_halo(const Study& study, const nlohmann::json& orbit) {
  ProblemFamily family = study.continuation->family;
  family.to = period_of(orbit);
  Diagram diagram(family, {.solve = within(1e-11), .points = 60, .other_branches = true});
  double least = INFINITY;
  int sides = 0;
  BranchPoint last;
  const auto finish = [&] {
    if (last.branch != 1 && last.branch != 2) return;
    ++sides;
    least = std::min(least, distance(orbit, last.solution));
  };
  while (diagram.advance()) {
    if (diagram.point().branch != last.branch) finish();
    last = diagram.point();
  }
  finish();
  ASSERT_EQ(sides, 2) << orbit["id"];
  for (const int branch : {1, 2}) {
    EXPECT_EQ(diagram.branches()[branch].end, BranchEnd::target)
        << orbit["id"] << diagram.branches()[branch].message;
    EXPECT_LE(diagram.branches()[branch].worst_action_slope, 1e-8) << orbit["id"];
  }
  EXPECT_LT(least, 1e-8) << orbit["id"];
}

/// Down to near-rectilinear orbits, the last with its pericentre inside the Moon.
TEST(Families, HalosAboutL2) {
  for (const char* id : {"L2halo-999", "L2halo-155", "L2haloS-630", "L2haloS-876", "L2halo-1532"})
    expect_halo(family_scene("halo-family"), orbit_of_earth_and_moon(id));
}

/// About L1 the period goes up and down again: of several orbits of a period the branch meets the published
/// ones next to one of the nearest points.
TEST(Families, HalosAboutL1) {
  const Study study = family_scene("lyapunov-family");
  Diagram diagram(study.continuation->family, {.solve = within(1e-11), .points = 90, .other_branches = true});
  std::vector<BranchPoint> halos[2];
  while (diagram.advance())
    if (const int branch = diagram.point().branch; branch == 1 || branch == 2)
      halos[branch - 1].push_back(diagram.point());
  for (const char* id : {"L1haloN-f1", "L1halo-231"}) {
    const nlohmann::json orbit = orbit_of_earth_and_moon(id);
    const double period = period_of(orbit), energy = -decimal(orbit["refined"]["jacobi"]) / 2;
    double least = INFINITY;
    for (std::vector<BranchPoint>& points : halos) {
      const auto off = [&](const BranchPoint& p) {
        return std::hypot(p.solution.duration() - period, *p.solution.energy - energy);
      };
      const auto nearest = points.begin() + 4;
      std::partial_sort(points.begin(), nearest, points.end(),
                        [&](const BranchPoint& a, const BranchPoint& b) { return off(a) < off(b); });
      for (auto point = points.begin(); point != nearest && least >= 1e-9; ++point) {
        const Problem& problem = study.continuation->family.problem;
        const Solution halo = solve(near_to(point->solution.trajectory, problem, period), within(1e-12));
        if (halo.converged()) least = std::min(least, distance(orbit, halo));
      }
    }
    EXPECT_LT(least, 1e-9) << id;
  }
}

/// The axial orbits lead from the Lyapunov orbits to the vertical ones and back: their period has its extrema
/// where they cross either, which is told once.
TEST(Families, AxialOrbitsJoinTwoFamilies) {
  Continuation vertical(family_scene("vertical-family").continuation->family, {.solve = within(1e-11)});
  double joined = 0;
  while (vertical.advance())
    if (vertical.point().kind == PointKind::branch) joined = vertical.point().solution.duration();
  const Study study = family_scene("lyapunov-family");
  for (const double tolerance : {1e-9, 1e-11}) {
    Diagram diagram(study.continuation->family,
                    {.solve = within(tolerance), .points = 30, .other_branches = true});
    std::vector<double> crossings[5];
    while (diagram.advance()) {
      const BranchPoint& point = diagram.point();
      if (point.kind == PointKind::branch) crossings[point.branch].push_back(point.parameter);
      EXPECT_FALSE(point.branch > 2 && point.kind == PointKind::fold) << point.parameter;
    }
    ASSERT_EQ(diagram.branches().size(), 5u);
    ASSERT_EQ(crossings[0].size(), 2u);
    for (const int axial : {3, 4}) {
      EXPECT_EQ(diagram.branches()[axial].end, BranchEnd::closed);
      ASSERT_EQ(crossings[axial].size(), 2u);
      EXPECT_NEAR(crossings[axial][0], joined, 1e-5);
      // The period is extremal there, so it errs by the square of what the orbit errs by: 1.5e-7 apart.
      EXPECT_NEAR(crossings[axial][1], crossings[0][1], 2e-7);
    }
  }
}

/// Hénon's family a, whose orbit is next to the libration point.
TEST(Families, LyapunovOfHillsProblem) {
  const nlohmann::json orbit = published("other_systems.json", "hill-a-00025");
  ProblemFamily family = family_scene("hill-lyapunov-family").continuation->family;
  family.to = -decimal(orbit["refined"]["energy"]) / 2;
  Continuation branch(family, {.solve = within(1e-11)});
  const std::vector<BranchPoint> points = follow(branch);
  ASSERT_EQ(branch.end(), BranchEnd::target) << branch.message();
  // Beside the point a change of the orbit by 1e-8 changes its energy by 1e-10.
  EXPECT_LT(distance(orbit, points.back().solution), 1e-8);
  EXPECT_NEAR(points.back().solution.floquet->multipliers[0].real(), 2013.60193516, 1e-4);
}

/// y = y₁ + (y₂ − y₁) sn²(ωt | k²) between the two lower roots of 2E − y² + 2y³/3: the period is 2K/ω.
double period_of_line(double energy) {
  const auto root = [&](double low, double high) {
    const auto f = [&](double y) { return 2 * energy - y * y + 2 * y * y * y / 3; };
    for (int k = 0; k < 100; ++k) {
      const double middle = (low + high) / 2;
      (f(low) * f(middle) > 0 ? low : high) = middle;
    }
    return low;
  };
  const double a = root(-1, 0), b = root(0, 1), c = root(1, 2);
  return 2 * std::comp_ellint_1(std::sqrt((b - a) / (c - a))) / std::sqrt((c - a) / 6);
}

/// M. Brack, Found. Phys. 31 (2001) 209: where orbits of the period, or of twice the period, begin.
TEST(Families, StraightOrbitsOfHenonAndHeiles) {
  const Study study = family_scene("henon-heiles-line-family");
  Continuation branch(study.continuation->family,
                      {.solve = within(1e-11), .points = study.continuation->points});
  const std::vector<BranchPoint> points = follow(branch);
  ASSERT_EQ(branch.end(), BranchEnd::target) << branch.message();
  for (const BranchPoint& point : points)
    EXPECT_NEAR(point.solution.duration() / period_of_line(*point.solution.energy), 1, 1e-8);
  const auto published_energy = [](const char* id) {
    return decimal(published("other_systems.json", id)["refined"]["E"]);
  };
  const std::vector<double> doublings = values(points, PointKind::period_doubling),
                            crossings = values(points, PointKind::branch);
  ASSERT_GE(doublings.size(), 1u);
  EXPECT_NEAR(doublings[0], published_energy("hh-bifurcation-e5"), 1e-8);
  ASSERT_GE(crossings.size(), 2u);
  EXPECT_NEAR(crossings[1], published_energy("hh-bifurcation-e7"), 1e-8);
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
  EXPECT_LE(branch.worst_momentum(), 1e-8);
}

/// Pairs of period doublings and of branch points follow each other ever faster towards the escape energy,
/// also between two points of the branch. Periods by shooting: x'' = −(1 + 2y)x integrated beside the
/// straight orbit from its lowest point (scipy 1.10, DOP853, rtol 1e-13), and its trace −2 or 2 solved for by
/// Brent's method.
TEST(Families, PairsOfDoublingsBetweenPoints) {
  const double doubled[] = {11.373631182579159, 12.212370152115128, 14.998491461641953, 15.839654809370632,
                            18.625987677676743, 19.4672322816835,   22.25358288041727,  23.094830106223544},
               crossed[] = {9.571048223713762,  10.398753594791692, 13.185142938601773, 14.025928731053837,
                            16.812204487525676, 17.653436675590015, 20.439784063306107, 21.281030882487677};
  ProblemFamily family = family_scene("henon-heiles-line-family").continuation->family;
  family.to = 0.18;
  for (const int most : {30, 100}) {
    Continuation branch(family, {.solve = within(1e-9), .points = most});
    std::vector<double> doublings, crossings;
    double last = 0;
    for (const BranchPoint& point : follow(branch)) {
      last = point.solution.duration();
      if (last < 9) continue;
      if (point.kind == PointKind::period_doubling) doublings.push_back(last);
      if (point.kind == PointKind::branch) crossings.push_back(last);
    }
    EXPECT_GT(last, 17) << most;
    const auto compare = [&](const std::vector<double>& found, std::span<const double> expected) {
      const auto passed = std::ranges::count_if(expected, [&](double period) { return period < last; });
      ASSERT_GE(std::ssize(found), passed) << most;
      for (std::size_t k = 0; k < std::min(found.size(), expected.size()); ++k)
        EXPECT_NEAR(found[k], expected[k], 1e-5) << most;
    };
    compare(doublings, doubled);
    compare(crossings, crossed);
  }
}

/// Every orbit that begins at one of those points leads on to the energy wanted.
TEST(Families, OrbitsThatBeginAtStraightOnes) {
  const Study study = family_scene("henon-heiles-line-family");
  Diagram diagram(study.continuation->family, {.solve = within(1e-11), .points = 40, .other_branches = true});
  while (diagram.advance()) {
    const BranchPoint& point = diagram.point();
    if (point.branch == 0) continue;
    EXPECT_GT(std::abs(at(point.solution.trajectory, 0.1).q[0]), 1e-4) << point.branch;
  }
  ASSERT_GE(diagram.branches().size(), 10u);
  for (const BranchRecord& record : diagram.branches())
    EXPECT_EQ(record.end, BranchEnd::target) << record.message;
}

/// All three families of R. C. Churchill, G. Pecelli and D. L. Rod begin with small circles, ellipses and
/// lines of the period 2π; members as they were published.
TEST(Families, BentAndRoundOrbitsOfHenonAndHeiles) {
  const std::pair<const char*, const char*> members[] = {{"henon-heiles-curve-family", "hh-E1_12-1"},
                                                         {"henon-heiles-curve-family", "hh-E1_8-1"},
                                                         {"henon-heiles-loop-family", "hh-E1_8-0"}};
  for (const auto& [scene, id] : members) {
    const nlohmann::json orbit = published("other_systems.json", id);
    ProblemFamily family = family_scene(scene).continuation->family;
    family.to = decimal(orbit["refined"]["energy"]);
    Continuation branch(family, {.solve = within(1e-11), .points = 40});
    const std::vector<BranchPoint> points = follow(branch);
    ASSERT_EQ(branch.end(), BranchEnd::target) << id << ": " << branch.message();
    EXPECT_LT(distance(orbit, points.back().solution), 1e-9) << id;
    EXPECT_NEAR(points.front().solution.duration(), 2 * std::numbers::pi, 0.05);
  }
}

/// Of a turn at the energy E, in units of m g l: 2 k K(k) with k² = 2/(E + 1).
TEST(Families, RotationsOfAPendulum) {
  const Study study = family_scene("rotation-family");
  Continuation branch(study.continuation->family,
                      {.solve = within(1e-11), .points = study.continuation->points});
  const std::vector<BranchPoint> points = follow(branch);
  ASSERT_EQ(branch.end(), BranchEnd::target) << branch.message();
  const double g = 9.81;
  for (const BranchPoint& point : points) {
    const double k = std::sqrt(2 / (*point.solution.energy / g + 1));
    EXPECT_NEAR(point.solution.duration() / (2 * k * std::comp_ellint_1(k) / std::sqrt(g)), 1, 1e-8);
    ASSERT_TRUE(point.solution.floquet);
    EXPECT_EQ(point.solution.floquet->trivial_pairs, 1);
  }
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
}

/// arXiv 1903.01195: the halo orbits about L1 begin at a Jacobi constant between 3.1743503 and 3.1743536, and
/// their period doubles first at 3.0216192479264.
TEST(Families, HalosBeginAndDouble) {
  const Study study = family_scene(
      "lyapunov-family", {fmt::format("system.parameters.mu={:.17g}", 0.0123000371 / 1.0123000371)});
  Diagram diagram(study.continuation->family, {.solve = within(1e-11), .points = 25, .other_branches = true});
  std::vector<double> begin, doubled;
  while (diagram.advance()) {
    const BranchPoint& point = diagram.point();
    EXPECT_EQ(point.parameter, point.solution.duration());
    const double jacobi = -2 * *point.solution.energy;
    if (point.branch == 0 && point.kind == PointKind::branch) begin.push_back(jacobi);
    if (point.branch == 1 && point.kind == PointKind::period_doubling) doubled.push_back(jacobi);
    if (point.branch > 1) break;
  }
  ASSERT_FALSE(begin.empty() || doubled.empty());
  EXPECT_GE(begin.front(), 3.1743503);
  EXPECT_LE(begin.front(), 3.1743536);
  EXPECT_NEAR(doubled.front(), 3.0216192479264, 1e-10);
}

/// Each point, of whatever kind, carries the orbit of its own energy.
TEST(Families, EveryPointMeetsItsEquations) {
  for (const char* scene : {"henon-heiles-line-family", "fpu-mode-family", "hill-lyapunov-family"}) {
    const Study study = family_scene(scene);
    Diagram diagram(study.continuation->family,
                    {.solve = within(1e-10), .points = 25, .other_branches = true});
    while (diagram.advance()) {
      const BranchPoint& point = diagram.point();
      const double scale = std::max(1.0, std::abs(point.parameter));
      EXPECT_NEAR(*point.solution.energy, point.parameter, 1e-9 * scale) << scene << ' ' << name(point.kind);
      EXPECT_LE(point.momentum_difference, 1e-7) << scene << ' ' << name(point.kind);
    }
  }
}

/// Positions as complex numbers, about their mean.
std::vector<std::complex<double>> bodies(const Solution& solution, double t) {
  const Values q = at(solution.trajectory, t).q;
  const std::complex<double> mean((q[0] + q[1] + q[2]) / 3, (q[3] + q[4] + q[5]) / 3);
  std::vector<std::complex<double>> z;
  for (int i = 0; i < 3; ++i) z.push_back(std::complex<double>(q[i], q[3 + i]) - mean);
  return z;
}

/// With the force of ½ log r − √3 r²/24 three bodies run on the lemniscate x = sn, y = sn cn, both over
/// 1 + cn², k² = (2 + √3)/4, a third of its period apart (T. Fujiwara, H. Fukuda and H. Ozaki, J. Phys. A 36
/// (2003) 2791). Symmetries of the plane are left open along the branch.
TEST(Families, FigureEightBecomesALemniscate) {
  const Study study = family_scene("choreography-family");
  Continuation branch(study.continuation->family,
                      {.solve = within(1e-11), .points = study.continuation->points});
  const std::vector<BranchPoint> points = follow(branch);
  ASSERT_EQ(branch.end(), BranchEnd::target) << branch.message();
  const Solution& last = points.back().solution;
  // Where |z|⁴ = Re(z² e^{−2iα}), α the angle of its axis, the argument of the mean of z².
  const int samples = 60;
  std::complex<double> squares = 0;
  for (int k = 0; k < samples; ++k)
    for (const std::complex<double>& z : bodies(last, last.duration() * k / samples)) squares += z * z;
  const std::complex<double> turn = std::conj(squares) / std::abs(squares);
  double farthest = 0;
  for (int k = 0; k < samples; ++k)
    for (const std::complex<double>& z : bodies(last, last.duration() * k / samples)) {
      EXPECT_NEAR(std::real(z * z * turn), std::norm(z) * std::norm(z), 1e-8);
      farthest = std::max(farthest, std::norm(z));
    }
  EXPECT_NEAR(farthest, 1, 0.01);
  EXPECT_LE(branch.worst_action_slope(), 1e-6);
  int doubled = 0;
  for (const BranchPoint& point : points) {
    // At −1 two more multipliers meet.
    const bool doubles = point.kind == PointKind::period_doubling;
    doubled += doubles;
    EXPECT_EQ(point.solution.floquet->trivial_pairs, doubles ? 5 : 4);
    EXPECT_GE(point.solution.nullity.value(), 4);
  }
  EXPECT_EQ(doubled, 1);
}

}  // namespace
}  // namespace extremal::laws
