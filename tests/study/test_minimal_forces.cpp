#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "charts.hpp"
#include "problem/manifold.hpp"
#include "problem/minimal_problem.hpp"
#include "scenes.hpp"
#include "study/continued.hpp"
#include "study/minimal_family.hpp"
#include "system/minimal_lagrangian.hpp"

/// \file Forces in minimal coordinates.

using namespace extremal;
using namespace extremal::test;

namespace {

/// A pendulum with these forces, in Cartesian coordinates and by its angle.
std::string pendulum_in_plane(const std::string& force, const std::string& rest) {
  return "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { k = 0.5 }\n"
         "lagrangian = \"(x'^2 + y'^2)/2 - y\"\nconstraints = [\"x^2 + y^2 = 1\"]\nforce = { " +
         force + " }\n" + rest;
}
std::string pendulum_by_angle(const std::string& force, const std::string& rest) {
  return "[system]\ncoordinates = [\"a\"]\nparameters = { k = 0.5 }\n"
         "lagrangian = \"a'^2/2 + cos(a)\"\nforce = { a = \"" +
         force + "\" }\n" + rest;
}

/// Friction that changes its sign with the height: the limit cycle has a damping of its own.
const std::string limit_cycle =
    pendulum_in_plane("x = \"k*(1 - 6*(1 + y))*x'\", y = \"k*(1 - 6*(1 + y))*y'\"",
                      "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 6.5\n"
                      "x = \"sin(0.9*sin(2*pi*t/T))\"\ny = \"-cos(0.9*sin(2*pi*t/T))\"\n");
const std::string limit_cycle_by_angle =
    pendulum_by_angle("k*(1 - 6*(1 - cos(a)))*a'",
                      "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 6.5\n"
                      "a = \"0.9*sin(2*pi*t/T)\"\n");

/// A chain of rods in air, whose angles go from some to others.
struct DampedChain {
  std::vector<double> start, end;
  double duration = 1, gravity = 1, drag = 0.4;

  std::string scene() const {
    const std::size_t n = start.size();
    std::string constraints = "\"x[1]^2 + y[1]^2 = 1\"";
    for (std::size_t i = 2; i <= n; ++i)
      constraints += fmt::format(", \"(x[{0}] - x[{1}])^2 + (y[{0}] - y[{1}])^2 = 1\"", i, i - 1);
    return fmt::format(
        "[system]\ncoordinates = [\"x[{0}]\", \"y[{0}]\"]\n"
        "lagrangian = \"sum(i, 1, {0}, (x[i]'^2 + y[i]'^2)/2 - {1}*y[i])\"\nconstraints = [{2}]\n"
        "force = {{ x = \"-{3}*x[i]'\", y = \"-{3}*y[i]'\" }}\n[boundary]\nstart = {4}\nend = {5}\n"
        "duration = {6}\n",
        n, gravity, constraints, drag, places(start), places(end), duration);
  }

  std::string by_angles(const std::string& boundary) const {
    const std::size_t n = start.size();
    std::string kinetic, potential, force;
    for (std::size_t i = 1; i <= n; ++i) {
      potential += fmt::format(" + {}*cos(a[{}])", gravity * static_cast<double>(n + 1 - i), i);
      force += fmt::format("{}\"-{}*(", i > 1 ? ", " : "", drag);
      for (std::size_t j = 1; j <= n; ++j) {
        const std::string momentum =
            fmt::format(" + {}*cos(a[{}] - a[{}])*a[{}]'", n + 1 - std::max(i, j), i, j, j);
        force += momentum;
        kinetic += momentum + fmt::format("*a[{}]'/2", i);
      }
      force += ")\"";
    }
    return fmt::format(
        "[system]\ncoordinates = [\"a[{}]\"]\nlagrangian = \"{}\"\nforce = {{ a = [{}] }}\n[boundary]\n"
        "start = {{ a = [{:.17g}]{} }}\nduration = {}\n",
        n, kinetic + potential, force, fmt::join(start, ", "), boundary, duration);
  }
  std::string between_angles() const {
    return by_angles(fmt::format(" }}\nend = {{ a = [{:.17g}]", fmt::join(end, ", ")));
  }
  /// The momenta of the angles where the masses have these momenta.
  std::string from_motion(const std::vector<double>& p) const {
    const std::size_t n = start.size();
    std::vector<double> of_angles(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i; j < n; ++j)
        of_angles[i] += std::cos(start[i]) * p[j] + std::sin(start[i]) * p[n + j];
    return by_angles(fmt::format(", p_a = [{:.17g}]", fmt::join(of_angles, ", ")));
  }

