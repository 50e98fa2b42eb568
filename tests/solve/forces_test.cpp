#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "machine/long_test.hpp"
#include "problem/copies.hpp"
#include "solution/one_copy.hpp"
#include "solve/adapt/others_to_try.hpp"
#include "solve/branch/diagram.hpp"
#include "solve/solve.hpp"
#include "system/formula.hpp"

/// Motions with forces: orders, closed forms, published values, and families against an integration of their
/// own.

using namespace extremal;

namespace {

constexpr double pi = std::numbers::pi;

struct ForcedSystem {
  std::vector<std::string> coordinates;
  std::string lagrangian;
  std::vector<std::string> forces;  ///< of each coordinate; empty: none
};

Problem forced_problem(const ForcedSystem& text, double duration) {
  const SystemText system{.coordinates = text.coordinates, .lagrangian = text.lagrangian};
  std::vector<ForceText> forces;
  for (std::size_t a = 0; a < text.forces.size(); ++a)
    if (!text.forces[a].empty())
      forces.push_back({.first = static_cast<int>(a), .formula = text.forces[a], .where = "force"});
  const System compiled = compile(system);
  Problem problem;
  problem.lagrangian = compiled.lagrangian;
  if (!forces.empty()) problem.copies = compile_forces(system, forces);
  problem.names = compiled.names;
  problem.boundary.coordinates = static_cast<int>(compiled.names.size());
  problem.duration.value = duration;
  return problem;
}

Problem between(const ForcedSystem& text, double duration, std::span<const double> start,
                std::span<const double> end) {
  Problem problem = forced_problem(text, duration);
  for (int a = 0; a < problem.coordinates(); ++a) {
    problem.boundary.fix(a, false, start[a]);
    problem.boundary.fix(a, true, end[a]);
  }
  return make_problem(std::move(problem));
}

Problem closed_problem(const ForcedSystem& text, double duration, bool free,
                       const std::function<double(double)>& guess, double turn = 0) {
  Problem problem = forced_problem(text, duration);
  problem.periodic = true;
  problem.duration.free = free;
  for (int a = 0; a < problem.coordinates(); ++a) {
    const int row = problem.boundary.add_row(turn);
    problem.boundary.add(row, problem.coordinates() + a, 1);
    problem.boundary.add(row, a, -1);
  }
  for (int k = 0; k <= 256; ++k) {
    problem.guess.tau.push_back(k / 256.0);
    for (int a = 0; a < problem.coordinates(); ++a) problem.guess.q.push_back(guess(k / 256.0));
  }
  return make_problem(std::move(problem));
}

double at(const Solution& solution, double t, int a = 0) {
  std::vector<double> q(solution.trajectory.coordinates), v(q.size());
  solution.trajectory.at(t, q, v);
  return q[a];
}

const ForcedSystem pendulum_with_drag{{"x"}, "x'^2/2 + 2*cos(x)", {"-0.3*x' - 0.1*x'^3 + 0.2*sin(2*t)"}};

Solution solved(const Problem& problem, const std::string& name, int elements) {
  return Solver().solve(problem, {.scheme = scheme(name), .elements = elements});
}

/// Of both momenta and of q at nodes that the meshes share.
double error_at_nodes(const Problem& problem, const std::string& name, int elements, const Solution& exact) {
  const Solution solution = solved(problem, name, elements);
  EXPECT_TRUE(solution.converged()) << name << ": " << solution.message;
  double sum = std::pow(solution.momentum_start.at(0) - exact.momentum_start[0], 2) +
               std::pow(solution.momentum_end.at(0) - exact.momentum_end[0], 2);
  for (int k = 1; k < 8; ++k) {
    const double t = k * exact.duration() / 8;
    sum += std::pow(at(solution, t) - at(exact, t), 2);
  }
  return std::sqrt(sum);
}

/// State by (t, state) → slope, by Runge and Kutta's steps of order four, extrapolated.
using Slope = std::function<std::array<double, 2>(double, std::array<double, 2>)>;
std::array<double, 2> integrate(const Slope& f, std::array<double, 2> y, double T, int steps) {
  const auto run = [&](int count) {
    std::array<double, 2> z = y;
    const double h = T / count;
    const auto moved = [&](double by, std::array<double, 2> k) {
      return std::array{z[0] + by * k[0], z[1] + by * k[1]};
    };
    for (int k = 0; k < count; ++k) {
      const double t = k * h;
      const auto a = f(t, z), b = f(t + h / 2, moved(h / 2, a)), c = f(t + h / 2, moved(h / 2, b)),
                 d = f(t + h, moved(h, c));
      for (int i = 0; i < 2; ++i) z[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
    return z;
  };
  const auto coarse = run(steps), fine = run(2 * steps);
  return {fine[0] + (fine[0] - coarse[0]) / 15, fine[1] + (fine[1] - coarse[1]) / 15};
}

/// Trace and determinant of the flow over the period, by differences.
std::array<double, 2> monodromy(const Slope& f, std::array<double, 2> y, double T) {
  constexpr double by = 1e-5;
  double m[2][2];
  for (int j = 0; j < 2; ++j) {
    auto low = y, high = y;
    low[j] -= by;
    high[j] += by;
    const auto a = integrate(f, low, T, 2000), b = integrate(f, high, T, 2000);
    for (int i = 0; i < 2; ++i) m[i][j] = (b[i] - a[i]) / (2 * by);
  }
  return {m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]};
}

std::array<double, 2> start_of(const Solution& solution) {
  std::vector<double> q(1), v(1);
  solution.trajectory.at(0, q, v);
  return {q[0], v[0]};
}

}  // namespace

TEST(Forces, OrdersAreThoseOfTheSchemes) {
  const double start[] = {0.4}, end[] = {1.3};
  const Problem problem = between(pendulum_with_drag, 2, start, end);
  const Solution exact = solved(problem, "lobatto(8)", 40);
  const std::tuple<const char*, int, double> schemes[] = {
      {"rectangle", 64, 1}, {"rectangle-right", 64, 1}, {"midpoint", 32, 2},  {"trapezoid", 32, 2},
      {"simpson", 32, 2},   {"linear", 32, 2},          {"quadratic", 16, 4}, {"lobatto(2)", 16, 4},
      {"lobatto(3)", 8, 6}, {"gauss(2)", 16, 4},        {"gauss(3)", 8, 6}};
  for (const auto& [name, elements, order] : schemes) {
    const double coarse = error_at_nodes(problem, name, elements, exact),
                 fine = error_at_nodes(problem, name, 2 * elements, exact);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.3) << name << " " << coarse << " " << fine;
  }
}

