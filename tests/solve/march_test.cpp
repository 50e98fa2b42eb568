#include <numbers>

#include "action/rule.hpp"
#include "machine/long_test.hpp"
#include "motion/flow.hpp"
#include "rivals/shooting.hpp"
#include "solve/laws.hpp"
#include "solve/march/element_solver.hpp"
#include "system/formula.hpp"

/// \file Motions from initial data: the laws of the discrete flow of every scheme, and adaptive motions.

namespace extremal::laws {
namespace {

using std::numbers::pi;

std::shared_ptr<const Lagrangian> marched_system(std::vector<std::string> coordinates,
                                                 std::string lagrangian) {
  return compile({.coordinates = std::move(coordinates), .lagrangian = std::move(lagrangian)}).lagrangian;
}

/// x'' + c x' + k x = 0 beside the motion y of its mirror image in time; the mass is indefinite.
std::shared_ptr<const Lagrangian> damped_and_driven() {
  return marched_system({"x", "y"}, "x'*y' + 0.1*(x*y' - x'*y) - x*y");
}

struct MotionCase {
  const char* name;
  std::shared_ptr<const Lagrangian> lagrangian;
  Values q, p;
  double duration;
  int elements;  ///< enough that the discrete motion is near
};

std::vector<MotionCase> motion_cases() {
  return {{"pendulum", systems::pendulum(), {0.7}, {0.2}, 3, 40},
          {"Kepler", systems::kepler(), {1, 0}, {0, 1.1}, 4, 60},
          {"double pendulum", systems::double_pendulum(), {0.5, 0.4}, {0.3, -0.2}, 1, 60},
          {"magnetic", systems::magnetic(), {0.3, -0.2}, {0.4, 0.5}, 3, 50},
          {"driven", systems::driven(), {0.3}, {0.4}, 3, 50},
          {"doubled", damped_and_driven(), {0.3, 0.1}, {0.4, -0.2}, 5, 50}};
}

Problem from(const MotionCase& c) { return initial_problem(c.lagrangian, {c.q, c.p}, c.duration); }
Problem from(std::shared_ptr<const Lagrangian> lagrangian, Values q, Values p, double duration) {
  return initial_problem(std::move(lagrangian), {std::move(q), std::move(p)}, duration);
}

/// The motion by DOP853.
Values integrated(const Problem& problem, double t) {
  Flow flow(*problem.lagrangian);
  Values v(problem.coordinates());
  if (!flow.velocity(problem.initial->q, problem.initial->p, 0, v)) throw std::runtime_error("no velocity");
  return fly(*problem.lagrangian, problem.initial->q, v, Values{t}, 1e-13).q;
}

class Marching : public ::testing::TestWithParam<std::string> {
 protected:
  const Scheme tested = scheme(GetParam());
};

/// The same equations as between fixed ends.
TEST_P(Marching, MeetsTheBoundarySolver) {
  for (const MotionCase& c : motion_cases()) {
    const Solution motion = solve(from(c), pinned(tested, c.elements));
    Problem between = fixed_ends(c.lagrangian, c.q, node(motion.trajectory, c.elements), c.duration);
    between = guessed(between, [&](double tau) { return at(motion.trajectory, tau * c.duration).q; });
    const Solution path = solve(between, pinned(tested, c.elements));
    for (int k = 0; k <= c.elements; ++k)
      EXPECT_LT(largest_difference(node(path.trajectory, k), node(motion.trajectory, k)), 2e-12)
          << c.name << ", node " << k;
    EXPECT_LT(largest_difference(path.momentum_start, c.p), 2e-11) << c.name;
    EXPECT_LT(largest_difference(path.momentum_end, motion.momentum_end), 2e-11) << c.name;
    EXPECT_NEAR(path.action, motion.action, 1e-12 * (1 + std::abs(path.action))) << c.name;
    EXPECT_LT(motion.residual, 1e-14) << c.name;
    EXPECT_FALSE(motion.morse_index || motion.nullity || motion.minimizing);
    EXPECT_TRUE(motion.windows.empty() && motion.conjugate_times.empty() && !motion.floquet);
  }
}

TEST_P(Marching, HasTheOrderOfItsScheme) {
  for (const MotionCase& c : motion_cases()) {
    const Solution truth = solve(from(c), within(1e-12));
    Refinement ends;
    const int first = tested.order == 8   ? 6
                      : tested.order == 6 ? 6
                      : tested.order == 4 ? 10
                      : tested.order == 2 ? 40
                                          : 200;
    for (const int elements : refinements(first * (c.elements > 50 ? 2 : 1), 6)) {
      const Solution motion = solve(from(c), pinned(tested, elements));
      ends.add(1.0 / elements,
               std::max(largest_difference(node(motion.trajectory, elements),
                                           node(truth.trajectory, truth.trajectory.elements())),
                        largest_difference(motion.momentum_end, truth.momentum_end)));
    }
    EXPECT_NEAR(ends.slope(2e-14), tested.order, 0.12 * tested.order) << c.name;
  }
}

/// Backwards in time the flow of a scheme is that of its mirror image; most are their own.
TEST_P(Marching, RunsBackwards) {
  const std::string mirrored = tested.name == "rectangle"         ? "rectangle-right"
                               : tested.name == "rectangle-right" ? "rectangle"
                                                                  : tested.name;
  for (const MotionCase& c : motion_cases()) {
    if (c.name == std::string("magnetic") || c.name == std::string("driven") ||
        c.name == std::string("doubled"))
      continue;  // not reversible
    const Solution there = solve(from(c), pinned(tested, c.elements));
    Values turned = there.momentum_end;
    for (double& p : turned) p = -p;
    const Solution back = solve(from(c.lagrangian, node(there.trajectory, c.elements), turned, c.duration),
                                pinned(scheme(mirrored), c.elements));
    EXPECT_LT(largest_difference(node(back.trajectory, c.elements), c.q), 1e-12) << c.name;
    for (double& p : turned) p = 0;
    for (std::size_t a = 0; a < c.p.size(); ++a) turned[a] = -back.momentum_end[a];
    EXPECT_LT(largest_difference(turned, c.p), 1e-12) << c.name;
  }
}

/// Columns (δq, δp) at the end, by differences; exact for a linear flow.
std::vector<Values> linearised(const Problem& problem, const SolveOptions& options, double size) {
  const std::size_t n = problem.coordinates();
  std::vector<Values> columns;
  for (std::size_t k = 0; k < 2 * n; ++k) {
    const auto end = [&](double change) {
      Problem moved = problem;
      (k < n ? moved.initial->q[k] : moved.initial->p[k - n]) += change;
      const Solution s =
          solve(from(moved.lagrangian, moved.initial->q, moved.initial->p, moved.duration.value), options);
      Values state = node(s.trajectory, options.elements);
      state.insert(state.end(), s.momentum_end.begin(), s.momentum_end.end());
      return state;
    };
    const Values ahead = end(size), behind = end(-size), far = end(2 * size), rear = end(-2 * size);
    Values column(2 * n);
    for (std::size_t i = 0; i < 2 * n; ++i)
      column[i] = (8 * (ahead[i] - behind[i]) - (far[i] - rear[i])) / (12 * size);
    columns.push_back(column);
  }
  return columns;
}

double symplectic_defect(const std::vector<Values>& m) {
  const std::size_t n = m.size() / 2;
  double defect = 0;
  for (std::size_t i = 0; i < 2 * n; ++i)
    for (std::size_t j = 0; j < 2 * n; ++j) {
      double form = 0;
      for (std::size_t a = 0; a < n; ++a) form += m[i][a] * m[j][n + a] - m[i][n + a] * m[j][a];
      const double expected = j == i + n ? 1 : i == j + n ? -1 : 0;
      defect = std::max(defect, std::abs(form - expected));
    }
  return defect;
}

TEST_P(Marching, IsSymplectic) {
  const auto linear = marched_system(
      {"x", "y"}, "x'^2/2 + y'^2 + 0.3*x'*y' + 0.7*(x*y' - y*x') - x^2 - 0.6*y^2 + 0.4*x*y + 0.2*x'*y");
  const SolveOptions options = pinned(tested, 7);
  // Differences of a linear flow are exact whatever their size.
  EXPECT_LT(symplectic_defect(linearised(from(linear, {0, 0}, {0, 0}, 3), options, 1)), 2e-14);
  for (const MotionCase& c : motion_cases())
    EXPECT_LT(symplectic_defect(linearised(from(c), pinned(tested, c.elements), 3e-4)), 2e-9) << c.name;
}

TEST_P(Marching, ConservesAngularMomentum) {
  const Problem problem = from(systems::kepler(), {1, 0}, {0, 1.1}, 100);
  const Solution motion = solve(problem, pinned(tested, 2000));
  const Values q = node(motion.trajectory, 2000);
  EXPECT_NEAR(q[0] * motion.momentum_end[1] - q[1] * motion.momentum_end[0], 1.1, 1e-13);
}

std::vector<std::string> tested_names() {
  std::vector<std::string> list;
  for (const Scheme& s : schemes_and_families()) list.push_back(s.name);
  return list;
}
INSTANTIATE_TEST_SUITE_P(Schemes, Marching, ::testing::ValuesIn(tested_names()), [](const auto& info) {
  std::string name;
  for (const char c : info.param)
    if (std::isalnum(static_cast<unsigned char>(c))) name += c;
  return name;
});

/// q_{k+1} + q_{k−1} = 2 cos θ q_k.
double discrete_cosine(const char* name, double z) {
  const int elements = 1000;
  const Solution s =
      solve(from(systems::oscillator(1), {0.7}, {0.2}, elements * z), pinned(scheme(name), elements));
  double above = 0, below = 0;
  for (int k = 1; k < elements; ++k) {
    const double q = node(s.trajectory, k)[0];
    above += q * (node(s.trajectory, k + 1)[0] + node(s.trajectory, k - 1)[0]);
    below += q * q;
  }
  return above / (2 * below);
}

TEST(MarchedMotion, HasTheFrequenciesOfItsScheme) {
  for (const double z : {0.1, 0.5, 1.3}) {
    const double square = z * z;
    EXPECT_NEAR(discrete_cosine("rectangle", z), 1 - square / 2, 1e-13);
    EXPECT_NEAR(discrete_cosine("rectangle-right", z), 1 - square / 2, 1e-13);
    EXPECT_NEAR(discrete_cosine("trapezoid", z), 1 - square / 2, 1e-13);
    EXPECT_NEAR(discrete_cosine("midpoint", z), std::cos(2 * std::atan(z / 2)), 1e-13);
    EXPECT_NEAR(discrete_cosine("linear", z), (1 - square / 3) / (1 + square / 6), 1e-13);
  }
}

TEST(MarchedMotion, StaysNearTheEnergyForLong) {
  const Problem problem = from(systems::henon_heiles(), {0, 0.1}, {0.35, 0.1}, 1e4);
  const Solution early = solve(from(systems::henon_heiles(), {0, 0.1}, {0.35, 0.1}, 1e2),
                               pinned(scheme("midpoint"), 1000)),
                 late = solve(problem, pinned(scheme("midpoint"), 100000));
  EXPECT_LT(*late.energy_drift, 1.5 * *early.energy_drift);
}

double henon_heiles_energy(const Solution& s) {
  const Values q = node(s.trajectory, s.trajectory.elements()), &p = s.momentum_end;
  return (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1]) / 2 + q[0] * q[0] * q[1] -
         q[1] * q[1] * q[1] / 3;
}

/// The random walk of 10⁵ roundings, not their sum.
TEST(MarchedMotion, RoundoffDoesNotDrift) {
  LONG_TEST();
  const Problem problem = from(systems::henon_heiles(), {0, 0.1}, {0.35, 0.1}, 1e5);
  EXPECT_NEAR(henon_heiles_energy(solve(problem, pinned(scheme("gauss(8)"), 120000))),
              0.35 * 0.35 / 2 + 0.01 - 1e-3 / 3, 1.5e-14);
}

/// Truth by integration in extended precision is not to be had here: by the tightest march, and by DOP853.
TEST(MarchedMotion, ErrorEstimateIsHonest) {
  const std::vector<MotionCase> cases = {
      {"pendulum near its separatrix", systems::pendulum(), {3.1}, {0.01}, 40, 0},
      {"Kepler, e = 0.9", systems::kepler(), {0.1, 0}, {0, std::sqrt(19.0)}, 30, 0},
      {"double pendulum", systems::double_pendulum(), {1.5, 1.4}, {0, 0}, 5, 0},
      {"Henon-Heiles", systems::henon_heiles(), {0, -0.1}, {0.5, 0.1}, 100, 0},
      {"restricted three bodies", systems::restricted_three_body(), {0.3, 0, 0.1}, {0, 1.2, 0.05}, 6, 0},
      {"magnetic", systems::magnetic(), {0.3, -0.2}, {0.4, 0.5}, 4, 0},
      {"driven", systems::driven(), {0.3}, {0.4}, 8, 0},
      {"doubled", damped_and_driven(), {0.3, 0.1}, {0.4, -0.2}, 30, 0}};
  for (const MotionCase& c : cases) {
    const Solution truth = solve(from(c), within(1e-12));
    const Values end = node(truth.trajectory, truth.trajectory.elements());
    EXPECT_LT(largest_difference(integrated(from(c), c.duration), end), 2e-9 * (1 + largest(end))) << c.name;
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
      const Solution s = solve(from(c), within(tolerance));
      double error = 0, speed_error = 0, momentum_error = 0;
      Values least, most, slow, fast, low, high;
      Scratch scratch;
      for (int i = 0; i <= 2000; ++i) {
        const double t = c.duration * i / 2000;
        const State found = at(s.trajectory, t), exact = at(truth.trajectory, t);
        const Values p = evaluate_at(*c.lagrangian, found.q, found.v, t, Order::gradient, scratch).dv,
                     r = evaluate_at(*c.lagrangian, exact.q, exact.v, t, Order::gradient, scratch).dv;
        error = std::max(error, largest_difference(found.q, exact.q));
        speed_error = std::max(speed_error, largest_difference(found.v, exact.v));
        momentum_error = std::max(momentum_error, largest_difference(p, r));
        const auto widen = [i](Values& lower, Values& upper, const Values& x) {
          if (i == 0) lower = upper = x;
          for (std::size_t a = 0; a < x.size(); ++a) {
            lower[a] = std::min(lower[a], x[a]);
            upper[a] = std::max(upper[a], x[a]);
          }
        };
        widen(least, most, exact.q);
        widen(slow, fast, exact.v);
        widen(low, high, r);
      }
      EXPECT_LT(error, tolerance * largest_difference(least, most)) << c.name << ' ' << tolerance;
      EXPECT_LT(speed_error, 10 * tolerance * largest_difference(slow, fast)) << c.name << ' ' << tolerance;
      EXPECT_LT(momentum_error, 10 * tolerance * largest_difference(low, high)) << c.name << ' ' << tolerance;
      EXPECT_LT(s.error_estimate, 10 * error) << c.name << ' ' << tolerance;
      EXPECT_GT(s.error_estimate, 0.1 * error) << c.name << ' ' << tolerance;
    }
  }
}