  static std::string places(const std::vector<double>& angles) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      x.push_back((i ? x.back() : 0) + std::sin(angles[i]));
      y.push_back((i ? y.back() : 0) - std::cos(angles[i]));
    }
    return fmt::format("{{ x = [{:.17g}], y = [{:.17g}] }}", fmt::join(x, ", "), fmt::join(y, ", "));
  }
};

/// Of a Cartesian pendulum and its angle: places, momenta along the circle and the force of the rod, λ = (y −
/// a'²)/2 for forces across it.
void expect_same_swing(const Study& s, const Solution& found, const Solution& angle) {
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  EXPECT_EQ(found.unknowns, angle.unknowns);
  EXPECT_NEAR(found.duration(), angle.duration(), 1e-9);
  EXPECT_NEAR(*found.work, *angle.work, 1e-10);
  std::vector<double> q(2), v(2), a(1), rate(1);
  for (const double tau : {0.0, 0.21, 0.5, 0.83, 1.0}) {
    const double t = tau * found.duration();
    found.trajectory.at(t, q, v);
    angle.trajectory.at(tau * angle.duration(), a, rate);
    EXPECT_NEAR(q[0], std::sin(a[0]), 1e-8);
    EXPECT_NEAR(q[1], -std::cos(a[0]), 1e-8);
    EXPECT_NEAR(q[0] * v[1] - q[1] * v[0], rate[0], 1e-7);
    EXPECT_NEAR(s.problem.manifold->multipliers(q, t, v)[0], (q[1] - rate[0] * rate[0]) / 2, 1e-7);
  }
}

}  // namespace

TEST_F(Scenes, DragOfAPendulumInAChart) {
  const Study s = study(pendulum_in_plane("x = \"-k*x' + 0.2*t\", y = \"-k*y'\"",
                                          "[boundary]\nstart = { x = \"sin(0.4)\", y = \"-cos(0.4)\" }\n"
                                          "end = { x = \"sin(1.9)\", y = \"-cos(1.9)\" }\nduration = 2.5\n"));
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s);
  const Solution angle = run(study(pendulum_by_angle(
      "-k*a' + 0.2*t*cos(a)", "[boundary]\nstart = { a = 0.4 }\nend = { a = 1.9 }\nduration = 2.5\n")));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  EXPECT_EQ(found.unknowns, angle.unknowns);
  EXPECT_NEAR(*found.energy, *angle.energy, 1e-9);
  EXPECT_FALSE(found.morse_index || found.energy_drift);
  EXPECT_NEAR(found.action, angle.action, 1e-11);
  EXPECT_NEAR(*found.work, *angle.work, 1e-11);
  std::vector<double> q(2), v(2), a(1), rate(1);
  for (const double t : {0.0, 0.7, 1.9, 2.5}) {
    found.trajectory.at(t, q, v);
    angle.trajectory.at(t, a, rate);
    EXPECT_NEAR(q[0], std::sin(a[0]), 1e-10);
    EXPECT_NEAR(q[1], -std::cos(a[0]), 1e-10);
    // q · (q'' = −2λ q … ): −a'² = −y + 0.2 t x + 2λ.
    EXPECT_NEAR(s.problem.manifold->multipliers(q, t, v)[0], (q[1] - 0.2 * t * q[0] - rate[0] * rate[0]) / 2,
                1e-8);
  }
  for (const auto& [p, of_angle, at] : {std::tuple(found.momentum_start, angle.momentum_start, 0.0),
                                        std::tuple(found.momentum_end, angle.momentum_end, 2.5)}) {
    found.trajectory.at(at, q, v);
    EXPECT_NEAR(q[0] * p[1] - q[1] * p[0], of_angle[0], 1e-9);
    EXPECT_NEAR(q[0] * p[0] + q[1] * p[1], 0, 1e-9);
  }
}