TEST(Forces, DampedOscillatorInClosedForm) {
  const double c = 0.3, w = std::sqrt(1 - c * c / 4), T = 4, start[] = {1.0}, end[] = {0.5};
  const Problem problem = between({{"x"}, "x'^2/2 - x^2/2", {"-0.3*x'"}}, T, start, end);
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-12});
  ASSERT_TRUE(solution.converged()) << solution.message;
  const double b = (0.5 * std::exp(c * T / 2) - std::cos(w * T)) / std::sin(w * T);
  for (int k = 0; k <= 40; ++k) {
    const double t = k * T / 40, exact = std::exp(-c * t / 2) * (std::cos(w * t) + b * std::sin(w * t));
    EXPECT_NEAR(at(solution, t), exact, 1e-11) << t;
  }
  EXPECT_NEAR(solution.momentum_start[0], -c / 2 + b * w, 1e-11);
  EXPECT_FALSE(solution.morse_index || solution.nullity || solution.energy_drift);
  EXPECT_TRUE(solution.windows.empty());
  const auto energy = [](double q, double v) { return (q * q + v * v) / 2; };
  EXPECT_NEAR(*solution.energy, energy(1, solution.momentum_start[0]), 1e-11);
  EXPECT_NEAR(*solution.work, energy(0.5, solution.momentum_end[0]) - *solution.energy, 1e-11);
}

