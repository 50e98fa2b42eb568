#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "problem/phase_space.hpp"
#include "scenes.hpp"
#include "solve/solve.hpp"
#include "study/continued.hpp"
#include "study/phase.hpp"

/// \file Scenes with a Hamiltonian whose second derivative by the momenta is singular.

namespace extremal::test {
namespace {

using std::numbers::pi;

class PhaseSpaceScenes : public Scenes {
 protected:
  struct Point {
    std::vector<double> q, v, p;
  };
  static Point at(const Study& s, const Solution& solution, double t) {
    const std::size_t n = s.problem.degrees_of_freedom();
    Point point{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
    Scratch scratch;
    phase_point(s.problem, solution.trajectory, t, point.q, point.v, point.p, scratch);
    return point;
  }
};

/// x' = x (1 − x), p' = −p (1 − 2x): p x (1 − x) is constant.
const std::string logistic = "[system]\ncoordinates = [\"x\"]\nhamiltonian = \"p_x*x*(1 - x)\"\n";
double logistic_at(double t) { return 0.1 * std::exp(t) / (0.9 + 0.1 * std::exp(t)); }
double logistic_momentum(double t) {
  const double x = logistic_at(t), end = logistic_at(5);
  return 2 * end * (1 - end) / (x * (1 - x));
}

TEST_F(PhaseSpaceScenes, LinearInTheMomentum) {
  const Study s = study(logistic + "[boundary]\nstart = { x = 0.1 }\nend = { p_x = 2 }\nduration = 5\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  for (const double t : {0.0, 0.7, 2.5, 4.1, 5.0}) {
    const Point point = at(s, solution, t);
    EXPECT_NEAR(point.q[0], logistic_at(t), 1e-9);
    EXPECT_NEAR(point.v[0], point.q[0] * (1 - point.q[0]), 1e-8);
    EXPECT_NEAR(point.p[0], logistic_momentum(t), 1e-8 * logistic_momentum(0));
  }
  EXPECT_NEAR(solution.momentum_start[0], logistic_momentum(0), 1e-8 * logistic_momentum(0));
  EXPECT_NEAR(solution.action, 0, 1e-8);
  EXPECT_FALSE(solution.morse_index || solution.nullity);
  EXPECT_LT(*solution.energy_drift, 1e-7);
}

TEST_F(PhaseSpaceScenes, FromInitialData) {
  const Study s = study(logistic + "[boundary]\nstart = { x = 0.1, p_x = 3 }\nduration = 5\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double ratio = 3 / logistic_momentum(0);
  for (const double t : {0.3, 2.5, 5.0}) {
    EXPECT_NEAR(at(s, solution, t).q[0], logistic_at(t), 1e-9);
    EXPECT_NEAR(at(s, solution, t).p[0], ratio * logistic_momentum(t), 1e-8);
  }
}

/// Rays in a uniform medium, H = |p|, to a line x = d with the momentum along it: only the direction that
/// arrives in time does.
TEST_F(PhaseSpaceScenes, OfDegreeOneBetweenAPointAndALine) {
  for (const double T : {1.05, 1.2, 3.0})
    for (const double along : {0.2, -5.0}) {
      const Study s =
          study(fmt::format("[system]\ncoordinates = [\"x\", \"y\"]\n"
                            "hamiltonian = \"sqrt(p_x^2 + p_y^2)\"\n[boundary]\n"
                            "start = {{ x = 0.0, y = 0.0 }}\nend = {{ x = 1.0, p_y = {} }}\n"
                            "duration = {}\n",
                            along, T));
      const Solution solution = run(s);
      ASSERT_TRUE(solution.converged()) << T << ' ' << along << solution.message;
      const double across = std::abs(along) / std::sqrt(T * T - 1);
      EXPECT_NEAR(at(s, solution, 0).p[0], across, 1e-7 * across) << T;
      EXPECT_NEAR(at(s, solution, T).q[1], std::copysign(std::sqrt(T * T - 1), along), 1e-7) << T;
    }
}

/// Without a guess, from the position at the start and the momentum at the end of a motion: that motion, or
/// another one with the same.
TEST_F(PhaseSpaceScenes, MomentumAtTheEndOfAMotion) {
  for (const char* hamiltonian : {"p_x*sin(x) + 0.1*p_x^3", "p_x^4/4 + x^2/2", "p_x*x - p_x^3*x/5"})
    for (const double momentum : {0.25, 0.4}) {
      const std::string system =
          fmt::format("[system]\ncoordinates = [\"x\"]\nhamiltonian = \"{}\"\n", hamiltonian);
      const auto end_from = [&](double p) {
        const Study s = study(
            system + fmt::format("[boundary]\nstart = {{ x = 0.5, p_x = {:.17g} }}\nduration = 2\n", p));
        return at(s, run(s), 2);
      };
      const double end = end_from(momentum).p[0];
      const Study s = study(
          system +
          fmt::format("[boundary]\nstart = {{ x = 0.5 }}\nend = {{ p_x = {:.17g} }}\nduration = 2\n", end));
      const Solution solution = run(s);
      ASSERT_TRUE(solution.converged()) << hamiltonian << momentum << solution.message;
      const Point there = end_from(at(s, solution, 0).p[0]);
      EXPECT_NEAR(there.p[0], end, 1e-7) << hamiltonian;
      EXPECT_NEAR(there.q[0], at(s, solution, 2).q[0], 1e-7) << hamiltonian;
    }
}

TEST_F(PhaseSpaceScenes, EndsThatContradictTheMotionAreNoSolution) {
  const Solution solution =
      run(study(logistic + "[boundary]\nstart = { x = 0.1 }\nend = { x = 0.2 }\nduration = 5\n"));
  EXPECT_FALSE(solution.converged());
  EXPECT_TRUE(solution.trajectory.nodes.empty());
}

const std::string vortices =
    "[system]\ncoordinates = [\"x[2]\"]\nparameters = { g = [1, 1] }\n"
    "hamiltonian = \"-g[1]*g[2]*log((x[1] - x[2])^2 + (p_x[1]/g[1] - p_x[2]/g[2])^2)/(4*pi)\"\n";

/// Two equal vortices at the distance d turn at the rate Γ/(π d²).
TEST_F(PhaseSpaceScenes, VortexPairTurns) {
  const Study s = study(vortices +
                        "[boundary]\nperiodic = true\nduration = \"2*pi^2\"\n[guess]\n"
                        "x = [\"0.52*cos(2*pi*t/T)\", \"-0.49*cos(2*pi*t/T)\"]\n"
                        "p_x = [\"0.5*sin(2*pi*t/T)\", \"-0.51*sin(2*pi*t/T)\"]\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.action, -pi / 2, 1e-9);  // energy zero, and area π/4 of each
  EXPECT_NEAR(*solution.energy, 0, 1e-9);
  const Point start = at(s, solution, 0);
  EXPECT_NEAR(std::hypot(start.q[0] - start.q[1], start.p[0] - start.p[1]), 1, 1e-9);
  ASSERT_TRUE(solution.floquet);
  ASSERT_EQ(solution.floquet->multipliers.size(), 4u);
  for (const auto& multiplier : solution.floquet->multipliers)
    EXPECT_NEAR(std::abs(multiplier - 1.0), 0, 1e-6);
}

/// Hamilton's equations of four vortices, integrated in steps of Runge and Kutta with extrapolation.
std::vector<double> four_vortices(std::vector<double> z, double duration) {
  const double g[] = {1, 1, -1, -1};
  const auto slope = [&](const std::vector<double>& y) {
    std::vector<double> rate(8, 0);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        if (i == j) continue;
        const double dx = y[i] - y[j], dy = y[4 + i] / g[i] - y[4 + j] / g[j], r2 = dx * dx + dy * dy;
        rate[i] -= g[j] * dy / (2 * pi * r2);
        rate[4 + i] += g[i] * g[j] * dx / (2 * pi * r2);
      }
    return rate;
  };
  const auto integrate = [&](int steps) {
    std::vector<double> y = z;
    const double h = duration / steps;
    for (int k = 0; k < steps; ++k) {
      const auto moved = [&](const std::vector<double>& by, double share) {
        std::vector<double> result = y;
        for (int a = 0; a < 8; ++a) result[a] += share * h * by[a];
        return result;
      };
      const auto k1 = slope(y), k2 = slope(moved(k1, 0.5)), k3 = slope(moved(k2, 0.5)),
                 k4 = slope(moved(k3, 1));
      for (int a = 0; a < 8; ++a) y[a] += h / 6 * (k1[a] + 2 * k2[a] + 2 * k3[a] + k4[a]);
    }
    return y;
  };
  const std::vector<double> coarse = integrate(20000), fine = integrate(40000);
  std::vector<double> result(8);
  for (int a = 0; a < 8; ++a) result[a] = fine[a] + (fine[a] - coarse[a]) / 15;
  return result;
}

const std::string leapfrogging =
    "[system]\ncoordinates = [\"x[4]\"]\nparameters = { g = [1, 1, -1, -1] }\n"
    "hamiltonian = \"-sum(i, 1, 3, sum(j, i + 1, 4, g[i]*g[j]*log((x[i] - x[j])^2 + (p_x[i]/g[i] - "
    "p_x[j]/g[j])^2)))/(4*pi)\"\n";

TEST_F(PhaseSpaceScenes, FourVorticesFromInitialData) {
  const Study s = study(
      leapfrogging + "[boundary]\nstart = { x = [0, 0, 0, 0], p_x = [0.5, 1.2, 0.5, 1.2] }\nduration = 20\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  const std::vector<double> expected = four_vortices({0, 0, 0, 0, 0.5, 1.2, 0.5, 1.2}, 20);
  const Point end = at(s, solution, 20);
  for (int a = 0; a < 4; ++a) {
    EXPECT_NEAR(end.q[a], expected[a], 1e-8);
    EXPECT_NEAR(end.p[a], expected[4 + a], 1e-8);
  }
}

/// Maxwell's fish-eye with the speed 1 + r² of light: rays are circles, and on the sphere of radius one, of
/// which the plane is the stereographic image, light takes half of the angle.
TEST_F(PhaseSpaceScenes, RayOfTheFishEye) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nhamiltonian = \"sqrt(p_x^2 + p_y^2)*(1 + x^2 + y^2)\"\n"
      "[boundary]\nstart = { x = 1, y = 0 }\nend = { x = 0, y = 0.5 }\nduration = \"free\"\nenergy = 1\n"
      "[guess]\nduration = 0.8\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.duration(), pi / 4, 1e-9);  // (1, 0, 0) and (0, 0.8, −0.6)
  EXPECT_NEAR(solution.action, 0, 1e-8);           // H is of degree one
  // Circles through both points of the sphere's great circle: x² + y² + b y = 1.
  const Point middle = at(s, solution, 0.3);
  EXPECT_NEAR(middle.q[0] * middle.q[0] + middle.q[1] * middle.q[1] + 1.5 * middle.q[1], 1, 1e-8);
}

/// Some momenta are quadratic, others linear.
TEST_F(PhaseSpaceScenes, PartlySingular) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nhamiltonian = \"p_x^2/2 + x^2/2 + p_y*(x - y/2)\"\n"
      "[boundary]\nstart = { x = 1, y = 0.3 }\nend = { x = 0.2, p_y = 0.5 }\nduration = 1.5\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  // p_y' = p_y/2, x'' = −x − p_y: x = a cos t + b sin t − c e^{t/2}, c = (4/5) p_y(0).
  const double T = 1.5, p0 = 0.5 * std::exp(-T / 2), c = 0.8 * p0;
  const double a = 1 + c, b = (0.2 + c * std::exp(T / 2) - a * std::cos(T)) / std::sin(T);
  for (const double t : {0.4, 1.1}) {
    const Point point = at(s, solution, t);
    EXPECT_NEAR(point.q[0], a * std::cos(t) + b * std::sin(t) - c * std::exp(t / 2), 1e-9);
    EXPECT_NEAR(point.p[1], p0 * std::exp(t / 2), 1e-9);
  }
}

/// The scheme is one of the phase-space action: with a regular H_pp that of its Legendre transform, to
/// roundoff.
TEST_F(PhaseSpaceScenes, EqualTheLegendreTransformWithGaussRules) {
  const SystemText text{.coordinates = {"x", "y"},
                        .hamiltonian = "(p_x^2 + p_y^2)/2 + x*p_y/3 + (x^2 + y^2)/2 + x^2*y - y^3/3"};
  const System one = compile(text), both = compile(text, Formulation::phase_space);
  Problem plain, phase;
  plain.lagrangian = one.lagrangian;
  plain.boundary.coordinates = 2;
  phase.boundary.coordinates = 4;
  for (Problem* problem : {&plain, &phase}) {
    problem->duration.value = 1.5;
    problem->boundary.fix(0, false, 0.3);
    problem->boundary.fix(1, false, 0);
    problem->boundary.fix(0, true, -0.1);
    problem->boundary.fix(1, true, 0.2);
  }
  phase.guess = {{0, 1}, {0.3, 0, -0.2, 0.1, -0.1, 0.2, -0.2, 0.1}};
  set_phase_space(*both.hamiltonian, phase);
  plain = make_problem(plain);
  phase = make_problem(phase);
  for (const char* name : {"midpoint", "gauss(2)", "gauss(3)", "rectangle", "rectangle-right"}) {
    SolveOptions options;
    options.scheme = scheme(name);
    options.elements = 12;
    Solver solver;
    const Solution l = solver.solve(plain, options), h = solver.solve(phase, options);
    ASSERT_TRUE(l.converged() && h.converged()) << name << ": " << l.message << " / " << h.message;
    EXPECT_NEAR(l.action, h.action, 1e-12) << name;
    const std::size_t nodes = l.trajectory.nodes.size() / 2;
    ASSERT_EQ(h.trajectory.nodes.size(), 4 * nodes);
    for (std::size_t k = 0; k < nodes; ++k)
      for (int a = 0; a < 2; ++a)
        EXPECT_NEAR(l.trajectory.nodes[2 * k + a], h.trajectory.nodes[4 * k + a], 1e-12) << name;
    for (int a = 0; a < 2; ++a) {
      EXPECT_NEAR(l.momentum_start[a], h.momentum_start[a], 1e-12) << name;
      EXPECT_NEAR(l.momentum_end[a], h.momentum_end[a], 1e-12) << name;
    }
    ASSERT_EQ(l.element_energies.size(), h.element_energies.size()) << name;
    for (std::size_t k = 0; k < l.element_energies.size(); ++k)
      EXPECT_NEAR(l.element_energies[k], h.element_energies[k], 1e-11) << name;
    EXPECT_GE(h.error_estimate, 0.5 * l.error_estimate) << name;  // momenta too
  }
}

TEST_F(PhaseSpaceScenes, HaveTheOrderOfTheirScheme) {
  Study s = study(logistic + "[boundary]\nstart = { x = 0.1 }\nend = { p_x = 2 }\nduration = 5\n");
  const auto error = [&](const Scheme& scheme, int elements) {
    s.options.scheme = scheme;
    s.options.elements = elements;
    const Solution solution = run(s);
    EXPECT_TRUE(solution.converged()) << scheme.name << ": " << solution.message;
    return std::abs(solution.momentum_start[0] - logistic_momentum(0));
  };
  for (const char* name : {"midpoint", "gauss(2)", "gauss(3)", "rectangle", "rectangle-right"}) {
    const Scheme tested = scheme(name);
    const int elements = tested.order == 1 ? 160 : tested.order == 2 ? 40 : 8;
    EXPECT_NEAR(std::log2(error(tested, elements) / error(tested, 2 * elements)), tested.order,
                0.1 * tested.order)
        << name;
  }
}

/// H = p⁴/4 + x²/2 is regular except at p = 0, where it turns.
TEST_F(PhaseSpaceScenes, QuarticMomentum) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\"]\nhamiltonian = \"p_x^4/4 + x^2/2\"\n"
      "[boundary]\nstart = { x = 1, p_x = 0 }\nduration = 3\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_LT(*solution.energy_drift, 1e-7);
  const Point end = at(s, solution, 3);
  EXPECT_NEAR(std::pow(end.p[0], 4) / 4 + end.q[0] * end.q[0] / 2, 0.5, 1e-8);
}

/// Its period at the energy 1/2 is 2^(1/4) B(1/2, 1/4). What is loosely stationary is no orbit yet.
TEST_F(PhaseSpaceScenes, OrbitsOfLooseTolerancesSolveHamiltonsEquations) {
  const double period = std::pow(2, 0.25) * std::sqrt(pi) * std::tgamma(0.25) / std::tgamma(0.75);
  for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
    const Solution solution =
        run(study(fmt::format("[system]\ncoordinates = [\"x\"]\nhamiltonian = \"p_x^4/4 + x^2/2\"\n"
                              "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0.5\n"
                              "[guess]\nx = \"cos(2*pi*t/T)\"\np_x = \"-sin(2*pi*t/T)\"\nduration = 6\n"
                              "[solve]\ntolerance = {}\n",
                              tolerance)));
    if (!solution.converged()) continue;
    EXPECT_NEAR(solution.duration(), period, 10 * tolerance * period) << tolerance;
    EXPECT_NEAR(*solution.energy, 0.5, 10 * tolerance) << tolerance;
  }
}

/// Three vortices in a row turn, and are unstable at the rate √3 Ω.
TEST_F(PhaseSpaceScenes, MultipliersOfVorticesInARow) {
  const Study s = study(
      "[system]\nuse = \"point-vortices\"\nparameters = { n = 3, g = [1, 1, 1] }\n"
      "[boundary]\nperiodic = true\nduration = \"8*pi^2/3\"\n[guess]\n"
      "x = [\"cos(2*pi*t/T)\", \"0\", \"-cos(2*pi*t/T)\"]\n"
      "p_x = [\"sin(2*pi*t/T)\", \"0\", \"-sin(2*pi*t/T)\"]\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  ASSERT_TRUE(solution.floquet);
  const auto& multipliers = solution.floquet->multipliers;
  ASSERT_EQ(multipliers.size(), 6u);
  EXPECT_NEAR(std::log(multipliers[0].real()), 2 * pi * std::sqrt(3), 1e-7);
  for (int k = 1; k < 5; ++k) EXPECT_NEAR(std::abs(multipliers[k] - 1.0), 0, 1e-6);
  EXPECT_NEAR((multipliers[0] * multipliers[5]).real(), 1, 1e-9);
  EXPECT_LE(solution.floquet->symplectic_defect, 1e-12);
}

/// The pair at the distance one turns at 1/π: in half a turn the vortices change places, and any part of a
/// turn is a rotation of the plane (x, p).
TEST_F(PhaseSpaceScenes, MapsNameMomenta) {
  const auto distance = [&](const std::string& map, const std::string& duration, const std::string& turn) {
    const Study s =
        study(vortices + "[boundary]\nperiodic = true\nduration = \"" + duration + "\"\nmap = { " + map +
              " }\n[guess]\nx = [\"0.52*cos(" + turn + ")\", \"-0.49*cos(" + turn +
              ")\"]\np_x = [\"0.5*sin(" + turn + ")\", \"-0.51*sin(" + turn + ")\"]\n");
    const Solution solution = run(s);
    EXPECT_TRUE(solution.converged()) << solution.message;
    if (!solution.converged()) return 0.0;
    const Point start = at(s, solution, 0);
    return std::hypot(start.q[0] - start.q[1], start.p[0] - start.p[1]);
  };
  EXPECT_NEAR(distance("\"x[1]\" = \"x[2]\", \"x[2]\" = \"x[1]\", \"p_x[1]\" = \"p_x[2]\", "
                       "\"p_x[2]\" = \"p_x[1]\"",
                       "pi^2", "pi*t/T"),
              1, 1e-9);
  std::string rotation;
  for (const int i : {1, 2})
    rotation += fmt::format(
        "{1}\"x[{0}]\" = \"cos(0.7)*x[{0}] - sin(0.7)*p_x[{0}]\", "
        "\"p_x[{0}]\" = \"sin(0.7)*x[{0}] + cos(0.7)*p_x[{0}]\"",
        i, i > 1 ? ", " : "");
  EXPECT_NEAR(distance(rotation, "0.7*pi", "0.7*t/T"), 1, 1e-9);
}

/// Unequal circulations; the energy closes the period.
TEST_F(PhaseSpaceScenes, EnergyClosesThePeriod) {
  const Study s =
      study(vortices +
                "[boundary]\nperiodic = true\nduration = \"free\"\nenergy = 0\n[guess]\nduration = 9\n"
                "x = [\"0.3*cos(2*pi*t/T)\", \"-0.7*cos(2*pi*t/T)\"]\n"
                "p_x = [\"0.9*sin(2*pi*t/T)\", \"-0.7*sin(2*pi*t/T)\"]\n",
            {"system.parameters.g=[3, 1]"});
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.duration(), pi * pi, 1e-8);  // 2π/Ω, Ω = (g1 + g2)/(2π) at the distance one
}

/// The circle keeps closing as the second vortex grows; translations depend on it.
TEST_F(PhaseSpaceScenes, FamilyInACirculation) {
  Study s = study(vortices +
                      "[boundary]\nperiodic = true\nduration = \"2*pi^2\"\n[guess]\n"
                      "x = [\"0.5*cos(2*pi*t/T)\", \"-0.5*cos(2*pi*t/T)\"]\n"
                      "p_x = [\"0.5*sin(2*pi*t/T)\", \"-0.5*sin(2*pi*t/T)\"]\n"
                      "[continuation]\nparameter = \"k\"\nto = 2\n",
                  {"system.parameters.k=1.0", "system.parameters.g=[1, \"k\"]"});
  const FollowedBranch branch = follow(s);
  ASSERT_FALSE(branch.points.empty());
  EXPECT_NEAR(branch.points.back().parameter, 2, 1e-9);
  for (const BranchPoint& point : branch.points) {
    // d² = (1 + k) T/(4π²), E = −k log(d²)/(4π).
    const double k = point.parameter, square = (1 + k) / 2;
    EXPECT_EQ(point.kind, PointKind::regular);
    EXPECT_NEAR(point.solution.energy.value(), -k * std::log(square) / (4 * pi), 1e-8);
  }
}

/// Orbits of H = cos x cos p about (0, 0) last 4 K(√(1 − H²)), and so at least 2π; those about a point that
/// is not the origin likewise.
TEST_F(PhaseSpaceScenes, RestsAreNoOrbits) {
  const auto scene = [](double duration) {
    return fmt::format(
        "[system]\ncoordinates = [\"x\"]\nhamiltonian = \"cos(x - 0.3)*cos(p_x - 0.2)\"\n"
        "[boundary]\nperiodic = true\nduration = {}\n[guess]\nx = \"0.3 + 0.5*sin(2*pi*t/T)\"\n"
        "p_x = \"0.2 - 0.5*cos(2*pi*t/T)\"\n[continuation]\nparameter = \"duration\"\nto = {}\n",
        duration, duration - 0.1);
  };
  const Solution none = run(study(scene(5)));
  EXPECT_EQ(none.status, Status::no_solution_near);
  EXPECT_NE(none.message.find("equilibrium"), std::string::npos) << none.message;
  const FollowedBranch branch = follow(study(scene(5)));
  EXPECT_TRUE(branch.points.empty());
  const Solution orbit = run(study(scene(7)));
  ASSERT_TRUE(orbit.converged()) << orbit.message;
  const double energy = orbit.energy.value();
  EXPECT_NEAR(4 * std::comp_ellint_1(std::sqrt(1 - energy * energy)), 7, 1e-7);
}

/// x is cyclic in p_x: v'' = −p_x. Momenta of the guess are constant, those of the path are not; H_pp = 1 and
/// durations that are powers of two are no resonance.
TEST_F(PhaseSpaceScenes, LinearEquationsTakeOneStep) {
  const std::string system = "[system]\ncoordinates = [\"x\", \"v\"]\nhamiltonian = \"p_v^2/2 + p_x*v\"\n";
  for (const double T : {0.5, 1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0})
    for (const double p : {0.0, 0.3}) {
      const std::string given = p == 0 ? "" : ", p_x = 0.3";
      const Study s =
          study(system + fmt::format("[boundary]\nstart = {{ x = 0, v = 0.2 }}\nend = {{ v = 0.5{} "
                                     "}}\nduration = {}\n",
                                     given, T));
      const Solution solution = run(s);
      ASSERT_TRUE(solution.converged()) << T << ": " << solution.message;
      EXPECT_EQ(solution.strategy, "newton from the guess") << T;
      EXPECT_LE(solution.iterations, 6) << T;
      const double slope = 0.3 / T + p * T / 2;  // v = 0.2 + slope·t − p t²/2
      for (const double part : {0.3, 0.7, 1.0}) {
        const double t = part * T;
        const Point point = at(s, solution, t);
        EXPECT_NEAR(point.q[0], 0.2 * t + slope * t * t / 2 - p * t * t * t / 6, 1e-9) << T;
        EXPECT_NEAR(point.q[1], 0.2 + slope * t - p * t * t / 2, 1e-9) << T;
        EXPECT_NEAR(point.p[1], slope - p * t, 1e-8) << T;
      }
    }
}

/// x' = p_x, y' = sin x: the start by shooting.
TEST_F(PhaseSpaceScenes, SingularInOneMomentum) {
  const Study s = study(
      "[system]\ncoordinates = [\"x\", \"y\"]\nhamiltonian = \"p_x^2/2 + p_y*sin(x) - cos(y)\"\n"
      "[boundary]\nstart = { x = 0.2, y = 0 }\nend = { x = 0.5, p_y = 0.3 }\nduration = 1.5\n");
  const Solution solution = run(s);
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.momentum_start[0], 0.65657582, 1e-8);
  EXPECT_NEAR(solution.momentum_start[1], 0.72564189, 1e-8);
}

