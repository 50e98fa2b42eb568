#include "study/fitting.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "solve/fit/fitted_path.hpp"
#include "study/fit/fit_data.hpp"
#include "study/phase.hpp"
#include "study/scenes.hpp"

/// \file Fits beside the values that data were made with, the scatter of repeated fits, and published orbits.

using namespace extremal;
using namespace extremal::test;

namespace {

using std::numbers::pi;

/// Normal numbers, the same at every call.
class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  double next() {
    const double u = (double(random_() >> 11) + 1) / double(1ull << 53),
                 w = double(random_() >> 11) / double(1ull << 53);
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * w);
  }

 private:
  std::mt19937_64 random_;
};

const std::string rod =
    "[system]\n"
    "coordinates = [\"theta\"]\n"
    "parameters = { m = 1.0, l = 1.3, g = 9.7 }\n"
    "lagrangian = \"m*l^2*theta'^2/2 + m*g*l*cos(theta)\"\n";

/// The motion of the pendulum from (1, 0.5), whose data the tests have.
const std::string rod_motion = rod + "[boundary]\nstart = { theta = 1.0, p_theta = 0.845 }\nduration = 3.0\n";

const std::string forced_oscillator =
    "[system]\n"
    "coordinates = [\"x\"]\n"
    "parameters = { c = 0.3, k = 4.0 }\n"
    "lagrangian = \"x'^2/2 - k*x^2/2 + 1.5*x*cos(1.7*t)\"\n"
    "force = { x = \"-c*x'\" }\n";

class Fits : public Scenes {
 protected:
  void SetUp() override {
    Scenes::SetUp();
    if (!can_fit()) GTEST_SKIP() << "this build has no Ceres";
  }

  /// q and q' of the motion of a scene at equal times, row by row: t, q, v.
  std::vector<std::vector<double>> samples(const std::string& scene, int count) {
    const Study made = study(scene);
    const Solution solution = run(made);
    EXPECT_TRUE(solution.converged()) << solution.message;
    const std::size_t n = made.problem.names.size();
    std::vector<std::vector<double>> rows;
    for (int k = 0; k < count; ++k) {
      const double t = solution.duration() * k / (count - 1);
      std::vector<double> q(n), v(n), row{t};
      solution.trajectory.at(t, q, v);
      row.insert(row.end(), q.begin(), q.end());
      row.insert(row.end(), v.begin(), v.end());
      rows.push_back(std::move(row));
    }
    return rows;
  }

  /// Angle and pull on the rod of the swing, with σ of each; 0: without noise, σ as given.
  void write_swing(double noise, unsigned seed, bool pull = true) {
    Noise random(seed);
    std::string text = pull ? "t,theta,sigma theta,pull,sigma pull\n" : "t,theta,sigma theta\n";
    for (const auto& row : swing_) {
      const double load = 9.7 * std::cos(row[1]) + 1.3 * row[2] * row[2];
      text += fmt::format("{},{:.17g},0.005", row[0], row[1] + noise * 0.005 * random.next());
      if (pull) text += fmt::format(",{:.17g},0.02", load + noise * 0.02 * random.next());
      text += "\n";
    }
    write("data.csv", text);
  }

  FitResult fitted(const std::string& scene, const std::vector<std::string>& sets = {}) {
    const FitResult result = run_fit(study(scene, sets));
    EXPECT_TRUE(result.solution.converged()) << result.solution.message;
    return result;
  }

  /// Derivatives of the residuals against differences, for a scene with a fit, at its start.
  void expect_derivatives(const std::string& scene) {
    const Study read = study(scene);
    Solver solver;
    const FitTask& task = read.fit->task;
    std::vector<double> values;
    for (const FitUnknown& unknown : task.unknowns) values.push_back(unknown.start);
    const auto problem = task.problem(values, task.guess, task.duration);
    ASSERT_TRUE(problem.has_value());
    const Solution solution = solver.solve(*problem, read.options);
    ASSERT_TRUE(solution.converged()) << solution.message;
    FittedPath path(task, read.options);
    path.take(solution, values);
    ASSERT_TRUE(path.converge_on_elements());
    const std::vector<double> at = path.coordinates();
    const std::size_t rows = task.data.count(), count = at.size();
    std::vector<double> residuals(rows), jacobian(rows * count);
    ASSERT_TRUE(path.evaluate(at, residuals, jacobian));
    for (std::size_t j = 0; j < count; ++j) {
      const bool known = j < values.size();
      const double step = 1e-4 * (known ? task.unknowns[j].size : 1);
      const std::string name = known ? task.unknowns[j].name : "a member of the family";
      std::vector<std::vector<double>> beside;
      for (const double place : {-2.0, -1.0, 1.0, 2.0}) {
        std::vector<double> moved = at;
        moved[j] += place * step;
        beside.emplace_back(rows);
        ASSERT_TRUE(path.evaluate(moved, beside.back(), {}));
      }
      double largest = 0, worst = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        const double slope =
            (8 * (beside[2][i] - beside[1][i]) - (beside[3][i] - beside[0][i])) / (12 * step);
        largest = std::max(largest, std::abs(slope));
        worst = std::max(worst, std::abs(slope - jacobian[i * count + j]));
      }
      EXPECT_LE(worst, 1e-7 * largest) << name;
      EXPECT_GT(largest, 0) << name;
    }
  }

  std::vector<std::vector<double>> swing_;
  const std::string pull_ = "observe = { pull = \"m*g*cos(theta) + m*l*theta'^2\" }\n";
  const std::string both_ = rod + "[boundary]\nduration = 3.0\n[fit]\ndata = \"data.csv\"\n" +
                            "parameters = [\"l\", \"g\"]\n" + pull_;
};

TEST_F(Fits, FindLengthAndGravityOfAPendulumWithoutNoise) {
  swing_ = samples(rod_motion, 41);
  write_swing(0, 1);
  const FitResult result = fitted(both_, {"system.parameters.l=1.0", "system.parameters.g=9.2"});
  EXPECT_NEAR(result.values[0], 1.3, 1e-8);
  EXPECT_NEAR(result.values[1], 9.7, 1e-7);
  EXPECT_NEAR(result.values[2], 1.0, 1e-8);
  EXPECT_LT(result.chi_squared, 1e-8);
  EXPECT_NEAR(result.values[3], swing_.back()[1], 1e-8);
}