/// The force −c x' is that of e^{ct} L.
TEST(Forces, LinearDampingIsThatOfAGrowingLagrangian) {
  const double start[] = {0.1}, end[] = {2.2};
  const Problem with = between({{"x"}, "x'^2/2 + 3*cos(x)", {"-0.4*x'"}}, 3, start, end);
  const Problem without = between({{"x"}, "exp(0.4*t)*(x'^2/2 + 3*cos(x))", {}}, 3, start, end);
  const SolveOptions options{.tolerance = 1e-11};
  const Solution a = Solver().solve(with, options), b = Solver().solve(without, options);
  ASSERT_TRUE(a.converged() && b.converged());
  for (int k = 0; k <= 30; ++k) EXPECT_NEAR(at(a, k * 0.1), at(b, k * 0.1), 1e-10);
}

TEST(Forces, NewtonsStepsKeepTheCopiesTogether) {
  const double start[] = {0.4}, end[] = {1.3};
  const Problem problem = between(pendulum_with_drag, 2, start, end);
  for (const char* name : {"rectangle", "midpoint", "simpson", "quadratic", "gauss(3)", "lobatto(6)"}) {
    const Solution pair = solved(*problem.pair, name, 24);
    ASSERT_TRUE(pair.converged()) << name;
    EXPECT_LE(difference_of_copies(pair.trajectory), 1e-13) << name;
  }
  const Solution adaptive = Solver().solve(*problem.pair);
  ASSERT_TRUE(adaptive.converged());
  EXPECT_LE(difference_of_copies(adaptive.trajectory), 1e-13);
}

/// d/dt ∂L/∂q' − ∂L/∂q = F holds for any split of the motion between L and F.
TEST(Forces, PotentialForcesAreThoseOfTheLagrangian) {
  const double start[] = {1.0, 0.2}, end[] = {-0.3, 0.8};
  const Problem forces =
      between({{"x", "y"}, "(x'^2 + 2*y'^2)/2 + x'*y*0.3", {"-x - y^2", "-2*x*y - y"}}, 1.5, start, end);
  const Problem potential =
      between({{"x", "y"}, "(x'^2 + 2*y'^2)/2 + x'*y*0.3 - (x^2 + y^2)/2 - x*y^2", {}}, 1.5, start, end);
  for (const char* name : {"midpoint", "lobatto(4)", "gauss(3)"}) {
    const Solution a = solved(forces, name, 12), b = solved(potential, name, 12);
    ASSERT_TRUE(a.converged() && b.converged());
    for (int k = 0; k <= 12; ++k)
      for (int c = 0; c < 2; ++c) EXPECT_NEAR(at(a, k * 0.125, c), at(b, k * 0.125, c), 1e-13) << name;
    EXPECT_NEAR(a.momentum_end[1], b.momentum_end[1], 1e-12);
  }
}

TEST(Forces, EndsWithGivenAndWithNaturalMomenta) {
  Problem problem = forced_problem({{"x"}, "x'^2/2 - x^2/2", {"-0.5*x'"}}, 2);
  problem.boundary.give_momentum(0, false, 0.7);
  problem = make_problem(std::move(problem));
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-12});
  ASSERT_TRUE(solution.converged()) << solution.message;
  // x = e^{-t/4} (a cos wt + b sin wt), x'(0) = 0.7, x'(2) = 0
  const double l = 0.25, w = std::sqrt(1 - l * l), c = std::cos(2 * w), s = std::sin(2 * w);
  // x' = e^{-lt} ((bw − la) cos wt − (aw + lb) sin wt), and bw = 0.7 + la
  const double a = (0.7 * c - 0.7 * l / w * s) / ((w + l * l / w) * s);
  EXPECT_NEAR(at(solution, 0), a, 1e-11);
  EXPECT_NEAR(solution.momentum_start[0], 0.7, 1e-11);
  EXPECT_NEAR(solution.momentum_end[0], 0, 1e-11);
}

TEST(Forces, FreeDurationClosedByACondition) {
  Problem problem = forced_problem({{"x"}, "x'^2/2", {"-0.5*x'"}}, 1.7);
  problem.boundary.fix(0, false, 0);
  problem.boundary.give_momentum(0, true, 0.5);
  problem.duration.free = true;
  problem.duration.where = [](auto, auto end, auto gradient) {
    gradient[0] = 0;
    gradient[1] = 1;
    return end[0] - 1.0;
  };
  problem = make_problem(std::move(problem));
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-12});
  ASSERT_TRUE(solution.converged()) << solution.message;
  // v(0) = v(T) + c x(T) = 1, and e^{-cT} = 0.5
  EXPECT_NEAR(solution.duration(), std::log(2.0) / 0.5, 1e-11);
  EXPECT_NEAR(solution.momentum_start[0], 1, 1e-11);
}