TEST(MarchedMotion, PinnedErrorIsHonest) {
  for (const MotionCase& c : motion_cases()) {
    const Solution truth = solve(from(c), within(1e-13));
    for (const char* name : {"rectangle", "midpoint", "linear", "quadratic", "gauss(3)", "lobatto(4)"})
      for (const int elements : {20, 100, 500}) {
        const Solution s = solve(from(c), pinned(scheme(name), elements));
        const double error = sup_distance(s.trajectory, truth.trajectory, 3000);
        if (error < 2e-13) continue;
        EXPECT_LT(s.error_estimate, 10 * error) << c.name << ' ' << name << ' ' << elements;
        EXPECT_GT(s.error_estimate, 0.1 * error) << c.name << ' ' << name << ' ' << elements;
      }
  }
}

TEST(MarchedMotion, SchemeAloneMeetsTheTolerance) {
  for (const char* name : {"midpoint", "lobatto(4)"}) {
    SolveOptions options = within(1e-5);
    options.scheme = scheme(name);
    const MotionCase c = motion_cases().front();
    const Solution s = solve(from(c), options), truth = solve(from(c), within(1e-12));
    EXPECT_LT(sup_distance(s.trajectory, truth.trajectory), 1e-5 * 1.6);
    EXPECT_EQ(s.degree, scheme(name).degree);
    // Slopes of elements of degree one are of order one, velocities of their momenta of order two.
    double apart = 0, low = INFINITY, high = -INFINITY;
    std::vector<double> q(s.trajectory.coordinates), v(q), exact(q);
    for (int k = 0; k <= 1000; ++k) {
      const double t = s.duration() * k / 1000;
      s.trajectory.at(t, q, v);
      truth.trajectory.at(t, q, exact);
      low = std::min(low, exact[0]);
      high = std::max(high, exact[0]);
      apart = std::max(apart, std::abs(v[0] - exact[0]));
    }
    EXPECT_LT(apart, 10 * 1e-5 * (high - low));
  }
}