/// Also where the copies differ, as where symmetries are looked for.
TEST_F(Scenes, DerivativesOfForcesInMinimalCoordinates) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\", \"u\", \"s\"]\n"
      "lagrangian = \"(1.3*x'^2 + y'^2 + u'^2 + 2*s'^2 + x'*u')/2 - y + cos(u)*x - s*u'\"\n"
      "constraints = [\"(x - 0.2*sin(t))^2 + y^2 = 1\", \"s + 0.3*sin(s) = x + u^2/5\"]\n"
      "force = { x = \"-0.3*y*x'^2 + t*s\", y = \"-0.2*y' + x\", u = \"s'*x'\", s = \"-s'^3 + u*y\" }\n"
      "[boundary]\nstart = { x = 0, y = -1, u = 0.3 }\nend = { x = 0.5, u = -0.4 }\nduration = 0.8\n"
      "[guess]\nx = \"0.5*t/T\"\ny = \"-1 + 0.2*t/T\"\nu = \"0.3 - 0.7*t/T\"\ns = \"0.4*t/T\"\n");
  ASSERT_TRUE(minimal(s));
  const Lagrangian& copies = *minimal(s)->problem.copies;
  ASSERT_EQ(copies.structure().coordinates, 4);
  EXPECT_FALSE(copies.structure().autonomous);
  Scratch scratch;
  const double t = 0.37, h = 1e-5;
  const auto values = [&](const std::vector<double>& z) {
    return evaluate_at(copies, {z.data(), 4}, {z.data() + 4, 4}, t, Order::hessian, scratch);
  };
  const std::vector<double> same{0.21, 0.13, 0.21, 0.13, 0.6, -0.8, 0.6, -0.8};
  const std::vector<double> apart{0.21, 0.13, 0.31, 0.11, 0.6, -0.8, 0.1, -0.4};
  for (const std::vector<double>& at : {same, apart}) {
    const PointValues here = values(at);
    for (int j = 0; j < 8; ++j) {
      std::vector<double> before = at, after = at;
      before[j] -= h;
      after[j] += h;
      const PointValues low = values(before), high = values(after);
      const auto slope = [&](double a, double b) { return (b - a) / (2 * h); };
      EXPECT_NEAR(j < 4 ? here.dq[j] : here.dv[j - 4], slope(low.value, high.value), 1e-8);
      if (at == apart) continue;
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(j < 4 ? here.vq[k * 4 + j] : here.vv[k * 4 + j - 4], slope(low.dv[k], high.dv[k]), 1e-7);
        EXPECT_NEAR(j < 4 ? here.qq[k * 4 + j] : here.vq[(j - 4) * 4 + k], slope(low.dq[k], high.dq[k]),
                    1e-7);
      }
    }
  }
  // The power of the forces is that of their covector.
  const PointValues pair = values(same), one = evaluate_at(*minimal(s)->lagrangian, {same.data(), 2},
                                                           {same.data() + 4, 2}, t, Order::gradient, scratch);
  const auto point = minimal(s)->lagrangian->lift({same.data(), 2}, {same.data() + 4, 2}, {&t, 1});
  // Virtual displacements leave out what the constraints do by their motion in time.
  const auto later = [&](int j) {
    std::vector<double> u{same[0], same[1]}, back = u;
    u[j] += h;
    back[j] -= h;
    const auto a = minimal(s)->lagrangian->lift(back, {}, {&t, 1}),
               b = minimal(s)->lagrangian->lift(u, {}, {&t, 1});
    std::vector<double> by(4);
    for (int k = 0; k < 4; ++k) by[k] = (b.q[k] - a.q[k]) / (2 * h);
    return by;
  };
  const auto covector_at = [](const auto& q, const auto& v, double t) {
    return std::array{-0.3 * q[1] * v[0] * v[0] + t * q[3], -0.2 * v[1] + q[0], v[3] * v[0],
                      -v[3] * v[3] * v[3] + q[2] * q[1]};
  };
  const auto power = [&](const auto& q, const auto& v, double t) {
    const auto force = covector_at(q, v, t);
    return force[0] * v[0] + force[1] * v[1] + force[2] * v[2] + force[3] * v[3];
  };
  const auto force = covector_at(point.q, point.v, t);
  for (int j = 0; j < 2; ++j) {
    const std::vector<double> by = later(j);
    double covector = 0;
    for (int k = 0; k < 4; ++k) covector += force[k] * by[k];
    EXPECT_NEAR(pair.dq[j] - one.dq[j], covector, 1e-8);
  }
  const Solution found = run(s), whole = in_all_coordinates(s);
  ASSERT_TRUE(found.converged() && whole.converged()) << found.message << whole.message;
  EXPECT_NEAR(found.action, whole.action, 1e-10);
  double work = 0;  // by Simpson's rule
  constexpr int parts = 400;
  for (int k = 0; k <= parts; ++k) {
    std::vector<double> there(4), rate(4);
    found.trajectory.at(0.8 * k / parts, there, rate);
    work += power(there, rate, 0.8 * k / parts) * 0.8 / parts / 3 * (k % parts == 0 ? 1 : k % 2 ? 4 : 2);
  }
  EXPECT_NEAR(*found.work, work, 1e-9);
  EXPECT_NEAR(*whole.work, work, 1e-9);
}