/// Layers of width 1/mu that no smooth guess has, but the motion that it tends to. The period is that between
/// passages of x = 1, by DOP853 at 1e-12.
TEST(Forces, VanDerPolsRelaxationOscillation) {
  const Problem problem = closed_problem({{"x"}, "x'^2/2 - x^2/2", {"50*(1 - x^2)*x'"}}, 83, true,
                                         [](double tau) { return 2 * std::cos(2 * pi * tau); });
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-9});
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_EQ(solution.strategy, "newton from the motion that the guess tends to");
  EXPECT_NEAR(solution.duration(), 82.50833389, 1e-7);
}

/// A relay pushes on, and the velocity of a cosine vanishes where its force jumps. From any phase it comes to
/// the same orbit. Its period is that of Runge's and Kutta's method from turn to turn.
TEST(Forces, ARelayThatKeepsUpAnOscillation) {
  for (const double phase : {0.0, 0.3, -1.2, 2.0}) {
    const Problem problem =
        closed_problem({{"x"}, "x'^2/2 - x^2/2", {"0.8*x'/abs(x') - 0.3*x'^3"}}, 6.3, true,
                       [=](double tau) { return 1.5 * std::cos(2 * pi * tau + phase); });
    const Solution solution = Solver().solve(problem, {.tolerance = 1e-9});
    ASSERT_TRUE(solution.converged()) << solution.message;
    EXPECT_NEAR(solution.duration(), 7.019327415, 1e-7);
  }
}

/// No other period than that of a drive repeats it.
TEST(Forces, ADrivesPeriodIsNoneToChoose) {
  const ForcedSystem driven{{"x"}, "x'^2/2 - x^2/2 + x*cos(t)", {"-x'"}},
      free{{"x"}, "x'^2/2 - x^2/2", {"-x'"}};
  const auto swing = [](double tau) { return std::cos(2 * pi * tau); };
  EXPECT_EQ(
      others_to_try(closed_problem(driven, 2 * pi, false, swing), "another guess", "a shorter duration"),
      "another guess");
  EXPECT_EQ(others_to_try(closed_problem(free, 2 * pi, false, swing), "another guess", "a shorter duration"),
            "another guess or a shorter duration");
}

TEST(Forces, VanDerPolsLimitCycle) {
  struct Case {
    double mu, guess, period, tolerance;
  };
  for (const Case& c : {Case{1, 6.5, 6.663286859323130, 1e-11}, Case{10, 19, 19.0783695669, 1e-9}}) {
    const Problem problem =
        closed_problem({{"x"}, "x'^2/2 - x^2/2", {fmt::format("{}*(1 - x^2)*x'", c.mu)}}, c.guess, true,
                       [](double tau) { return 2 * std::cos(2 * pi * tau); });
    const Solution solution = Solver().solve(problem, {.tolerance = 1e-12});
    ASSERT_TRUE(solution.converged()) << solution.message;
    EXPECT_NEAR(solution.duration(), c.period, c.tolerance);
    EXPECT_NEAR(*solution.work, 0, 1e-9);
    ASSERT_TRUE(solution.floquet);
    EXPECT_TRUE(solution.floquet->stable());
    ASSERT_EQ(solution.floquet->multipliers.size(), 2u);
    EXPECT_EQ(solution.floquet->multipliers[0], 1.0);
    double divergence = 0;  // ∫ mu (1 − x²) dt, of a smooth periodic function
    constexpr int points = 20000;
    for (int k = 0; k < points; ++k) {
      const double x = at(solution, solution.duration() * k / points);
      divergence += c.mu * (1 - x * x) * solution.duration() / points;
    }
    EXPECT_NEAR(std::log(solution.floquet->multipliers[1].real()), divergence, 1e-6 * std::abs(divergence));
  }
}