TEST(MarchedMotion, DampedBesideItsMirrorImage) {
  const Solution s = solve(from(damped_and_driven(), {1, 0}, {0.2, -0.1}, 20), within(1e-10));
  // p_x = y' − c y/2, p_y = x' + c x/2 with c = 0.2: x' = −0.1 − 0.1 at the start.
  const double omega = std::sqrt(0.99);
  EXPECT_LT(distance(s.trajectory,
                     [&](double t) {
                       const double x = std::exp(-0.1 * t) *
                                        (std::cos(omega * t) + (-0.2 + 0.1) / omega * std::sin(omega * t));
                       const double y = std::exp(0.1 * t) * 0.2 / omega * std::sin(omega * t);
                       return Values{x, y};
                     }),
            1e-10 * 3);
}

TEST(MarchedMotion, EndsElementsOnKinks) {
  const auto lagrangian = marched_system({"x"}, "x'^2/2 - abs(x)");
  for (const double tolerance : {1e-4, 1e-8, 1e-12}) {
    const Solution s = solve(from(lagrangian, {1}, {-0.5}, 60), within(tolerance));
    // Ten periods of parabolas, which elements of any length hold exactly: errors are those of the times of
    // kinks.
    const double allowed = std::min(2.25 * tolerance, 1e-10);
    EXPECT_NEAR(node(s.trajectory, s.trajectory.elements())[0], 1, allowed);
    EXPECT_NEAR(s.momentum_end[0], -0.5, allowed);
    EXPECT_LT(s.trajectory.elements(), 200);
  }
  const Solution pushed =
      solve(from(marched_system({"x"}, "x'^2/2 + x*step(t - 1)"), {0}, {1}, 3), within(1e-9));
  EXPECT_NEAR(node(pushed.trajectory, pushed.trajectory.elements())[0], 5, 1e-12);
}