/// 80 fits scatter as the covariance of one tells: their variances to four standard deviations of a variance.
TEST_F(Fits, CovarianceIsThatOfRepeatedFits) {
  swing_ = samples(rod_motion, 41);
  constexpr int times = 80;
  std::vector<FitResult> all;
  for (int k = 0; k < times; ++k) {
    write_swing(1, 100 + k);
    all.push_back(fitted(both_));
  }
  const std::vector<double> truth{1.3, 9.7, 1.0, swing_.back()[1]};
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b <= a; ++b) {
      double sum = 0;
      for (const FitResult& each : all) sum += (each.values[a] - truth[a]) * (each.values[b] - truth[b]);
      const Eigen::MatrixXd& told = all.front().covariance;
      EXPECT_NEAR(sum / times, told(a, b), 4 * std::sqrt(2.0 / times) * std::sqrt(told(a, a) * told(b, b)));
    }
  double chi = 0;
  for (const FitResult& each : all) chi += each.chi_squared / times;
  EXPECT_NEAR(chi, 2 * 41 - 4, 4 * std::sqrt(2.0 * 78 / times));
}

TEST_F(Fits, ScatterScalesTheCovarianceWhereNoSigmaIsGiven) {
  swing_ = samples(rod_motion, 41);
  Noise random(3);
  std::string text = "t,theta\n", with = "t,theta,sigma theta\n";
  for (const auto& row : swing_) {
    const std::string line = fmt::format("{},{:.17g}", row[0], row[1] + 0.005 * random.next());
    text += line + "\n";
    with += line + ",0.005\n";
  }
  const std::string scene =
      rod + "[boundary]\nduration = 3.0\n[fit]\ndata = \"data.csv\"\nparameters = [\"l\"]\n";
  write("data.csv", text);
  const FitResult scaled = fitted(scene);
  write("data.csv", with);
  const FitResult given = fitted(scene);
  EXPECT_TRUE(scaled.scaled);
  EXPECT_FALSE(given.scaled);
  EXPECT_NEAR(scaled.values[0], given.values[0], 1e-9);
  EXPECT_NEAR(scaled.covariance(0, 0), given.covariance(0, 0) * given.chi_squared / 38,
              1e-6 * given.covariance(0, 0));
}

TEST_F(Fits, NameWhatDataDoNotDetermine) {
  swing_ = samples(rod_motion, 41);
  write_swing(1, 7, false);
  const std::string scene = rod + "[boundary]\nduration = 3.0\n[fit]\ndata = \"data.csv\"\n";
  const FitResult two = run_fit(study(scene + "parameters = [\"l\", \"g\"]\n"));
  EXPECT_EQ(two.solution.status, Status::not_converged);
  EXPECT_NE(two.solution.message.find("do not determine 'l', 'g'"), std::string::npos)
      << two.solution.message;
  const FitResult mass = run_fit(study(scene + "parameters = [\"l\", \"m\"]\n"));
  EXPECT_EQ(mass.solution.status, Status::not_converged);
  EXPECT_NE(mass.solution.message.find("do not determine 'm'"), std::string::npos) << mass.solution.message;
  EXPECT_TRUE(fitted(scene + "parameters = [\"l\"]\n").solution.converged());
}

TEST_F(Fits, RobustLossesCountOutliersLess) {
  swing_ = samples(rod_motion, 41);
  Noise random(11);
  std::string text = "t,theta,sigma theta\n";
  for (std::size_t k = 0; k < swing_.size(); ++k)
    text += fmt::format("{},{:.17g},0.005\n", swing_[k][0],
                        swing_[k][1] + 0.005 * random.next() + (k % 10 == 4 ? 0.3 : 0));
  write("data.csv", text);
  const std::string scene =
      rod + "[boundary]\nduration = 3.0\n[fit]\ndata = \"data.csv\"\nparameters = [\"l\"]\n";
  const double squared = std::abs(fitted(scene).values[0] - 1.3);
  for (const std::string loss : {"huber", "cauchy"}) {
    const double error = std::abs(fitted(scene + "loss = \"" + loss + "\"\n").values[0] - 1.3);
    EXPECT_LT(error, squared / 2) << loss;
    EXPECT_LT(error, 0.01) << loss;
  }
}

/// The first steps of Gauss and Newton lead to where no extremal is. χ² is that of another program's least
/// squares, by integration.
TEST_F(Fits, ShorterStepsKeepToValuesThatHaveExtremals) {
  const std::string oscillator =
      "[system]\ncoordinates = [\"x\"]\nlagrangian = \"x'^2/2 - a*x^2/2 - b*x^4/4\"\nparameters = ";
  const std::map<std::size_t, double> outliers = {{5, 1.0}, {20, -2.0}, {40, 1.0}};
  const auto rows = samples(oscillator +
                                "{ a = 1.3, b = 0.3 }\n[boundary]\nstart = { x = 1, p_x = 0 }\n"
                                "duration = 12\n",
                            61);
  std::string text = "t,x,sigma x\n";
  for (std::size_t k = 0; k < rows.size(); ++k)
    text += fmt::format("{:.17g},{:.17g},0.02\n", rows[k][0],
                        rows[k][1] + (outliers.contains(k) ? outliers.at(k) : 0));
  write("data.csv", text);
  const FitResult found = fitted(oscillator +
                                 "{ a = 1.0, b = 0.2 }\n[boundary]\nduration = 12\n[fit]\n"
                                 "data = \"data.csv\"\nparameters = [\"a\", \"b\"]\n");
  EXPECT_NEAR(found.chi_squared, 13775.294594, 1e-3);
  EXPECT_NEAR(found.values[0], 2.2501, 1e-3);
}

/// The first path is no extremal, and steps lead along a L to where it vanishes.
TEST_F(Fits, NameTheSameFromAllFirstValues) {
  std::string text = "t,u\n";
  for (int k = 0; k <= 30; ++k)
    text += fmt::format("{},{:.17g}\n", 0.1 * k, std::sin(1.4 * 0.1 * k + 0.3) + 0.01 * std::cos(31.0 * k));
  write("data.csv", text);
  for (const double k : {0.6, 1.5, 1.7, 2.4, 3.0}) {
    const FitResult found =
        run_fit(study(fmt::format("[system]\ncoordinates = [\"u\"]\nparameters = {{ s = 2.0, k = {} }}\n"
                                  "lagrangian = \"s*u'^2/2 - k*u^2/2\"\n[boundary]\nduration = 3.0\n[fit]\n"
                                  "data = \"data.csv\"\nparameters = [\"s\", \"k\"]\n",
                                  k)));
    EXPECT_EQ(found.solution.status, Status::not_converged);
    EXPECT_NE(found.solution.message.find("do not determine 's', 'k':"), std::string::npos)
        << k << ": " << found.solution.message;
  }
}