/// The multiplier beside that of the shift is exp ∫ ∂Q/∂a' dt.
TEST_F(Scenes, LimitCyclesOfAPendulumInAChart) {
  const Study s = study(limit_cycle);
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s), angle = run(study(limit_cycle_by_angle));
  expect_same_swing(s, found, angle);
  EXPECT_NEAR(*found.work, 0, 1e-10);
  ASSERT_TRUE(found.floquet);
  ASSERT_EQ(found.floquet->multipliers.size(), 2u);
  constexpr int samples = 400;  // of a periodic function
  double damping = 0;
  std::vector<double> q(2), v(2);
  for (int k = 0; k < samples; ++k) {
    found.trajectory.at(k * found.duration() / samples, q, v);
    damping += found.duration() / samples * 0.5 * (1 - 6 * (1 + q[1]));
  }
  EXPECT_NEAR(found.floquet->multipliers[0].real(), 1, 1e-8);
  EXPECT_NEAR(found.floquet->multipliers[1].real(), std::exp(damping), 1e-8);
}

TEST_F(Scenes, FamiliesOfLimitCyclesInAChart) {
  LONG_TEST();
  const std::string along = "[continuation]\nparameter = \"k\"\nto = 1.5\n";
  const FollowedBranch found = follow(study(limit_cycle + along)),
                       angle = follow(study(limit_cycle_by_angle + along));
  ASSERT_EQ(found.branches.front().end, BranchEnd::target);
  ASSERT_EQ(angle.branches.front().end, BranchEnd::target);
  const Solution &last = found.points.back().solution, &of_angle = angle.points.back().solution;
  EXPECT_NEAR(last.duration(), of_angle.duration(), 1e-8);
  EXPECT_EQ(last.trajectory.coordinates, 2);
  for (const BranchPoint& point : found.points) {
    std::vector<double> q(2), v(2);
    point.solution.trajectory.at(0.3, q, v);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1], 1, 1e-8);
    EXPECT_NEAR(*point.solution.work, 0, 1e-8);
  }
}