/// x'' = −sgn x + 0.3 sin t in closed form between the zeros of x, which bisection finds.
double driven_between_kinks(double x, double duration) {
  double v = 0, t = 0, side = -1;
  for (;;) {
    const auto at = [&](double s) {
      return x + (v + 0.3 * std::cos(t)) * (s - t) + side * (s - t) * (s - t) / 2 -
             0.3 * (std::sin(s) - std::sin(t));
    };
    double before = t + 1e-3, after = before;
    while (after < duration && (at(after) > 0) == (at(before) > 0)) after = std::min(after + 1e-3, duration);
    if ((at(after) > 0) == (at(before) > 0)) return at(duration);
    before = after - 1e-3;
    for (int k = 0; k < 60; ++k) {
      const double middle = (before + after) / 2;
      ((at(middle) > 0) == (side < 0) ? before : after) = middle;
    }
    v += side * (after - t) + 0.3 * (std::cos(t) - std::cos(after));
    x = 0;
    t = after;
    side = -side;
  }
}

/// Where a kink is crossed the force jumps, which elements that end there do not overlook.
/// ∂²L/∂q'² vanishes at rest; with the momentum 1 the motion begins with the velocity 1.
TEST(MarchedMotion, BeginsWhereRestIsDegenerate) {
  const Solution s = solve(from(marched_system({"x"}, "x'^4/4 - x^2/2"), {0}, {1}, 1), within(1e-10));
  ASSERT_TRUE(s.converged()) << s.message;
  Values q(1), v(1);
  for (const double t : {0.0, 0.3, 1.0}) {
    s.trajectory.at(t, q, v);
    EXPECT_NEAR(0.75 * std::pow(v[0], 4) + q[0] * q[0] / 2, 0.75, 1e-9) << t;
    EXPECT_GT(v[0], 0.5) << t;
  }
}