/// Directions from the centre leave the scale open: r → s r with μ → s³ μ.
TEST_F(Fits, NameAllThatDataLeaveOpenTogether) {
  const std::string plane =
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { mu = 1.0 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 + mu/sqrt(x^2 + y^2)\"\n[boundary]\n";
  std::string text = "t,ang,sigma ang\n";
  for (const auto& row : samples(plane + "start = { x = 1, y = 0, p_x = 0, p_y = 1.1 }\nduration = 8\n", 41))
    text += fmt::format("{:.17g},{:.17g},0.01\n", row[0], std::atan2(row[2], row[1]));
  write("data.csv", text);
  const FitResult found = run_fit(
      study(plane +
            "duration = 8\n[guess]\nstate = { x = 1.05, y = 0.05, \"x'\" = 0.02, \"y'\" = 1.1 }\n[fit]\n"
            "data = \"data.csv\"\nobserve = { ang = \"atan2(y, x)\" }\nparameters = [\"mu\"]\n"));
  EXPECT_EQ(found.solution.status, Status::not_converged);
  EXPECT_NE(found.solution.message.find("do not determine 'mu', 'x(0)'"), std::string::npos)
      << found.solution.message;
}

/// Only the quotient of three parameters shows in the motion.
TEST_F(Fits, TellHowManyOfTheUnknownsMustBeGiven) {
  const std::string product =
      "[system]\ncoordinates = [\"x\"]\nparameters = { m = 1.0, b = 2.0, c = 1.5 }\n"
      "lagrangian = \"m*x'^2/2 - b*c*x^2/2\"\n[boundary]\n";
  std::string text = "t,x\n";
  for (const auto& row : samples(product + "start = { x = 1.0, p_x = 0.3 }\nduration = 2.0\n", 21))
    text += fmt::format("{:.17g},{:.17g}\n", row[0], row[1]);
  write("data.csv", text);
  const std::string fit = "duration = 2.0\n[fit]\ndata = \"data.csv\"\nparameters = ";
  const FitResult found = run_fit(study(product + fit + "[\"m\", \"b\", \"c\"]\n"));
  EXPECT_FALSE(found.solution.converged());
  EXPECT_NE(found.solution.message.find("give 2 of them"), std::string::npos) << found.solution.message;
  EXPECT_TRUE(run_fit(study(product + fit + "[\"b\"]\n")).solution.converged());
}

/// x = cos t + sin(t)/2 over half a period: any velocity leads from end to end.
TEST_F(Fits, TellADurationOverWhichConjugateEndsAreNone) {
  const std::string oscillator =
      "[system]\ncoordinates = [\"x\"]\nparameters = { k = 1.3 }\nlagrangian = \"x'^2/2 - k*x^2/2\"\n";
  std::string text = "t,x\n";
  for (int i = 0; i <= 40; ++i) {
    const double t = pi * i / 40;
    text += fmt::format("{:.17g},{:.17g}\n", t, std::cos(t) + std::sin(t) / 2);
  }
  write("data.csv", text);
  const auto lasting = [&](double duration) {
    return run_fit(
        study(oscillator + fmt::format("[boundary]\nduration = {:.17g}\n[fit]\ndata = \"data.csv\"\n"
                                       "parameters = [\"k\"]\n",
                                       duration)));
  };
  const FitResult none = lasting(pi);
  EXPECT_FALSE(none.solution.converged());
  EXPECT_NE(none.solution.message.find("set duration = 3.46 in [boundary]"), std::string::npos)
      << none.solution.message;
  const FitResult found = lasting(3.46);
  ASSERT_TRUE(found.solution.converged()) << found.solution.message;
  EXPECT_NEAR(found.values[0], 1, 1e-8);
  EXPECT_NEAR(found.solution.momentum_start[0], 0.5, 1e-8);
}

/// From a first stiffness on the other side of one at which the duration is conjugate to the start.
TEST_F(Fits, FindDampingFromAForcedResponse) {
  const auto rows =
      samples(forced_oscillator + "[boundary]\nstart = { x = 0.5, p_x = -1.0 }\nduration = 8.0\n", 81);
  Noise random(5);
  std::string text = "t,x,sigma x\n";
  for (const auto& row : rows)
    text += fmt::format("{},{:.17g},0.01\n", row[0], row[1] + 0.01 * random.next());
  write("data.csv", text);
  const FitResult result =
      fitted(forced_oscillator +
                 "[boundary]\nduration = 8.0\n[fit]\ndata = \"data.csv\"\nparameters = [\"c\", \"k\"]\n",
             {"system.parameters.c=0.1", "system.parameters.k=3.5"});
  for (const auto& [k, truth] : {std::pair{0, 0.3}, {1, 4.0}, {2, 0.5}, {3, rows.back()[1]}})
    EXPECT_NEAR(result.values[k], truth, 4 * std::sqrt(result.covariance(k, k))) << k;
  EXPECT_LT(std::sqrt(result.covariance(0, 0)), 0.01);
  EXPECT_LT(result.chi_squared, 130);
}

/// Elements end where L has a kink, at times that depend on the parameters: quadratic drag, whose force is
/// smooth enough for that, and dry friction, whose force jumps.
TEST_F(Fits, FindForcesWithKinks) {
  LONG_TEST();
  for (const char* drag : {"-c*x' - d*x'*abs(x')", "-c*x' - d*x'/abs(x')"}) {
    const std::string scene = fmt::format(
        "[system]\ncoordinates = [\"x\"]\nparameters = {{ b = 0.3, c = 0.05, d = 0.04 }}\n"
        "lagrangian = \"x'^2/2 - x^2/2 - b*x^4/4 + 0.5*x*cos(1.3*t)\"\nforce = {{ x = \"{}\" }}\n",
        drag);
    const auto rows = samples(scene + "[boundary]\nstart = { x = 0.5, p_x = -1.0 }\nduration = 9.0\n", 61);
    Noise random(5);
    std::string text = "t,x,sigma x\n";
    for (const auto& row : rows)
      text += fmt::format("{},{:.17g},0.001\n", row[0], row[1] + 0.001 * random.next());
    write("data.csv", text);
    const FitResult result = fitted(
        scene +
            "[boundary]\nduration = 9.0\n[fit]\ndata = \"data.csv\"\nparameters = [\"b\", \"c\", \"d\"]\n",
        {"system.parameters.b=0.28", "system.parameters.d=0.05"});
    ASSERT_TRUE(result.solution.converged()) << drag << ": " << result.solution.message;
    for (const auto& [k, truth] : {std::pair{0, 0.3}, {1, 0.05}, {2, 0.04}})
      EXPECT_NEAR(result.values[k], truth, 4 * std::sqrt(result.covariance(k, k))) << drag << ' ' << k;
    EXPECT_LT(std::sqrt(result.covariance(2, 2)), 0.02) << drag;
    EXPECT_LT(result.chi_squared, 100) << drag;
  }
}

/// Between the first value of the data and the last, no motion leads for the first values of the parameters
/// (shooting from 481 velocities). With the path, which the data hold, their true values are found.
TEST_F(Fits, BeginWhereNoMotionLeadsFromEndToEndOfTheData) {
  const auto driven = [](const std::string& parameters, const std::string& boundary) {
    return "[system]\ncoordinates = [\"x\"]\nparameters = { " + parameters +
           " }\nlagrangian = \"x'^2/2 - k*x^2/2 - 0.3*x^4/4\"\n"
           "force = { x = \"-c*x' + A*cos(1.3*t + ph)\" }\n[boundary]\nduration = 12\n" +
           boundary;
  };
  std::string data = "t,x\n";
  for (const auto& row :
       samples(driven("c = 0.15, k = 1.2, A = 0.8, ph = 0.5", "start = { x = 1, p_x = -0.3 }\n"), 80))
    data += fmt::format("{:.17g},{:.17g}\n", row[0], row[1]);
  write("data.csv", data);
  const std::string first = "c = 0.3, k = 1.0, A = 1.0, ph = 0.0", fit = "[fit]\ndata = \"data.csv\"\n";
  const FitResult found = fitted(driven(first, fit + "parameters = [\"c\", \"k\", \"A\", \"ph\"]\n"));
  const std::vector<double> expected{0.15, 1.2, 0.8, 0.5, 1.0};
  for (std::size_t j = 0; j < expected.size(); ++j) EXPECT_NEAR(found.values[j], expected[j], 1e-7) << j;
}

TEST_F(Fits, DerivativesAreThoseOfTheExtremals) {
  write("data.csv", "t,x,x',far\n0.3,0.1,1,0\n0.9,0.5,0.2,1\n1.2,0.4,,2\n1.5,0.2,-0.1,\n");
  const std::string fit = "[fit]\ndata = \"data.csv\"\nobserve = { far = \"b*x^2 + w*x'*t\" }\n";
  const std::string system =
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { a = 0.7, b = 1.2, w = \"2*a^2\" }\n"
      "lagrangian = \"x'^2/2 + (1 + x^2)*y'^2/2 - w*x^2/2 - b*x^4/4 - a*x*y\"\n";
  expect_derivatives(
      system + "[boundary]\nstart = { x = \"a/2\", p_y = \"b\" }\nend = { y = \"a*b\" }\nduration = 2.0\n" +
      fit + "parameters = [\"a\", \"b\"]\n");
  expect_derivatives(system +
                     "[boundary]\nstart = { x = 0.1 }\nend = { y = 0.2 }\nduration = \"2 + b - 1.2\"\n" +
                     fit + "parameters = [\"b\"]\n");
  expect_derivatives(system +
                     "[boundary]\nstart = { x = 0.1, y = 0.0 }\nend = { x = \"a\" }\nduration = \"free\"\n"
                     "energy = \"b\"\n[guess]\nduration = 2.0\n" +
                     fit + "parameters = [\"a\", \"b\"]\n");
  expect_derivatives(
      system +
      "[boundary]\nstart = { x = 0.1, y = 0.0 }\nend = { x = 0.5, p_y = 0.0 }\n"
      "duration = \"free\"\nwhere = \"y(T) = a\"\n[guess]\nduration = 2.0\ny = \"0.35*t\"\nx = "
      "\"0.1 + 0.2*t\"\n" +
      fit + "parameters = [\"a\", \"b\"]\n");
  expect_derivatives(system +
                     "force = { x = \"-b*x'\", y = \"-a*y'\" }\n[boundary]\nstart = { x = 0.1, y = \"a\" }\n"
                     "end = { y = 0.0 }\nduration = 2.0\n" +
                     fit + "parameters = [\"a\", \"b\"]\n");
}

/// Curtis, Orbital Mechanics for Engineering Students, example 5.11.
TEST_F(Fits, FindAnOrbitFromThreeDirections) {
  write("data.csv",
        "t,alpha,delta\n0,43.5365,-8.78334\n118.104,54.4196,-12.0739\n237.577,64.3178,-15.1054\n");
  const FitResult result = fitted(
      "[system]\nuse = \"kepler-space\"\n"
      "parameters = { mu = 398600.0, radius = 6378.0, flat = 0.003353, height = 1.0, lat = \"40*pi/180\" }\n"
      "[system.definitions]\n"
      "bulge = \"sqrt(1 - (2*flat - flat^2)*sin(lat)^2)\"\n"
      "theta = \"pi/180*(44.5065 + (45.4992 - 44.5065)*t/237.577)\"\n"
      "across = \"(radius/bulge + height)*cos(lat)\"\n"
      "rx = \"x - across*cos(theta)\"\nry = \"y - across*sin(theta)\"\n"
      "rz = \"z - (radius*(1 - flat)^2/bulge + height)*sin(lat)\"\n"
      "[boundary]\nduration = 237.577\n"
      "[guess]\nx = \"6000 - 3*t\"\ny = \"6000 + 5*t\"\nz = \"3000 - 2*t\"\n"
      "[fit]\ndata = \"data.csv\"\n"
      "observe = { alpha = \"180/pi*atan2(ry, rx)\", delta = \"180/pi*atan2(rz, sqrt(rx^2 + ry^2))\" }\n");
  std::vector<double> q(3), v(3);
  result.solution.trajectory.at(118.104, q, v);
  const double r[] = {5662.04, 6537.95, 3269.05}, w[] = {-3.88542, 5.12141, -2.2434};
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(q[a], r[a], 0.05);  // of angles to six digits
    EXPECT_NEAR(v[a], w[a], 1e-4);
  }
}

/// Vallado, Fundamentals of Astrodynamics and Applications, example 7-2: places of the site to a metre.
TEST_F(Fits, FindAnOrbitFromDirectionsOfAMovingSite) {
  write("data.csv",
        "t,alpha,delta\n0,0.939913,18.667717\n480,45.025748,35.664741\n720,67.886655,36.996583\n");
  const FitResult result = fitted(
      "[system]\nuse = \"kepler-space\"\n[system.definitions]\n"
      "a1 = \"(t - 480)*(t - 720)/(480*720)\"\na2 = \"-t*(t - 720)/(480*240)\"\n"
      "a3 = \"t*(t - 480)/(720*240)\"\n"
      "rx = \"x - (4054.881*a1 + 3956.224*a2 + 3905.073*a3)\"\n"
      "ry = \"y - (2748.195*a1 + 2888.232*a2 + 2956.935*a3)\"\n"
      "rz = \"z - (4074.237*a1 + 4074.364*a2 + 4074.430*a3)\"\n"
      "[boundary]\nduration = 720.0\n"
      "[guess]\nx = \"8000 - 5*(t - 240)\"\ny = \"4000 + 5*(t - 240)\"\nz = \"5500 + 2*(t - 240)\"\n"
      "[fit]\ndata = \"data.csv\"\n"
      "observe = { alpha = \"180/pi*atan2(ry, rx)\", delta = \"180/pi*atan2(rz, sqrt(rx^2 + ry^2))\" }\n");
  std::vector<double> q(3), v(3);
  result.solution.trajectory.at(480, q, v);
  const double r[] = {6356.48603405, 5290.53225676, 6511.39697857},
               w[] = {-4.17294816, 4.77654968, 1.72027091};
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(q[a], r[a], 0.2);
    EXPECT_NEAR(v[a], w[a], 2e-4);
  }
}