TEST_F(PhaseSpaceScenes, RefusedWithTheirPlace) {
  const std::string ends = "[boundary]\nstart = { x = 0.1 }\nend = { p_x = 2 }\nduration = 5\n";
  const auto refused = [&](const std::string& rest, const std::string& part) {
    const std::string found = message(logistic + rest);
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  refused(ends + "[solve]\nscheme = \"lobatto(3)\"\nelements = 4\n", "use midpoint or gauss(s)");
  refused(ends + "[solve]\nscheme = \"gauss(2)\"\nelements = 4\nsteps = \"free\"\n", "leave 'steps' out");
  refused(ends + "[search]\nsolutions = 2\n", "leave it out");
  refused("[boundary]\nstart = { x = 0.1, p_x = 1 }\nend = { p_x = 2 }\nduration = 5\n", "initial data");
  refused("[boundary]\nconditions = [\"x(0) = 1\", \"p_x(T) = 2\"]\nduration = 5\n", "momenta are given by");
  EXPECT_NE(message("[system]\ncoordinates = [\"x\"]\nhamiltonian = \"p_x*abs(x)\"\n" + ends).find("smooth"),
            std::string::npos);
}

/// The momenta are those nearest to the guess: none.
TEST_F(PhaseSpaceScenes, MomentaThatVanish) {
  const Solution solution =
      run(study("[system]\ncoordinates = [\"x\", \"y\"]\nhamiltonian = \"p_x*y - p_y*x\"\n[boundary]\n"
                "start = { x = 1, y = 0 }\nend = { x = 0, y = -1 }\nduration = \"pi/2\"\n"));
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.action, 0, 1e-12);
  EXPECT_NEAR(solution.momentum_start[0], 0, 1e-9);
}

}  // namespace
}  // namespace extremal::test