/// A mass that doubles at t = 0.7: the momentum is continuous, the velocity jumps.
TEST(MarchedMotion, VelocitiesJumpWithTheMass) {
  const Problem problem = from(marched_system({"x"}, "x'^2*(1 + step(t - 0.7))/2 - x^2/2"), {0.4}, {0.3}, 3);
  const Solution s = solve(problem, within(1e-11));
  ASSERT_TRUE(s.converged()) << s.message;
  const double c = std::cos(0.7), sine = std::sin(0.7), x = 0.4 * c + 0.3 * sine, p = 0.3 * c - 0.4 * sine,
               w = std::sqrt(0.5);
  Values q(1), v(1);
  s.trajectory.at(3, q, v);
  EXPECT_NEAR(q[0], x * std::cos(w * 2.3) + p / (2 * w) * std::sin(w * 2.3), 1e-11);
  s.trajectory.at(0.7 - 1e-9, q, v);
  EXPECT_NEAR(v[0], p, 1e-8);
  s.trajectory.at(0.7 + 1e-9, q, v);
  EXPECT_NEAR(v[0], p / 2, 1e-8);
}

TEST(MarchedMotion, CrossesKinksUnderADrive) {
  const auto lagrangian = marched_system({"x"}, "x'^2/2 - abs(x) + 0.3*x*sin(t)");
  for (const double duration : {5.0, 10.0, 30.0}) {
    const Solution s = solve(from(lagrangian, {0.7}, {0}, duration), within(1e-9));
    ASSERT_TRUE(s.converged()) << s.message;
    EXPECT_NEAR(node(s.trajectory, s.trajectory.elements())[0], driven_between_kinks(0.7, duration), 5e-9);
    EXPECT_LT(s.trajectory.elements(), 100);
  }
}