TEST_F(Fits, FindTheMassRatioFromAHaloOrbit) {
  const std::string head = "[system]\nuse = \"cr3bp\"\nparameters = { mu = 0.04 }\n";
  const std::string orbit =
      "[boundary]\nperiodic = true\nduration = 2.202198\n[guess]\nx = \"0.87 - 0.093*cos(2*pi*t/T)\"\n"
      "y = \"0.165*sin(2*pi*t/T)\"\nz = \"0.107 + 0.178*cos(2*pi*t/T)\"\n";
  const auto rows = samples(head + orbit, 60);
  Noise random(9);
  std::string text = "t,x,sigma x,y,sigma y,z,sigma z\n";
  for (const auto& row : rows) {
    text += fmt::format("{:.17g}", row[0]);
    for (int a = 1; a <= 3; ++a) text += fmt::format(",{:.17g},0.001", row[a] + 0.001 * random.next());
    text += "\n";
  }
  write("data.csv", text);
  const FitResult result = fitted(head + orbit + "[fit]\ndata = \"data.csv\"\nparameters = [\"mu\"]\n",
                                  {"system.parameters.mu=0.038"});
  EXPECT_NEAR(result.values[0], 0.04, 4 * std::sqrt(result.covariance(0, 0)));
  EXPECT_LT(std::sqrt(result.covariance(0, 0)), 1e-3);
  EXPECT_EQ(result.values.size(), 1u);
}