/// Of a rod whose pivot is driven: in all coordinates, in a chart, and by the angle.
TEST_F(Scenes, FamiliesOfADrivenPivotHaveTheMultipliersOfTheAngle) {
  LONG_TEST();
  const std::string rest =
      "[boundary]\nperiodic = true\nduration = \"2*pi/w\"\n[continuation]\nparameter = \"w\"\nto = 0.9\n"
      "[guess]\n";
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { w = 0.6 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - y\"\nconstraints = [\"(x - 0.06*sin(w*t))^2 + y^2 = 1\"]\n"
      "force = { x = \"-0.08*(x' - 0.06*w*cos(w*t))\", y = \"-0.08*y'\" }\n" +
      rest + "x = \"0.1*sin(w*t)\"\ny = -0.995\n");
  const FollowedBranch angle = follow(
      study("[system]\ncoordinates = [\"a\"]\nparameters = { w = 0.6 }\n"
            "lagrangian = \"a'^2/2 + 0.06*w*cos(w*t)*cos(a)*a' + cos(a)\"\nforce = { a = \"-0.08*a'\" }\n" +
            rest + "a = \"0.04*sin(w*t)\"\n"));
  ASSERT_EQ(angle.branches.front().end, BranchEnd::target);
  const Solution& expected = angle.points.back().solution;
  std::vector<double> q(2), v(2), a(1), turn(1);
  expected.trajectory.at(0, a, turn);
  const auto compare = [&](double parameter, const Solution& last) {
    EXPECT_NEAR(parameter, 0.9, 1e-12);
    ASSERT_TRUE(last.floquet);
    ASSERT_EQ(last.floquet->multipliers.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(std::abs(last.floquet->multipliers[k] - expected.floquet->multipliers[k]), 0, 1e-7);
    last.trajectory.at(0, q, v);
    EXPECT_NEAR(q[0], std::sin(a[0]), 1e-8);
    EXPECT_NEAR(v[0], 0.06 * 0.9 + std::cos(a[0]) * turn[0], 1e-7);
    EXPECT_NEAR(last.momentum_start[0], v[0], 1e-7);
  };
  const std::optional<FollowedBranch> in_chart = follow_in_minimal_coordinates(s, s.options);
  ASSERT_TRUE(in_chart);
  compare(in_chart->points.back().parameter, in_chart->points.back().solution);
  Diagram whole(s.continuation->family, {s.options, s.continuation->points, false});
  BranchPoint last;
  while (whole.advance()) {
    last = whole.point();
    ASSERT_EQ(last.solution.floquet->multipliers.size(), 2u);
  }
  compare(last.parameter, last.solution);
}

/// The momenta of a bead that rests in a turning hoop vanish along the hoop.
TEST_F(Scenes, ABeadThatRestsInATurningHoop) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - z\"\n"
                "constraints = [\"x^2 + y^2 + z^2 = 1\", \"x*sin(1.5*t) - y*cos(1.5*t) = 0\"]\n[boundary]\n"
                "periodic = true\nduration = \"2*pi/1.5\"\n[guess]\nx = \"0.9*cos(1.5*t)\"\n"
                "y = \"0.9*sin(1.5*t)\"\nz = -0.44\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  std::vector<double> q(3), v(3);
  found.trajectory.at(1, q, v);
  EXPECT_NEAR(q[2], -1 / 2.25, 1e-9);
  // Beside rest the bead swings with Ω² = ω² − 1/ω².
  ASSERT_TRUE(found.floquet);
  ASSERT_EQ(found.floquet->multipliers.size(), 2u);
  EXPECT_NEAR(found.floquet->multipliers[0].real(), std::cos(std::sqrt(2.25 - 1 / 2.25) * found.duration()),
              1e-8);
}