/// x = 0 at 8 thousandths before a jump of the square wave at π; forces are constant in between.
TEST(MarchedMotion, EndsOnTheFirstOfTwoKinksThatAreNear) {
  const auto lagrangian = marched_system({"x"}, "x'^2/2 - abs(x) + x*(2*step(sin(3*t)) - 1)/2");
  const Solution s = solve(from(lagrangian, {0.3}, {0.1}, 20), within(1e-9));
  ASSERT_TRUE(s.converged()) << s.message;
  // Parabolas between zeros of x and multiples of π/3.
  double x = 0.3, v = 0.1, t = 0;
  for (int wave = 0; t < 20;) {
    const double side = x > 0 || (x == 0 && v > 0) ? -1 : 1, force = side + (wave % 2 == 0 ? 0.5 : -0.5);
    const double jump = std::min(20.0, (wave + 1) * pi / 3), root = std::sqrt(v * v - 2 * force * x);
    double zero = INFINITY;
    for (const double r : {(-v - root) / force, (-v + root) / force})
      if (r > 1e-9) zero = std::min(zero, r);
    const bool crosses = t + zero < jump;
    const double h = crosses ? zero : jump - t;
    x = crosses ? 0 : x + v * h + force * h * h / 2;
    v += force * h;
    t += h;
    wave += !crosses;
  }
  EXPECT_NEAR(node(s.trajectory, s.trajectory.elements())[0], x, 1e-9);
}

/// The impulse 0.1 √π at t = 5, a thousandth wide.
TEST(MarchedMotion, FindsForcesBetweenThePointsOfElements) {
  const auto lagrangian = marched_system({"x"}, "x'^2/2 - x^2/2 + 100*x*exp(-((t - 5)/1e-3)^2)");
  const double end = std::cos(10) + 0.1 * std::sqrt(pi) * std::sin(5);
  const Solution s = solve(from(lagrangian, {1}, {0}, 10), within(1e-7));
  EXPECT_NEAR(node(s.trajectory, s.trajectory.elements())[0], end, 1e-6);
  const Solution coarse = solve(from(lagrangian, {1}, {0}, 10), pinned(scheme("midpoint"), 500));
  EXPECT_GT(coarse.error_estimate, 0.1);
}

/// Ranges of velocities that vanish, and momenta that grow while coordinates decay.
TEST(MarchedMotion, UniformAndDamped) {
  const Solution uniform = solve(from(marched_system({"x"}, "x'^2/2"), {1}, {2}, 10), within(1e-12));
  EXPECT_NEAR(node(uniform.trajectory, uniform.trajectory.elements())[0], 21, 1e-13);
  const Solution damped =
      solve(from(marched_system({"x"}, "exp(t)*(x'^2 - x^2)/2"), {1}, {0}, 30), within(1e-9));
  const double omega = std::sqrt(0.75);
  const double speed = -std::exp(-15.0) / omega * std::sin(omega * 30);
  EXPECT_NEAR(damped.momentum_end[0], std::exp(30.0) * speed, 1e-8 * std::exp(15.0));
}

/// The midpoint rule conserves the energy of an oscillator, which is (v² + ω² q²)/2 at the middle of each
/// element.
TEST(MarchedMotion, ElementsHaveTheirEnergies) {
  const Solution s =
      solve(from(marched_system({"x"}, "(x'^2 - x^2)/2"), {1}, {0}, 10), pinned(scheme("midpoint"), 40));
  ASSERT_EQ(s.element_energies.size(), 40u);
  const double h = 0.25, energy = 0.5 / (1 + h * h / 4);
  for (const double found : s.element_energies) EXPECT_NEAR(found, energy, 1e-14);
  const Solution adaptive = solve(from(marched_system({"x"}, "(x'^2 - x^2)/2"), {1}, {0}, 10), within(1e-9));
  EXPECT_TRUE(adaptive.element_energies.empty());
}

/// Störmer-Verlet steps exist however large the force is at their ends: what its rounding leaves of the
/// equations of the start is no failure.
TEST(MarchedMotion, ExplicitStepsExistForAnyForce) {
  const double h = 1.7;
  Values x{2.5, 2.5 - h * h / 2 * std::pow(2.5, 3)};
  x.push_back(2 * x[1] - x[0] - h * h * std::pow(x[1], 3));
  const Solution s = solve(from(marched_system({"x"}, "x'^2/2 - x^4/4"), {x[0]}, {0}, 2 * h),
                           pinned(scheme("trapezoid"), 2));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(node(s.trajectory, k)[0], x[k], 1e-5 * std::abs(x[k]));
}