/// A bead on the wire y = a (1 − cos x), written with a constraint and without. Both fits are the same,
/// though no guess is given, the first parameters are far off and there are conjugate times in between.
TEST_F(Fits, ConstraintsChangeNoFit) {
  const std::string parameters = "parameters = { g = 3.0, a = 0.6, c = 0.3 }\n",
                    end = "[boundary]\nduration = 5.0\n",
                    one = "[system]\ncoordinates = [\"x\"]\n" + parameters +
                          "lagrangian = \"(1 + a^2*sin(x)^2)*x'^2/2 - g*a*(1 - cos(x))\"\n"
                          "force = { x = \"-c*(1 + a^2*sin(x)^2)*x'\" }\n",
                    both = "[system]\ncoordinates = [\"x\", \"y\"]\n" + parameters +
                           "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"y = a*(1 - cos(x))\"]\n"
                           "force = { x = \"-c*x'\", y = \"-c*y'\" }\n",
                    fit = "[fit]\ndata = \"data.csv\"\nparameters = [\"g\", \"a\", \"c\"]\n";
  const std::string motion = one + "[boundary]\nstart = { x = 1.2, p_x = 0.0 }\nduration = 5.0\n";
  Study made =
      study(motion, {"system.parameters.g=4.1", "system.parameters.a=0.9", "system.parameters.c=0.12"});
  const Solution solution = run(made);
  ASSERT_TRUE(solution.converged()) << solution.message;
  for (const double noise : {0.0, 0.01}) {
    Noise random(11);
    std::string text = "t,x,y\n";
    for (int k = 0; k <= 40; ++k) {
      std::vector<double> q(1), v(1);
      solution.trajectory.at(5.0 * k / 40, q, v);
      const double x = q[0] + noise * random.next(), y = 0.9 * (1 - std::cos(q[0])) + noise * random.next();
      text += fmt::format("{},{:.17g},{:.17g}\n", 5.0 * k / 40, x, y);
    }
    write("data.csv", text);
    const FitResult bound = fitted(both + end + fit);
    ASSERT_EQ(bound.values.size(), 5);
    if (noise == 0) {
      EXPECT_NEAR(bound.values[0], 4.1, 1e-8);
      EXPECT_NEAR(bound.values[1], 0.9, 1e-8);
      EXPECT_NEAR(bound.values[2], 0.12, 1e-8);
      continue;
    }
    std::string named = text;
    named.replace(0, 5, "t,x,h");
    write("data.csv", named);
    const FitResult free = fitted(one + end + fit + "observe = { h = \"a*(1 - cos(x))\" }\n");
    EXPECT_NEAR(bound.chi_squared, free.chi_squared, 1e-10 * free.chi_squared);
    for (std::size_t j = 0; j < 5; ++j) {
      EXPECT_NEAR(bound.values[j], free.values[j], 1e-7) << j;
      EXPECT_NEAR(bound.covariance(j, j), free.covariance(j, j), 1e-5 * free.covariance(j, j)) << j;
    }
  }
}