/// Of one coordinate: trace and determinant of the monodromy matrix.
struct Monodromy {
  double trace = 0, determinant = 0;
};

Monodromy monodromy_of(const Solution& solution) {
  const auto& multipliers = solution.floquet->multipliers;
  return {(multipliers[0] + multipliers[1]).real(), (multipliers[0] * multipliers[1]).real()};
}

/// x'' = −2 z x' − x + f, where f jumps with the sign of x': turning points, and where x is.
struct Turn {
  double t, x;
};

std::vector<Turn> turns_of(const Solution& solution) {
  std::vector<Turn> turns;
  double x = 0, v = 0;
  const auto velocity = [&](double t) {
    solution.trajectory.at(t, {&x, 1}, {&v, 1});
    return v;
  };
  constexpr int steps = 1000;
  const double step = solution.duration() / steps;
  for (int k = 0; k < steps; ++k) {
    double left = k * step, right = left + step;
    const bool falling = velocity(left) > 0;
    if (falling == (velocity(right) > 0)) continue;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (left + right);
      ((velocity(middle) > 0) == falling ? left : right) = middle;
    }
    velocity(left);
    turns.push_back({left, x});
  }
  return turns;
}

/// Friction of a given size against the motion, under a drive: between turning points a rotation, at each the
/// velocity of a motion beside is multiplied by the ratio of accelerations after and before.
TEST(Forces, MultipliersOfDryFriction) {
  constexpr double c = 0.2, w = 0.7;
  const Problem problem =
      closed_problem({{"x"}, "x'^2/2 - x^2/2", {"-0.2*x'/abs(x') + cos(0.7*t)"}}, 2 * pi / w, false,
                     [](double tau) { return 2 * std::cos(2 * pi * tau); });
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-11});
  ASSERT_TRUE(solution.converged()) << solution.message;
  const std::vector<Turn> turns = turns_of(solution);
  ASSERT_EQ(turns.size(), 2u);
  Eigen::Matrix2d monodromy = Eigen::Matrix2d::Identity();
  const auto flow = [&](double time) {
    Eigen::Matrix2d rotation;
    rotation << std::cos(time), std::sin(time), -std::sin(time), std::cos(time);
    monodromy = (rotation * monodromy).eval();
  };
  double last = 0;
  for (const Turn& turn : turns) {
    flow(turn.t - last);
    const double mean = std::cos(w * turn.t) - turn.x, change = mean > 0 ? -c : c;  // x' rises or falls
    monodromy.row(1) *= (mean + change) / (mean - change);
    last = turn.t;
  }
  flow(solution.duration() - last);
  ASSERT_TRUE(solution.floquet);
  EXPECT_NEAR(monodromy_of(solution).trace, monodromy.trace(), 1e-8);
  EXPECT_NEAR(monodromy_of(solution).determinant, monodromy.determinant(), 1e-8);
}

/// A clock: dry friction that drives, and damping. A shift in time has the multiplier 1, exactly; the other
/// is the determinant.
TEST(Forces, MultipliersOfAnEscapement) {
  constexpr double z = 0.05, c = 0.3;
  const Problem problem = closed_problem({{"x"}, "x'^2/2 - x^2/2", {"-0.1*x' + 0.3*x'/abs(x')"}}, 6.2, true,
                                         [](double tau) { return 3.8 * std::cos(2 * pi * tau); });
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-11});
  ASSERT_TRUE(solution.converged()) << solution.message;
  double determinant = std::exp(-2 * z * solution.duration());
  for (const Turn& turn : turns_of(solution)) {
    const double change = turn.x < 0 ? c : -c;
    determinant *= (-turn.x + change) / (-turn.x - change);
  }
  ASSERT_TRUE(solution.floquet);
  EXPECT_EQ(solution.floquet->multipliers[0], 1.0);
  EXPECT_NEAR(solution.floquet->multipliers[1].real(), determinant, 1e-8);
}