TEST(MarchedMotion, AtRestStaysThere) {
  for (const char* name : {"midpoint", "gauss(3)"}) {
    const Solution s = solve(from(systems::pendulum(), {0}, {0}, 10), pinned(scheme(name), 10));
    EXPECT_EQ(node(s.trajectory, 10)[0], 0);
  }
  const Solution s = solve(from(systems::pendulum(), {0}, {0}, 10), within(1e-9));
  EXPECT_EQ(node(s.trajectory, s.trajectory.elements())[0], 0);
}

TEST(MarchedMotion, CollisionIsTold) {
  // From rest at 1: r = 0 at t = π/(2√2).
  for (const bool scheme_given : {false, true}) {
    const Problem problem = from(systems::kepler(), {1, 0}, {0, 0}, 3);
    Solver solver;
    const Solution s = solver.solve(problem, scheme_given ? pinned(scheme("midpoint"), 100) : within(1e-8));
    EXPECT_EQ(s.status, Status::collision) << s.message;
    EXPECT_NE(s.message.find(fmt::format("t = {:.6g}", pi / (2 * std::sqrt(2.0)))), std::string::npos)
        << s.message;
  }
}

TEST(MarchedMotion, TellsUntilWhenRoundoffAllowsTheTolerance) {
  const Problem problem = from(systems::henon_heiles(), {0, -0.1}, {0.55, 0.1}, 2000);
  Solver solver;
  const Solution s = solver.solve(problem, within(1e-8));
  EXPECT_EQ(s.status, Status::not_converged);
  EXPECT_NE(s.message.find("amplifies roundoff"), std::string::npos) << s.message;
  const std::size_t at = s.message.find("holds until t = ");
  ASSERT_NE(at, std::string::npos) << s.message;
  const double until = std::stod(s.message.substr(at + 16));
  EXPECT_GT(until, 100);
  EXPECT_LT(until, 400);
  EXPECT_NE(s.message.find("coordinates are known to"), std::string::npos) << s.message;
}

TEST(MarchedMotion, TooFewElementsAreRefused) {
  // e^q grows without bound: no root of the discrete equation over long elements.
  const Problem problem = from(systems::bratu(-1), {0}, {0}, 2);
  Solver solver;
  const Solution s = solver.solve(problem, pinned(scheme("midpoint"), 1));
  EXPECT_EQ(s.status, Status::not_converged);
  EXPECT_NE(s.message.find("raise solve.elements"), std::string::npos) << s.message;
}

/// Over long elements the equations have several solutions: an element of 400 has seven. The one that the
/// motion tends to keeps it between the turning points 0 and 2; one of 300 has none near the motion.
TEST(MarchedMotion, TakesTheSolutionNearTheMotion) {
  const Problem problem = from(marched_system({"x"}, "x'^2*(1 + x^2)/2 - 1e4*(x - 1)^2/2"), {0}, {0}, 5);
  const Solution exact = solve(problem, within(1e-10)), s = solve(problem, pinned(scheme("gauss(3)"), 400));
  ASSERT_TRUE(exact.converged()) << exact.message;
  ASSERT_TRUE(s.converged()) << s.message;
  Values q(1), near(1), v(1);
  for (const double t : s.trajectory.times) {
    s.trajectory.at(t, q, v);
    exact.trajectory.at(t, near, v);
    EXPECT_NEAR(q[0], near[0], 0.1) << t;
  }
  Solver solver;
  const Solution none = solver.solve(problem, pinned(scheme("gauss(2)"), 300));
  EXPECT_EQ(none.status, Status::not_converged);
  EXPECT_NE(none.message.find("no solution near the motion"), std::string::npos) << none.message;
}

TEST(MarchedMotion, LatticesOfManyCoordinates) {
  const int n = 60;
  const auto chain =
      compile({.coordinates = {"q[n]"},
               .parameters = {{"n", {.value = {double(n)}}}},
               .lagrangian = "sum(i, 1, n, q[i]'^2/2) - sum(i, 1, n - 1, (q[i+1] - q[i])^2/2 + "
                             "(q[i+1] - q[i])^4/4) - (q[1]^2 + q[n]^2)/2"})
          .lagrangian;
  Values q(n), p(n);
  for (int i = 0; i < n; ++i) q[i] = std::sin(pi * (i + 1) / (n + 1));
  const Solution s = solve(from(chain, q, p, 30), within(1e-8));
  EXPECT_LT(
      largest_difference(fly(*chain, q, p, Values{30}, 1e-13).q, node(s.trajectory, s.trajectory.elements())),
      2e-8);
  const Solution verlet = solve(from(chain, q, p, 30), pinned(scheme("trapezoid"), 600));
  EXPECT_LT(verlet.residual, 1e-14);
  EXPECT_LT(largest_difference(node(verlet.trajectory, 600), node(s.trajectory, s.trajectory.elements())),
            2e-2);
}