TEST_F(Scenes, TurnsOfADrivenRotorInAChart) {
  const Study s =
      study(pendulum_in_plane("x = \"-y*(1.6 - k*(x*y' - y*x'))\", y = \"x*(1.6 - k*(x*y' - y*x'))\"",
                              "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 2\n"
                              "x = \"sin(2*pi*t/T)\"\ny = \"-cos(2*pi*t/T)\"\n"));
  const Solution found = run(s);
  const Solution angle = run(study(pendulum_by_angle(
      "1.6 - k*a'",
      "[boundary]\nperiodic = true\nduration = \"free\"\nmap = { a = \"a + 2*pi\" }\n[guess]\nduration = 2\n"
      "a = \"2*pi*t/T\"\n")));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  ASSERT_TRUE(minimal(s));
  EXPECT_LT(found.unknowns, 2 * angle.unknowns);
  EXPECT_NEAR(found.duration(), angle.duration(), 1e-9);
  EXPECT_NEAR(*found.work, *angle.work, 1e-9);
  ASSERT_TRUE(found.floquet && angle.floquet);
  EXPECT_NEAR(std::abs(found.floquet->multipliers[1] - angle.floquet->multipliers[1]), 0, 1e-8);
}

/// The saddle's separatrix closes at this torque, by shooting along it from both of its ends. Near it
/// roundoff moves the turns by more than the tolerance.
TEST_F(Scenes, FamiliesOfTurnsInAChartUntilTheirPeriodDiverges) {
  constexpr double closing = 0.5973832003;
  const Study s =
      study(pendulum_in_plane(
                "x = \"-y*(k - 0.5*(x*y' - y*x'))\", y = \"x*(k - 0.5*(x*y' - y*x'))\"",
                "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 2\n"
                "x = \"sin(2*pi*t/T)\"\ny = \"-cos(2*pi*t/T)\"\n[continuation]\nparameter = \"k\"\nto = 0.3\n"
                "points = 60\n"),
            {"system.parameters.k=1.6"});
  const std::optional<FollowedBranch> found = follow_in_minimal_coordinates(s, s.options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->branches.front().end, BranchEnd::infinite_period);
  EXPECT_NEAR(found->points.back().parameter, closing, 1e-7);
}

TEST_F(Scenes, DampedChainsAreThoseOfTheirAngles) {
  for (const int links : {2, 4, 6}) {
    DampedChain chain{{}, {}, 0.8};
    for (int i = 0; i < links; ++i) {
      chain.start.push_back(0.3 - 0.1 * i);
      chain.end.push_back(chain.start.back() + 0.1 + 0.05 * (i % 2));
    }
    const Study s = study(chain.scene());
    ASSERT_TRUE(minimal(s));
    const Solution found = run(s), angles = run(study(chain.between_angles()));
    ASSERT_TRUE(found.converged() && angles.converged()) << found.message << angles.message;
    EXPECT_LT(found.unknowns, 2 * angles.unknowns);
    EXPECT_NEAR(*found.work, *angles.work, 1e-8) << links;
    std::vector<double> q(2 * links), v(q), a(links), rate(links);
    for (const double t : {0.0, 0.2, 0.5, 0.8}) {
      found.trajectory.at(t, q, v);
      angles.trajectory.at(t, a, rate);
      double x = 0, y = 0;
      for (int i = 0; i < links; ++i) {
        x += std::sin(a[i]);
        y -= std::cos(a[i]);
        EXPECT_NEAR(q[i], x, 1e-8) << links;
        EXPECT_NEAR(q[links + i], y, 1e-8) << links;
      }
    }
  }
}

TEST_F(Scenes, DampedMotionFromInitialDataInAChart) {
  const Study s = study(
      pendulum_in_plane("x = \"-k*x'\", y = \"-k*y'\"",
                        "[boundary]\nstart = { x = \"sin(0.4)\", y = \"-cos(0.4)\", p_x = \"3*cos(0.4)\", "
                        "p_y = \"3*sin(0.4)\" }\nduration = 20\n"));
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s);
  const Solution angle =
      run(study(pendulum_by_angle("-k*a'", "[boundary]\nstart = { a = 0.4, p_a = 3 }\nduration = 20\n")));
  ASSERT_TRUE(found.converged() && angle.converged()) << found.message << angle.message;
  std::vector<double> q(2), v(2), a(1), rate(1);
  for (const double t : {1.0, 7.0, 20.0}) {
    found.trajectory.at(t, q, v);
    angle.trajectory.at(t, a, rate);
    EXPECT_NEAR(q[0], std::sin(a[0]), 1e-7);
    EXPECT_NEAR(q[1], -std::cos(a[0]), 1e-7);
  }
  EXPECT_NEAR(*found.work, *angle.work, 1e-8);
}