/// A force that jumps with the place, and the potential that it has.
TEST(Forces, MultipliersOfARelay) {
  const auto orbit = [](const ForcedSystem& system) {
    const Problem problem =
        closed_problem(system, 2 * pi / 0.7, false, [](double tau) { return 2 * std::cos(2 * pi * tau); });
    return Solver().solve(problem, {.tolerance = 1e-11});
  };
  const Solution relay = orbit({{"x"}, "x'^2/2 - x^2/2", {"-0.2*x/abs(x) - 0.1*x' + cos(0.7*t)"}}),
                 potential = orbit({{"x"}, "x'^2/2 - x^2/2 - 0.2*abs(x)", {"-0.1*x' + cos(0.7*t)"}});
  ASSERT_TRUE(relay.converged()) << relay.message;
  ASSERT_TRUE(potential.converged()) << potential.message;
  EXPECT_LE(relay.iterations, potential.iterations + 1);
  ASSERT_TRUE(relay.floquet && potential.floquet);
  EXPECT_NEAR(monodromy_of(relay).trace, monodromy_of(potential).trace, 1e-8);
  EXPECT_NEAR(monodromy_of(relay).determinant, std::exp(-0.1 * 2 * pi / 0.7), 1e-8);
}

/// a'' = m − c a' turns at the rate m/c.
TEST(Forces, APeriodOfItsOwnUpToAMap) {
  const Problem problem = closed_problem(
      {{"a"}, "a'^2/2", {"0.5 - 0.2*a'"}}, 2.2, true,
      [](double tau) { return 2 * pi * tau + 0.1 * std::sin(2 * pi * tau); }, 2 * pi);
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-12});
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.duration(), 2 * pi * 0.2 / 0.5, 1e-11);
}

/// A circle that a rotation and a shift of time move alike.
TEST(Forces, RotatingLimitCycle) {
  Problem problem = forced_problem({{"x", "y"},
                                    "(x'^2 + y'^2)/2 - (x^2 + y^2)/2",
                                    {"0.5*(1 - x'^2 - y'^2)*x'", "0.5*(1 - x'^2 - y'^2)*y'"}},
                                   6.1);
  problem.periodic = problem.duration.free = true;
  for (int a = 0; a < 2; ++a) {
    const int row = problem.boundary.add_row(0);
    problem.boundary.add(row, 2 + a, 1);
    problem.boundary.add(row, a, -1);
  }
  for (int k = 0; k <= 128; ++k) {
    problem.guess.tau.push_back(k / 128.0);
    problem.guess.q.push_back(1.1 * std::cos(2 * pi * k / 128));
    problem.guess.q.push_back(1.1 * std::sin(2 * pi * k / 128));
  }
  problem = make_problem(std::move(problem));
  const Solution solution = Solver().solve(problem, {.tolerance = 1e-11});
  ASSERT_TRUE(solution.converged()) << solution.message;
  EXPECT_NEAR(solution.duration(), 2 * pi, 1e-9);
  EXPECT_NEAR(std::hypot(at(solution, 1, 0), at(solution, 1, 1)), 1, 1e-9);
}

namespace {

ProblemFamily driven_family(const std::function<Problem(double)>& at, double from, double to) {
  return {at(from), Varied::parameter, from, to, [at](double value) -> std::optional<Problem> {
            Problem problem = at(value);
            problem.guess = {};
            return problem;
          }};
}

std::vector<BranchPoint> points_of(const ProblemFamily& family, int points, bool others = false) {
  Diagram diagram(family, {{.tolerance = 1e-10}, points, others});
  std::vector<BranchPoint> found;
  while (diagram.advance()) found.push_back(diagram.point());
  EXPECT_EQ(diagram.branches().front().end, BranchEnd::target) << diagram.branches().front().message;
  EXPECT_FALSE(diagram.branches().front().worst_action_slope);
  return found;
}

}  // namespace

