#include <complex>
#include <numbers>

#include "solve/scenes.hpp"
#include "study/phase.hpp"

/// \file A tolerance is kept, and the error estimate honest, on scenes whose solutions are known.

namespace extremal::laws {
namespace {

/// Errors relative to the largest range (max − min) among the coordinates, velocities, momenta.
struct Errors {
  double q = 0, v = 0, p = 0;
  double absolute = 0;   ///< of q, in its own units
  double magnitude = 0;  ///< largest |q|
};

/// ∂L/∂q' of states on the way.
std::vector<Values> momenta(const Problem& problem, const Table& table) {
  const int n = problem.coordinates();
  std::vector<Values> result;
  Scratch scratch;
  for (std::size_t i = 0; i < table.t.size(); ++i) {
    // A straight line through the state: one element in which q and q' are those asked for.
    const State& state = table.states[i];
    Trajectory line{.coordinates = n, .degree = 1, .times = {0, 2}, .nodes = {}};
    for (double side : {-1.0, 1.0})
      for (int a = 0; a < n; ++a) line.nodes.push_back(state.q[a] + side * state.v[a]);
    Values q(n), v(n), p(n);
    phase_point(problem, line, 1, q, v, p, scratch);
    result.push_back(p);
  }
  return result;
}

double largest_range(const std::vector<Values>& points) {
  double result = 0;
  for (std::size_t a = 0; a < points[0].size(); ++a) {
    double low = points[0][a], high = low;
    for (const Values& point : points) low = std::min(low, point[a]), high = std::max(high, point[a]);
    result = std::max(result, high - low);
  }
  return result;
}

Errors errors(const Problem& problem, const Solution& solution, const Table& truth) {
  const std::size_t n = problem.coordinates();
  const std::vector<Values> true_p = momenta(problem, truth);
  std::vector<Values> true_q, true_v;
  Values q(n), v(n), p(n);
  Scratch scratch;
  Errors e;
  for (std::size_t i = 0; i < truth.t.size(); ++i) {
    phase_point(problem, solution.trajectory, std::min(truth.t[i], solution.duration()), q, v, p, scratch);
    e.absolute = std::max(e.absolute, largest_difference(q, truth.states[i].q));
    e.v = std::max(e.v, largest_difference(v, truth.states[i].v));
    e.p = std::max(e.p, largest_difference(p, true_p[i]));
    for (double x : truth.states[i].q) e.magnitude = std::max(e.magnitude, std::abs(x));
    true_q.push_back(truth.states[i].q);
    true_v.push_back(truth.states[i].v);
  }
  e.q = e.absolute / largest_range(true_q);
  e.v /= largest_range(true_v);
  e.p /= largest_range(true_p);
  return e;
}

class Accuracy : public ::testing::TestWithParam<const char*> {};

TEST_P(Accuracy, MeetsEveryToleranceAndEstimatesItsError) {
  const std::string name = GetParam();
  const Study study = load(bench_data(name + ".toml"));
  const Table truth = read_table(bench_data(name + ".csv"), study.problem.coordinates());
  Solver solver;
  int far = 0;
  for (int digits = 3; digits <= 13; ++digits) {
    SolveOptions options = study.options;
    options.tolerance = std::pow(10.0, -digits);
    const Solution s = solver.solve(study.problem, counted(options));
    ASSERT_TRUE(s.converged()) << options.tolerance << ": " << s.message;
    const Errors e = errors(study.problem, s, truth);
    EXPECT_LE(e.q, options.tolerance) << "q at " << options.tolerance;
    EXPECT_LE(e.v, 10 * options.tolerance) << "q' at " << options.tolerance;
    EXPECT_LE(e.p, 10 * options.tolerance) << "p at " << options.tolerance;
    // Truth and sample are rounded, each by half a unit in the last place of q.
    const double rounding = 0x1p-52 * e.magnitude;
    EXPECT_LE(s.error_estimate, 100 * (e.absolute + rounding)) << "estimate at " << options.tolerance;
    EXPECT_GE(s.error_estimate, 0.01 * (e.absolute - rounding)) << "estimate at " << options.tolerance;
    far +=
        s.error_estimate > 10 * (e.absolute + rounding) || s.error_estimate < 0.1 * (e.absolute - rounding);
  }
  EXPECT_LE(far, 1) << "estimates further than a factor 10 from the error";
}

INSTANTIATE_TEST_SUITE_P(Scenes, Accuracy,
                         ::testing::Values("pendulum-short", "pendulum-long", "kepler-arc",
                                           "kepler-eccentric", "double-pendulum-1", "double-pendulum-3",
                                           "henon-heiles-10", "henon-heiles-60", "halo-half", "lyapunov-half",
                                           "nrho-half", "fpu-32"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// Without cancellation in the residuals, the initial momentum is right to the last digits.
TEST(AccuracyKepler, MomentumToTheLastDigits) {
  const Study study = load(bench_data("kepler-arc.toml"));
  const Table truth = read_table(bench_data("kepler-arc.csv"), 2);
  SolveOptions options = study.options;
  options.tolerance = 1e-14;
  const Solution s = Solver().solve(study.problem, options);
  ASSERT_TRUE(s.converged()) << s.message;
  const Values v = truth.states[0].v;
  EXPECT_LE(largest_difference(s.momentum_start, v), 2e-15 * std::hypot(v[0], v[1]));
  EXPECT_LE(largest_difference(s.momentum_end, truth.states.back().v), 2e-15 * std::hypot(v[0], v[1]));
}

/// A slow body far out in a frame that rotates: z = (a + bt) e^−it, where z = x + iy, and p_x + i p_y = b
/// e^−it. Momenta have a 50,000th of the range of the velocities, and a tolerance of their own.
TEST(AccuracyInARotatingFrame, OfMomentaByTheirOwnRange) {
  using Complex = std::complex<double>;
  const auto frame = trace(2, [](auto q, auto v, auto) {
    const auto a = v[0] - q[1], b = v[1] + q[0];
    return (a * a + b * b) / 2;
  });
  const double T = 4, tolerance = 1e-6, drift = 2e-4;
  const auto exact = [&](double t) { return Complex(10 + drift * t, 0.2 * drift * t) * std::polar(1.0, -t); };
  const Problem problem =
      fixed_ends(frame, {exact(0).real(), exact(0).imag()}, {exact(T).real(), exact(T).imag()}, T);
  const Solution s = Solver().solve(problem, within(tolerance));
  ASSERT_TRUE(s.converged()) << s.message;
  double error = 0;
  for (int i = 0; i <= 200; ++i) {
    const double t = T * i / 200;
    Values q(2), v(2);
    s.trajectory.at(t, q, v);
    const Complex p = Complex(drift, 0.2 * drift) * std::polar(1.0, -t);
    error = std::max(error, std::abs(Complex(v[0] - q[1], v[1] + q[0]) - p));
  }
  EXPECT_LE(error, 10 * tolerance * 2 * drift);
}

/// A circular arc of `angle` in the plane of the ends, turned about r1 × r2, or about its opposite where the
/// angle exceeds π.
Guess arc(const Values& r1, const Values& r2, double angle) {
  const auto length = [](const Values& r) { return std::hypot(r[0], r[1], r[2]); };
  const double a = length(r1), b = length(r2);
  const double cosine = (r1[0] * r2[0] + r1[1] * r2[1] + r1[2] * r2[2]) / (a * b);
  const double sine = std::sqrt(1 - cosine * cosine) * (angle > std::numbers::pi ? -1 : 1);
  Guess guess;
  for (int i = 0; i <= 100; ++i) {
    const double tau = i / 100.0, turn = tau * angle, r = a + tau * (b - a);
    guess.tau.push_back(tau);
    for (int k = 0; k < 3; ++k) {
      const double e1 = r1[k] / a, e2 = (r2[k] / b - cosine * e1) / sine;
      guess.q.push_back(r * (std::cos(turn) * e1 + std::sin(turn) * e2));
    }
  }
  return guess;
}

class Lambert : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const nlohmann::json c = published("lambert.json", GetParam());
    const nlohmann::json& boundary = c.at("boundary");
    const double mu = decimal(c.at("parameters").at("mu"));
    const Values r1 = decimals(boundary.at("r1")), r2 = decimals(boundary.at("r2"));
    duration = decimal(boundary.at("time_of_flight"));
    v1 = decimals(c.at("refined").at("v1"));
    v2 = decimals(c.at("refined").at("v2"));
    energy = decimal(c.at("refined").at("specific_energy"));
    const auto lagrangian = trace(3, [=](auto q, auto v, auto) {
      return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 +
             mu / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    });
    problem = fixed_ends(lagrangian, r1, r2, duration);
    problem.guess = arc(r1, r2, decimal(boundary.at("transfer_angle_deg")) * std::numbers::pi / 180);
    problem = make_problem(problem);
  }
  void expect_velocities(const Solution& s) {
    const double speed = std::max(largest(v1), largest(v2));
    EXPECT_LE(largest_difference(s.momentum_start, v1), 1e-10 * speed);
    EXPECT_LE(largest_difference(s.momentum_end, v2), 1e-10 * speed);
  }

  Problem problem;
  Values v1, v2;
  double duration = 0, energy = 0;
};

TEST_P(Lambert, VelocitiesOfThePublishedArc) {
  const Solution s = solve(problem, within(1e-12));
  expect_velocities(s);
  EXPECT_NEAR(*s.energy, energy, 1e-10 * std::abs(energy));
}

/// The same arc with its energy given and its duration unknown. Two arcs have that energy, often close
/// together: the guess is near.
TEST_P(Lambert, DurationFromTheEnergy) {
  Problem open = guided(problem);
  open.duration = {.value = 1.0001 * duration, .free = true, .energy = energy, .where = {}};
  const Solution s = solve(make_problem(open), within(1e-12));
  EXPECT_NEAR(s.duration(), duration, 1e-10 * duration);
  expect_velocities(s);
}

INSTANTIATE_TEST_SUITE_P(Cases, Lambert,
                         ::testing::Values("lambert-curtis-5-2", "lambert-der-I-retrograde",
                                           "lambert-bmw-5-3-1-short", "lambert-vallado-7-5",
                                           "lambert-der-I-prograde", "lambert-tudat-retrograde",
                                           "lambert-curtis-5-3", "lambert-jiang-900",
                                           "lambert-gmat-hyp-retrograde", "lambert-der-II-M0-prograde"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// x falls, y swings a little: x(t) = 5t², which any element has at once, y(t) = sin(3t)/1000.
TEST(AccuracyWhereOneCoordinateIsAPolynomial, OfTheOther) {
  const auto system = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 10 * q[0] - 4.5 * q[1] * q[1];
  });
  const Problem problem = fixed_ends(system, {0, 0}, {5, std::sin(3) / 1000}, 1);
  for (const double tolerance : {1e-8, 1e-10, 1e-12}) {
    const Solution s = Solver().solve(problem, within(tolerance));
    ASSERT_TRUE(s.converged()) << s.message;
    double error = 0, of_velocity = 0;
    for (int i = 0; i <= 200; ++i) {
      const double t = i / 200.0;
      const State found = at(s.trajectory, t);
      error = std::max(error, largest_difference(found.q, Values{5 * t * t, std::sin(3 * t) / 1000}));
      of_velocity =
          std::max(of_velocity, largest_difference(found.v, Values{10 * t, 3 * std::cos(3 * t) / 1000}));
    }
    EXPECT_LE(of_velocity, 10 * tolerance * 10);
    EXPECT_GE(s.error_estimate, 0.1 * error);
  }
}

/// Beside a pole of the ellipsoid a geodesic turns fast in longitude, elsewhere it hardly does: its momenta
/// vary by a 30th of the largest.
TEST(AccuracyBesideAPole, OfMomentaByTheirOwnRange) {
  Study study = load(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/found/ellipsoid-geodesic-pole.toml");
  const Solution exact = solve(study.problem, within(1e-13));
  constexpr int times = 500;
  const auto momenta = [&](const Solution& s) {
    std::vector<Values> points(times + 1, Values(2));
    Values q(2), v(2);
    Scratch scratch;
    for (int i = 0; i <= times; ++i)
      phase_point(study.problem, s.trajectory, s.duration() * i / times, q, v, points[i], scratch);
    return points;
  };
  const std::vector<Values> truth = momenta(exact);
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) {
    const std::vector<Values> found = momenta(solve(study.problem, within(tolerance)));
    double error = 0;
    for (int i = 0; i <= times; ++i) error = std::max(error, largest_difference(found[i], truth[i]));
    EXPECT_LT(error, 10 * tolerance * largest_range(truth)) << tolerance;
  }
}

/// A path at rest in the origin has neither an extent nor an error.
TEST(AccuracyAtRest, InTheOrigin) {
  SolveOptions options = within(1e-4);
  options.scheme = scheme("rectangle");
  options.max_iterations = 50;
  const Solution s = solve(fixed_ends(systems::pendulum(), {0}, {0}, 1), options);
  EXPECT_EQ(s.error_estimate, 0);
  EXPECT_EQ(at(s.trajectory, 0.5).q[0], 0);
}

}  // namespace
}  // namespace extremal::laws