/// Without a momentum along the circle at the end.
TEST_F(Scenes, ADampedEndThatIsFreeInAChart) {
  const Study s =
      study(pendulum_in_plane("x = \"-k*x'\", y = \"-k*y'\"",
                              "[boundary]\nstart = { x = \"sin(0.4)\", y = \"-cos(0.4)\" }\nduration = 1.2\n"
                              "[guess]\nx = 0.5\ny = -0.9\n"));
  ASSERT_TRUE(minimal(s));
  const Solution found = run(s);
  const Solution angle = run(study(
      pendulum_by_angle("-k*a'", "[boundary]\nstart = { a = 0.4 }\nduration = 1.2\n[guess]\na = 0.5\n")));
  expect_same_swing(s, found, angle);
}

/// An end that is given by its height alone is available in minimal coordinates only.
TEST_F(Scenes, ADampedEndOfWhichTheHeightIsGiven) {
  const Solution found =
      run(study("[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2 - z\"\n"
                "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n"
                "force = { x = \"-0.2*x' - 0.3*y\", y = \"-0.2*y' + 0.3*x\", z = \"-0.2*z'\" }\n[boundary]\n"
                "start = { x = \"sin(1)\", y = 0, z = \"-cos(1)\" }\nend = { z = -0.8 }\nduration = 0.5\n"
                "[guess]\nx = 0.6\ny = \"0.2*t/T\"\nz = -0.7\n"));
  const Solution angles =
      run(study("[system]\ncoordinates = [\"a\", \"b\"]\nlagrangian = \"(a'^2 + sin(a)^2*b'^2)/2 + cos(a)\"\n"
                "force = { a = \"-0.2*a'\", b = \"sin(a)^2*(0.3 - 0.2*b')\" }\n[boundary]\n"
                "start = { a = 1, b = 0 }\nend = { a = \"acos(0.8)\" }\nduration = 0.5\n"));
  ASSERT_TRUE(found.converged() && angles.converged()) << found.message << angles.message;
  EXPECT_NEAR(found.action, angles.action, 1e-10);
  EXPECT_NEAR(*found.work, *angles.work, 1e-10);
}

/// What charts do not have goes the other way: a force that is not smooth.
TEST_F(Scenes, DryFrictionHasNoChart) {
  const Study s = study(
      pendulum_in_plane("x = \"-k*x'/(0.01 + abs(x'))\"",
                        "[boundary]\nstart = { x = 0, y = -1 }\nend = { x = \"sin(1)\", y = \"-cos(1)\" }\n"
                        "duration = 0.7\n"));
  EXPECT_FALSE(minimal(s));
}

/// The default guess does not lead there: it is searched for in the angles.
TEST_F(Scenes, ADampedChainThatIsSearchedFor) {
  const DampedChain chain{{0.3, 0.2, 0.1, 0.0}, {0.5, 0.6, 0.7, 0.8}, 1, 9.81, 0.2};
  const Solution found = run(study(chain.scene()));
  ASSERT_TRUE(found.converged()) << found.message;
  const Solution motion = run(study(chain.from_motion(found.momentum_start)));
  ASSERT_TRUE(motion.converged()) << motion.message;
  std::vector<double> a(4), rate(4);
  motion.trajectory.at(1, a, rate);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(std::sin(a[i]), std::sin(chain.end[i]), 1e-7);
    EXPECT_NEAR(std::cos(a[i]), std::cos(chain.end[i]), 1e-7);
  }
}