TEST_F(Fits, DerivativesUnderConstraints) {
  std::string text = "t,x,far\n";
  for (int k = 0; k <= 10; ++k) text += fmt::format("{},{},1\n", 0.2 * k, 0.7 * std::cos(0.2 * k));
  write("data.csv", text);
  const std::string guess = "[guess]\nx = \"0.7*cos(t)\"\ny = \"-sqrt(1 - 0.49*cos(t)^2)\"\n",
                    fit =
                        "[fit]\ndata = \"data.csv\"\nparameters = [\"g\", \"l\", \"c\"]\n"
                        "observe = { far = \"l*x*y + c*y'\" }\n";
  // At rest, and with a support that moves.
  for (const char* link : {"x^2 + y^2 = l^2", "(x - c*sin(3*t))^2 + y^2 = l^2*(1 + 0.1*c*t)"})
    for (const char* force : {"", "force = { x = \"-c*x'\" }\n"})
      expect_derivatives(
          "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 1.1, l = 1.0, c = 0.1 }\n"
          "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\n" +
          std::string(force) + "constraints = [\"" + link + "\"]\n[boundary]\nduration = 2.0\n" + guess +
          fit);
}

/// Between data at rest the path of zeros, which constraints may not have, is no first path.
TEST_F(Fits, DataAreTheFirstPathUnderConstraints) {
  const auto rows = samples(rod_motion, 31);
  std::string text = "t,x,y\n";
  for (const auto& row : rows)
    text += fmt::format("{},{:.17g},{:.17g}\n", row[0], 1.3 * std::sin(row[1]), -1.3 * std::cos(row[1]));
  write("data.csv", text);
  const std::string link =
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 8.0, l = 1.0 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"x^2 + y^2 = l^2\"]\n"
      "[boundary]\nduration = 3.0\n[fit]\ndata = \"data.csv\"\nparameters = [\"g\", \"l\"]\n";
  // A guess at rest may be where the coordinate that follows is normal to the constraint.
  for (const char* guess : {"", "[guess]\nx = \"0\"\ny = \"-1\"\n"}) {
    const FitResult result = fitted(link + guess);
    EXPECT_NEAR(result.values[0], 9.7, 1e-8);
    EXPECT_NEAR(result.values[1], 1.3, 1e-9);
  }
}

TEST_F(Fits, DerivativesOfALimitCycle) {
  write("data.csv",
        "t,x,x'\n0.0,0.9,0.1\n0.9,0.5,-0.6\n1.7,-0.4,-0.9\n2.6,-0.8,0.2\n3.7,0.1,1\n4.6,0.8,0.5\n");
  expect_derivatives(
      "[system]\ncoordinates = [\"x\"]\nparameters = { e = 0.9, w = 1.2 }\n"
      "lagrangian = \"x'^2/2 - w^2*x^2/2\"\nforce = { x = \"e*(1 - x'^2)*x'\" }\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 5.6\n"
      "x = \"cos(2*pi*t/T + 0.3)\"\n[fit]\ndata = \"data.csv\"\nparameters = [\"e\", \"w\"]\n");
}

/// Where time begins later, what closes the duration asks for a larger orbit.
TEST_F(Fits, DerivativesAlongAFamilyOfOrbits) {
  write("data.csv", "t,x,y\n0.0,0.9,0.1\n0.9,0.5,-0.6\n1.7,-0.4,-0.9\n2.6,-0.8,0.2\n3.7,0.1,1\n");
  expect_derivatives(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { k = 1.1 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - k*(x^2 + y^2)^2/4\"\n"
      "[boundary]\nperiodic = true\nduration = \"free\"\nwhere = \"x(0) = 0.8\"\n[guess]\nduration = 6.0\n"
      "x = \"cos(2*pi*t/T + 0.4)\"\ny = \"0.3*cos(2*pi*t/T + 0.4)\"\n"
      "[fit]\ndata = \"data.csv\"\nparameters = [\"k\"]\n");
}

/// A limit cycle of Rayleigh. Its phase is that of the data, wherever the guess begins.
TEST_F(Fits, FindTheParametersOfALimitCycleAndItsPhase) {
  const auto cycle = [](const std::string& phase) {
    return "[system]\ncoordinates = [\"x\"]\nparameters = { e = 0.9, w = 1.2 }\n"
           "lagrangian = \"x'^2/2 - w^2*x^2/2\"\nforce = { x = \"e*(1 - x'^2)*x'\" }\n"
           "[boundary]\nperiodic = true\nduration = \"free\"\n[guess]\nduration = 5.6\n"
           "x = \"cos(2*pi*t/T + " +
           phase + ")\"\n";
  };
  const auto rows = samples(cycle("0.3"), 45);
  for (const double noise : {0.0, 0.02}) {
    Noise random(3);
    std::string text = "t,x\n";
    for (std::size_t k = 0; k + 1 < rows.size(); ++k)
      text += fmt::format("{:.17g},{:.17g}\n", rows[k][0], rows[k][1] + noise * random.next());
    write("data.csv", text);
    std::vector<FitResult> results;
    for (const char* phase : {"0.3", "0.8"})
      for (const char* first : {"system.parameters.e=1.0", "system.parameters.e=0.7"})
        results.push_back(fitted(cycle(phase) + "[fit]\ndata = \"data.csv\"\nparameters = [\"e\", \"w\"]\n",
                                 {first, "system.parameters.w=1.23"}));
    for (const FitResult& result : results) {
      ASSERT_EQ(result.values.size(), 2u);
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(result.values[j], results[0].values[j], 2e-7);
        const double truth = j == 0 ? 0.9 : 1.2;
        EXPECT_NEAR(result.values[j], truth, noise > 0 ? 4 * std::sqrt(result.covariance(j, j)) : 1e-7);
      }
      EXPECT_NEAR(result.chi_squared, results[0].chi_squared, 1e-9 * (1e-3 + results[0].chi_squared));
      // The trajectory has the phase of the data.
      std::vector<double> q(1), v(1);
      for (std::size_t k = 0; k + 1 < rows.size(); k += 7) {
        result.solution.trajectory.at(rows[k][0], q, v);
        EXPECT_NEAR(q[0], rows[k][1], noise + 1e-7);
      }
    }
  }
}