/// At a fold the orbit has the multiplier 1, by an integration that this library has no part in.
TEST(Forces, FoldsOfDuffingsResponse) {
  const auto duffing = [](double w) {
    return closed_problem({{"x"}, "x'^2/2 - x^2/2 - x^4/4", {fmt::format("-0.1*x' + 0.3*cos({:.17g}*t)", w)}},
                          2 * pi / w, false, [](double tau) { return 0.36 * std::cos(2 * pi * tau); });
  };
  std::vector<double> folds;
  for (const BranchPoint& point : points_of(driven_family(duffing, 0.5, 2.2), 200)) {
    EXPECT_TRUE(point.kind == PointKind::regular || point.kind == PointKind::fold);
    EXPECT_FALSE(point.solution.morse_index);
    const double w = point.parameter, T = 2 * pi / w;
    ASSERT_TRUE(point.solution.floquet);
    const auto& multipliers = point.solution.floquet->multipliers;
    EXPECT_NEAR(std::abs(multipliers[0] * multipliers[1]), std::exp(-0.1 * T), 1e-8);
    if (point.kind != PointKind::fold) continue;
    folds.push_back(w);
    const Slope slope = [w](double t, std::array<double, 2> y) {
      return std::array{y[1], -0.1 * y[1] - y[0] - y[0] * y[0] * y[0] + 0.3 * std::cos(w * t)};
    };
    const auto start = start_of(point.solution), end = integrate(slope, start, T, 2000);
    EXPECT_NEAR(end[0], start[0], 1e-8);
    EXPECT_NEAR(end[1], start[1], 1e-8);
    const auto [trace, determinant] = monodromy(slope, start, T);
    EXPECT_NEAR(1 - trace + determinant, 0, 1e-6);
  }
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0], 1.7797195, 1e-6);
  EXPECT_NEAR(folds[1], 1.3242362, 1e-6);
}

/// A family in the amplitude of a drive, over the bottom of (x/0.6)^m/m. Each orbit closes, by an integration
/// of its own.
BranchEnd follow_over_flat_bottom(int m, double from) {
  const auto driven = [m](double f) {
    return closed_problem(
        {{"x"}, fmt::format("x'^2/2 - (x/0.6)^{0}/{0}", m), {fmt::format("-0.1*x' + {:.17g}*cos(1.5*t)", f)}},
        2 * pi / 1.5, false, [](double tau) { return -0.05 * std::cos(2 * pi * tau); });
  };
  Diagram diagram(driven_family(driven, from, 1.5), {{.tolerance = 1e-9}, 100, false});
  while (diagram.advance()) {
    const BranchPoint& point = diagram.point();
    const Slope slope = [m, f = point.parameter](double t, std::array<double, 2> y) {
      return std::array{y[1], -0.1 * y[1] - std::pow(y[0] / 0.6, m - 1) / 0.6 + f * std::cos(1.5 * t)};
    };
    const auto start = start_of(point.solution), end = integrate(slope, start, 2 * pi / 1.5, 4000);
    EXPECT_NEAR(end[0], start[0], 1e-7) << m << ": " << point.parameter;
    EXPECT_NEAR(end[1], start[1], 1e-7) << m << ": " << point.parameter;
  }
  return diagram.branches().front().end;
}

/// At the first orbit the potential may be flat to roundoff, so that the orbit may be shifted, as no other
/// may.
TEST(Forces, FamiliesFromTheBottomOfAFlatPotential) {
  LONG_TEST();
  EXPECT_EQ(follow_over_flat_bottom(8, 0.2), BranchEnd::target);
  follow_over_flat_bottom(16, 0.05);
}

/// Orbits of three periods of the drive lie on a closed curve between two folds. Where the amplitude of a
/// drive grows, falls and grows again, another orbit has the first value, in the same direction.
TEST(Forces, ClosedCurvesOfOrbitsAndOthers) {
  LONG_TEST();
  const auto ring = [](double w) {
    return closed_problem({{"x"}, "x'^2/2 - x^2/2 - x^4/4", {fmt::format("-0.02*x' + cos({:.17g}*t)", w)}},
                          6 * pi / w, false, [](double tau) { return std::cos(2 * pi * tau); });
  };
  Diagram closed(driven_family(ring, 4, 2.5), {{.tolerance = 1e-9}, 200, false});
  double least = INFINITY, greatest = 0;
  while (closed.advance()) {
    least = std::min(least, closed.point().parameter);
    greatest = std::max(greatest, closed.point().parameter);
  }
  EXPECT_EQ(closed.branches().front().end, BranchEnd::closed) << closed.branches().front().message;
  EXPECT_NEAR(least, 3.0866, 1e-4);
  EXPECT_NEAR(greatest, 6.8606, 1e-4);
  const auto response = [](double f) {
    return closed_problem({{"x"}, "x'^2/2 - x^2/2 - x^4/4", {fmt::format("-0.1*x' + {:.17g}*cos(2.5*t)", f)}},
                          2 * pi / 2.5, false, [](double tau) { return -0.2 * std::cos(2 * pi * tau); });
  };
  Diagram open(driven_family(response, 1, 8), {{.tolerance = 1e-9}, 200, false});
  while (open.advance()) continue;
  EXPECT_EQ(open.branches().front().end, BranchEnd::target) << open.branches().front().message;
}