/// Displacements far below roundoff of others are those of roundoff, in the first element too: a chain whose
/// pulse falls to 1e-200 at its pulled and damped end.
TEST(MarchedMotion, TailsBelowAllRoundoffStopNothing) {
  const int n = 48;
  const auto chain =
      compile({.coordinates = {"q[n]"},
               .parameters = {{"n", {.value = {double(n)}}}},
               .lagrangian = "sum(i, 1, n, q[i]'^2/2 - q[i]^2/3) - sum(i, 1, n - 1, (q[i+1] - q[i])^2/2)"
                             " + 0.2*sin(3*t + 1)*q[1] - 0.1*q[1]*q[2]'"})
          .lagrangian;
  Values q(n), p(n);
  for (int i = 0; i < n; ++i) q[i] = 0.4 * std::exp(-std::pow((i + 1 - 24) / 1.08, 2));
  const Solution s = solve(from(chain, q, p, 3), within(1e-9));
  EXPECT_LE(s.trajectory.elements(), 40);
  EXPECT_LT(
      largest_difference(fly(*chain, q, p, Values{3}, 1e-13).q, node(s.trajectory, s.trajectory.elements())),
      1e-9);
}

/// Where a motion has no element the message names the place and the reason, and comes soon.
TEST(MarchedMotion, TellsWhatStopsIt) {
  const auto message = [](const Problem& problem) {
    Solver solver;
    SolveOptions options = within(1e-9);
    const Solution s = solver.solve(problem, options);
    EXPECT_FALSE(s.converged());
    EXPECT_LT(s.seconds_solve, 3);
    return s.message;
  };
  const auto expect = [](const std::string& found, const char* part) {
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  const auto jumping = marched_system({"x"}, "x'^2/2 + 0.2*abs(x') - x^2/2");
  expect(message(from(jumping, {0.3}, {0.1}, 2)), "no velocity with these momenta at");
  expect(message(from(jumping, {0}, {0.9}, 4)), "a kink of abs, min or max");
  expect(message(from(marched_system({"x"}, "x'^2/2 - sqrt(x)"), {0}, {0}, 4)),
         "has no derivative, at q[1] = 0");
  expect(message(from(marched_system({"x"}, "x'^2/2 - 1/x"), {0}, {1}, 4)), "L is not finite at q[1] = 0");
}

/// A ball on a floor whose stiffness is infinite at first: x'' = −1 + 1.5 k (−x)^0.5.
TEST(MarchedMotion, MeetsKinksWithInfiniteCurvature) {
  const auto ball = marched_system({"x"}, "x'^2/2 - x - 200*max(0, -x)^1.5");
  const Solution s = solve(from(ball, {1}, {0}, 4), within(1e-8));
  EXPECT_LT(*s.energy_drift, 1e-7);
}

/// Beads that touch with the force of a power of their overlap, and part: compared with a motion of a much
/// smaller tolerance.
TEST(MarchedMotion, KeepsItsToleranceAcrossPowersOfKinks) {
  for (const char* power : {"2.2", "2.5", "3"}) {
    const auto beads =
        marched_system({"x", "y", "z"}, std::string("(x'^2 + y'^2 + z'^2)/2 - max(0, 0.1 + x - y)^") + power +
                                            " - max(0, 0.1 + y - z)^" + power + " - z^2/2");
    const Solution s = solve(from(beads, {0, 0, 0}, {0.6, 0, 0}, 9), within(1e-7)),
                   better = solve(from(beads, {0, 0, 0}, {0.6, 0, 0}, 9), within(1e-9));
    const double error = largest_difference(node(s.trajectory, s.trajectory.elements()),
                                            node(better.trajectory, better.trajectory.elements()));
    EXPECT_LT(error, 1e-6) << power;
    EXPECT_LT(error, 10 * s.error_estimate) << power;
  }
}

/// Far more elements than can be kept are not followed until there is no room for them.
TEST(MarchedMotion, FarTooLongIsToldSoon) {
  const Problem problem = from(marched_system({"x"}, "x'^2/2 - 1e10*x^2/2"), {1}, {0}, 1e6);
  Solver solver;
  const Solution s = solver.solve(problem, within(1e-9));
  EXPECT_FALSE(s.converged());
  EXPECT_NE(s.message.find("oscillations"), std::string::npos) << s.message;
  EXPECT_LT(s.seconds_solve, 5);
}

}  // namespace
}  // namespace extremal::laws