/// Data of the orbit that a scene's own guess leads to, and a fit from another guess.
TEST_F(Fits, ChooseAmongTheMembersOfAFamilyOfOrbits) {
  const auto orbit = [](const std::string& parameters, const std::string& rest, const std::string& x,
                        const std::string& y) {
    return "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { " + parameters + " }\n" + rest +
           "[guess]\nx = \"" + x + "\"\ny = \"" + y + "\"\n";
  };
  struct Case {
    std::string name, rest;
    std::array<std::string, 2> made, guess;
    std::size_t members;
  };
  const std::string quartic =
                        "lagrangian = \"(x'^2 + y'^2)/2 - k*(x^2 + y^2)^2/4\"\n[boundary]\nperiodic = true\n",
                    rotor =
                        "lagrangian = \"(x'^2 + y'^2)/2 + k*cos(x)\"\n[boundary]\nperiodic = true\n"
                        "map = { x = \"x + 2*pi\", y = \"y + 1\" }\n";
  const std::array<std::string, 2> turned{"cos(0.7)*cos(2*pi*t/T + 0.3)", "sin(0.7)*cos(2*pi*t/T + 0.3)"};
  for (const Case& each :
       {Case{"turned", quartic + "duration = 6.0\n", turned, {"1.2*cos(2*pi*t/T)", "0"}, 2},
        Case{"shifted",
             rotor + "duration = 3.8\n",
             {"2*pi*t/T", "t/T + 0.4"},
             {"2*pi*t/T - 0.2", "t/T"},
             2}}) {
    SCOPED_TRACE(each.name);
    const auto rows = samples(orbit("k = 1.1", each.rest, each.made[0], each.made[1]), 31);
    std::string text = "t,x,y\n";
    for (std::size_t k = 0; k + 1 < rows.size(); ++k)
      text += fmt::format("{:.17g},{:.17g},{:.17g}\n", rows[k][0], rows[k][1], rows[k][2]);
    write("data.csv", text);
    const FitResult result = fitted(orbit("k = 1.0", each.rest, each.guess[0], each.guess[1]) +
                                    "[fit]\ndata = \"data.csv\"\nparameters = [\"k\"]\n");
    ASSERT_EQ(result.values.size(), 1u);
    EXPECT_NEAR(result.values[0], 1.1, 1e-7);
    EXPECT_LT(result.chi_squared, 1e-12);
    EXPECT_EQ(result.freedom, 59 - static_cast<int>(each.members));
  }
}

/// One of a continuum of orbits of all sizes: a scale changes what is observed as another size does.
TEST_F(Fits, NameWhatAnotherOrbitOfAContinuumExplains) {
  std::string text = "t,u,y\n";
  for (int k = 0; k < 25; ++k)
    text += fmt::format("{:.17g},{:.17g},{:.17g}\n", k / 4.0, 1.5 * std::cos(k / 4.0 + 0.3),
                        0.4 * std::sin(k / 4.0 + 0.3));
  write("data.csv", text);
  const auto fit = [](const std::string& parameter, const std::string& observed) {
    return "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { c = " + parameter +
           " }\nlagrangian = \"(x'^2 + y'^2 - x^2 - y^2)/2\"\n[boundary]\nperiodic = true\n"
           "duration = \"2*pi\"\n[guess]\nx = \"cos(t)\"\ny = \"0.6*sin(t)\"\n[fit]\ndata = \"data.csv\"\n"
           "parameters = [\"c\"]\nobserve = { u = \"" +
           observed + "\" }\n";
  };
  const FitResult none = run_fit(study(fit("1.0", "c*x")));
  EXPECT_FALSE(none.solution.converged());
  EXPECT_NE(none.solution.message.find("'c'"), std::string::npos) << none.solution.message;
  EXPECT_NEAR(fitted(fit("0.2", "x + c")).values[0], 0, 1e-9);
}

TEST_F(Fits, KeepTheElementsOfAScheme) {
  swing_ = samples(rod_motion, 41);
  write_swing(0, 1);
  const FitResult result = fitted(both_ + "[solve]\nscheme = \"midpoint\"\nelements = 200\n");
  EXPECT_EQ(result.solution.trajectory.elements(), 200);
  EXPECT_NEAR(result.values[0], 1.3, 0.01);
  EXPECT_GT(std::abs(result.values[0] - 1.3), 1e-6);
}

TEST_F(Fits, RefuseBadInput) {
  const std::string start = rod + "[boundary]\nduration = 3.0\n[fit]\n",
                    fit = start + "data = \"data.csv\"\n";
  const std::string all = fit + "parameters = [\"l\"]\n";
  const auto with = [&](const std::string& data, const std::string& scene) {
    write("data.csv", data);
    return message(scene);
  };
  const std::string good = "t,theta\n0,1\n1,0.5\n2,0.2\n3,0.1\n";
  EXPECT_NE(message(start + "data = \"none.csv\"\n").find("no such file: 'none.csv'"), std::string::npos);
  EXPECT_EQ(with("t,phi\n0,1\n", all).substr(0, 34), "data.csv:1:3: unknown column 'phi'");
  EXPECT_EQ(with("time,theta\n0,1\n", all), "data.csv:1:1: the file has no column 't'; it has time, theta");
  EXPECT_EQ(with("x,t,theta\n", fit).substr(0, 13), "data.csv:1:1:");
  EXPECT_EQ(with("t,theta\n", all), "data.csv: the file has no observations");
  EXPECT_EQ(with("t,theta\n0,1\n3.5,1\n", all), "data.csv:3:1: t = 3.5 is not between 0 and the duration, 3");
  EXPECT_EQ(with("t,theta\n0,1\n1,one\n", all), "data.csv:3:3: 'one' is not a finite number");
  EXPECT_EQ(with("t,theta\n0,1\n1,2,3\n", all), "data.csv:3:1: found 3 values for 2 columns");
  EXPECT_EQ(with("t,theta,sigma theta\n0,1,0\n", all),
            "data.csv:2:5: sigma = 0; a standard deviation is positive");
  EXPECT_NE(with("t,theta,sigma phi\n0,1,1\n", all).find("data.csv:1:9: 'sigma phi' belongs"),
            std::string::npos);
  EXPECT_EQ(with("t,theta\n0,1\n1,0.5\n", all),
            "scene.toml:8:9: the data have 2 values for 3 unknowns: l, theta(0), theta(T)");
  EXPECT_NE(with(good, fit + "parameters = [\"q\"]\n").find("scene.toml:9:16: unknown parameter 'q'"),
            std::string::npos);
  EXPECT_NE(with(good, all + "loss = \"absolute\"\n").find("scene.toml:10:9: unknown loss 'absolute'"),
            std::string::npos);
  EXPECT_NE(with(good, all + "observe = { a = \"theta*u\" }\n").find("scene.toml:10:"), std::string::npos);
  EXPECT_NE(with(good, all + "[search]\nsolutions = 2\n").find("exclude each other"), std::string::npos);
  write("data.csv", good);
  EXPECT_NE(message(rod + "[boundary]\nstart = { theta = 0 }\nend = { theta = 1 }\nduration = 3.0\n"
                          "[fit]\ndata = \"data.csv\"\n")
                .find("nothing to be found"),
            std::string::npos);
  EXPECT_NE(message(rod_motion + "[fit]\ndata = \"data.csv\"\nparameters = [\"l\"]\n").find("initial data"),
            std::string::npos);
}