/// The pendulum with q = 2 driven at the rate 2/3: symmetric orbits lose their stability to a pair that is
/// not, and the period of that doubles (G. L. Baker and J. P. Gollub, Chaotic Dynamics, 2nd edition, chapter
/// 3).
TEST(Forces, DrivenPendulumLosesItsSymmetryAndDoublesItsPeriod) {
  LONG_TEST();
  const double T = 3 * pi;
  const auto pendulum = [&](double a) {
    return closed_problem({{"x"}, "x'^2/2 + cos(x)", {fmt::format("-x'/2 + {:.17g}*cos(2*t/3)", a)}}, T,
                          false, [](double tau) { return 1.2 * std::sin(2 * pi * tau); });
  };
  const std::vector<BranchPoint> points = points_of(driven_family(pendulum, 0.6, 1.08), 100, true);
  const auto slope_for = [](double a) -> Slope {
    return [a](double t, std::array<double, 2> y) {
      return std::array{y[1], -y[1] / 2 - std::sin(y[0]) + a * std::cos(2 * t / 3)};
    };
  };
  int crossings = 0, doublings = 0;
  for (const BranchPoint& point : points) {
    const auto [trace, determinant] =
        monodromy(slope_for(point.parameter), start_of(point.solution), point.solution.duration());
    if (point.kind == PointKind::branch) {
      ++crossings;
      EXPECT_EQ(point.branch, 0);
      EXPECT_NEAR(1 - trace + determinant, 0, 1e-5);
    } else if (point.kind == PointKind::period_doubling) {
      ++doublings;
      EXPECT_GT(point.branch, 0);
      EXPECT_NEAR(point.parameter, 1.06637, 1e-4);
      EXPECT_NEAR(1 + trace + determinant, 0, 1e-5);
    } else {
      EXPECT_EQ(point.kind, PointKind::regular);
    }
  }
  EXPECT_EQ(crossings, 1);
  EXPECT_EQ(doublings, 2);
}

TEST(Forces, AnAutonomousFamilyOfLimitCycles) {
  const auto cycle = [](double mu) {
    return closed_problem({{"x"}, "x'^2/2 - x^2/2", {fmt::format("{:.17g}*(1 - x^2)*x'", mu)}}, 6.4, true,
                          [](double tau) { return 2 * std::cos(2 * pi * tau); });
  };
  const std::vector<BranchPoint> points = points_of(driven_family(cycle, 0.2, 1.0), 60);
  EXPECT_NEAR(points.back().solution.duration(), 6.663286859323, 1e-8);
  EXPECT_TRUE(std::ranges::all_of(points, [](const auto& p) { return p.kind == PointKind::regular; }));
}

TEST(Forces, WhatIsNotAProblem) {
  const auto refusal = [](Problem problem) -> std::string {
    try {
      make_problem(std::move(problem));
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  Problem problem = forced_problem({{"x"}, "x'^2/2 - x^2/2", {"-x'"}}, 1);
  problem.duration.free = true;
  problem.duration.energy = 1;
  EXPECT_EQ(refusal(problem), "with forces the energy varies; it closes no free duration");
  problem.duration.energy.reset();
  EXPECT_EQ(refusal(problem), "a free duration needs exactly one of energy, where; 0 given");
  problem.copies = problem.lagrangian;
  problem.duration = {.value = 1};
  EXPECT_EQ(refusal(problem), "the Lagrangian of two copies has 1 coordinates; need 2");
}