/// With the mass that was found, not with its guess.
TEST_F(Fits, MomentaAreThoseOfTheFittedLagrangian) {
  std::string text = "t,x\n";
  for (int k = 0; k <= 40; ++k)
    text += fmt::format("{},{:.17g}\n", 0.1 * k, std::cos(std::sqrt(1.6) * 0.1 * k));
  write("data.csv", text);
  Study read = study(
      "[system]\ncoordinates = [\"x\"]\nparameters = { m = 1.5 }\nlagrangian = \"m*x'^2/2 - 2*x^2\"\n"
      "[boundary]\nduration = 4.0\n[fit]\ndata = \"data.csv\"\nparameters = [\"m\"]\n");
  const FitResult result = run_fit(read);
  ASSERT_TRUE(result.solution.converged()) << result.solution.message;
  ASSERT_NEAR(result.values[0], 2.5, 1e-9);
  use_fitted(result.values, read);
  std::vector<double> q(1), v(1), p(1);
  Scratch scratch;
  phase_point(read.problem, result.solution.trajectory, 4.0, q, v, p, scratch);
  EXPECT_NEAR(p[0], 2.5 * v[0], 1e-9);
  EXPECT_NEAR(p[0], result.solution.momentum_end[0], 1e-9);
}

TEST_F(Fits, AnglesAreTakenWithoutWholeTurns) {
  const Vocabulary known({{"k", {{2.0}, false}}});
  EXPECT_DOUBLE_EQ(turn_of("atan2(y, x)", known), 2 * pi);
  EXPECT_DOUBLE_EQ(turn_of("180/pi*atan2(y, (x + 1)*2)", known), 360);
  EXPECT_DOUBLE_EQ(turn_of("-atan2(y, x)*k", known), 4 * pi);
  EXPECT_EQ(turn_of("atan2(y, x) + 1", known), 0);
  EXPECT_EQ(turn_of("1 + atan2(y, x)", known), 0);
  EXPECT_EQ(turn_of("x*atan2(y, x)", known), 0);
  EXPECT_EQ(turn_of("sin(atan2(y, x))", known), 0);
}

}  // namespace

/// cos ωt with ω² = 7.546 and errors of one standard deviation. The path that the data hold leads to it from
/// ω² = 1, five turns less, as well. With errors a tenth of what they are, the residuals tell.
TEST_F(Fits, TellWhereTheModelDoesNotExplainTheData) {
  const auto fitted = [&](double start, double sigma) {
    std::string data = "t,x,sigma x\n";
    for (int k = 0; k < 40; ++k) {
      const double t = 0.5 * (k + 1);
      data += fmt::format("{:.17g},{:.17g},{}\n", t,
                          std::cos(std::sqrt(7.546) * t) + 0.01 * std::sqrt(2) * std::cos(1 + k * k), sigma);
    }
    write("data.csv", data);
    return run_fit(
        study(fmt::format("[system]\ncoordinates = [\"x\"]\nparameters = {{ k = {} }}\n"
                          "lagrangian = \"x'^2/2 - k*x^2/2\"\n[boundary]\nduration = 20.5\n"
                          "[fit]\ndata = \"data.csv\"\nparameters = [\"k\"]\n",
                          start)));
  };
  for (const double start : {7.5, 6.0, 1.0}) {
    const FitResult found = fitted(start, 0.01);
    ASSERT_TRUE(found.solution.converged()) << found.solution.message;
    EXPECT_NEAR(found.values[0], 7.546, 0.01);
    EXPECT_EQ(found.solution.message.find("per degree of freedom"), std::string::npos);
  }
  const FitResult told = fitted(7.5, 0.001);
  ASSERT_TRUE(told.solution.converged()) << told.solution.message;
  EXPECT_NE(told.solution.message.find("per degree of freedom"), std::string::npos) << told.solution.message;
}

/// The guess leaves the data, and its end is on the other side of the ellipse.
TEST_F(Fits, BeginFromTheDataWhereTheGuessLeadsToNone) {
  const auto rows = samples(
      "[system]\ncoordinates = [\"a\"]\n"
      "lagrangian = \"(sin(a)^2 + 0.49*cos(a)^2)*a'^2/2 - 2.5*0.7*sin(a)\"\n"
      "[boundary]\nstart = { a = -1, p_a = 0 }\nduration = 5\n",
      61);
  std::string text = "t,x,y\n";
  for (const auto& row : rows)
    text += fmt::format("{},{:.17g},{:.17g}\n", row[0], std::cos(row[1]), 0.7 * std::sin(row[1]));
  write("data.csv", text);
  const FitResult found = fitted(
      "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { g = 2.4, b = 0.7 }\n"
      "lagrangian = \"(x'^2 + y'^2)/2 - g*y\"\nconstraints = [\"x^2 + y^2/b^2 = 1\"]\n[boundary]\n"
      "duration = 5\n[guess]\nx = \"cos(-1 + 0.4*t)\"\ny = \"0.7*sin(-1 + 0.4*t)\"\n[fit]\n"
      "data = \"data.csv\"\nparameters = [\"g\", \"b\"]\n");
  EXPECT_NEAR(found.values[0], 2.5, 1e-6);
  EXPECT_NEAR(found.values[1], 0.7, 1e-6);
}
