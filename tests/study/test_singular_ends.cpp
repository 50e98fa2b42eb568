#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "scenes.hpp"
#include "solution/observe.hpp"

using namespace extremal;
using namespace extremal::test;
using std::numbers::pi;

namespace {

constexpr double g = 9.81;
const std::string fall = "sqrt((1 + y'^2)/(2*9.81*y))";

std::string singular_scene(const std::string& lagrangian, const std::string& boundary,
                           const std::string& more = "", const std::string& coordinates = "\"y\"") {
  return "[system]\ncoordinates = [" + coordinates + "]\nlagrangian = \"" + lagrangian + "\"\n[boundary]\n" +
         boundary + "\n" + more;
}

/// Time of the fastest fall from rest to (x, y): of the cycloid x = R (a − sin a), y = R (1 − cos a).
double time_of_fall(double x, double y) {
  double low = 1e-6, high = 2 * pi - 1e-6;
  for (int k = 0; k < 200; ++k) {
    const double a = 0.5 * (low + high);
    ((a - std::sin(a)) / (1 - std::cos(a)) < x / y ? low : high) = a;
  }
  return low * std::sqrt(y / (1 - std::cos(low)) / g);
}

/// From a depth h below rest, where it has its speed already, to (x, y + h): of the angle a of the cycloid at
/// the end, that at the start is told by the depths.
double time_of_fall_from(double h, double x, double y) {
  const auto first = [&](double a) { return std::acos(1 - (1 - std::cos(a)) * h / (y + h)); };
  const auto width = [&](double a) {
    const double b = first(a), radius = (y + h) / (1 - std::cos(a));
    return radius * (a - std::sin(a) - (b - std::sin(b)));
  };
  double low = 0.1, high = 2 * pi - 0.1;
  for (int k = 0; k < 60; ++k) (width(0.5 * (low + high)) < x ? low : high) = 0.5 * (low + high);
  return (low - first(low)) * std::sqrt((y + h) / (1 - std::cos(low)) / g);
}

/// ∫ of √(1 + y'²)/y^c over the arch from 0 back to 0 in T: by the first integral y^−c/√(1 + y'²).
double action_of_arch(double c, double T) {
  const auto beta = [](double a, double b) { return std::tgamma(a) * std::tgamma(b) / std::tgamma(a + b); };
  const double height = T * c / beta(0.5 + 0.5 / c, 0.5);
  return std::pow(height, 1 - c) / c * beta(0.5 / c - 0.5, 0.5);
}

}  // namespace

class SingularEnds : public Scenes {
 protected:
  Solution solved(const std::string& content) { return run(study(content)); }
};

TEST_F(SingularEnds, FallsFromRestItself) {
  struct Case {
    std::string lagrangian, boundary;
    double action;
  };
  const Case cases[] = {
      {fall, "start = { y = 0 }\nend = { y = 5 }\nduration = 10", time_of_fall(10, 5)},
      {fall, "start = { y = 5 }\nend = { y = 0 }\nduration = 10", time_of_fall(10, 5)},
      {fall, "start = { y = 0 }\nend = { y = 1 }\nduration = 1", time_of_fall(1, 1)},
      {fall, "start = { y = 0 }\nend = { y = 0.1 }\nduration = 1", time_of_fall(1, 0.1)},
      {fall, "start = { y = 0 }\nend = { y = 10 }\nduration = 1", time_of_fall(1, 10)},
      {fall, "start = { y = 0 }\nend = { y = 0 }\nduration = 10", std::sqrt(2 * pi * 10 / g)},
      {fall, "start = { y = 0 }\nduration = 10", std::sqrt(pi * 10 / g)},
      // A level at which coordinates have few digits.
      {"sqrt((1 + y'^2)/(2*9.81*(3 - y)))", "start = { y = 3 }\nend = { y = 1 }\nduration = 2",
       time_of_fall(2, 2)},
  };
  for (const Case& c : cases) {
    const Solution found = solved(singular_scene(c.lagrangian, c.boundary));
    ASSERT_TRUE(found.converged()) << c.boundary << ": " << found.message;
    EXPECT_NEAR(found.action, c.action, 1e-10) << c.boundary;
    EXPECT_EQ(found.morse_index, 0) << c.boundary;
    ASSERT_TRUE(found.energy && found.energy_drift) << c.boundary;
    EXPECT_LT(*found.energy_drift, 1e-7) << c.boundary;
    EXPECT_NE(found.message.find("L is infinite at the"), std::string::npos) << found.message;
  }
}

/// The layer at the start is as wide as h^1.5; h = 1e-5 and below take paths from deeper starts.
TEST_F(SingularEnds, FallsFromBesideRest) {
  for (const double h : {1e-3, 1e-5, 1e-6})
    for (const double depth : {0.1, 1.0, 2.0}) {
      const std::string end = fmt::format("start = {{ y = 0 }}\nend = {{ y = {} }}\nduration = 1", depth);
      const Solution found =
          solved(singular_scene(fmt::format("sqrt((1 + y'^2)/(2*9.81*(y + {})))", h), end));
      ASSERT_TRUE(found.converged()) << h << ' ' << depth << ": " << found.message;
      EXPECT_NEAR(found.action, time_of_fall_from(h, 1, depth), 1e-9) << h << ' ' << depth;
      EXPECT_EQ(found.morse_index, 0) << h << ' ' << depth;
    }
}

/// The fastest tunnel through a ball is a hypocycloid, of time sqrt(π² − (π − θ)²), and has no conjugate
/// points: all of them from one point cover the ball.
TEST_F(SingularEnds, TunnelsThroughABallAreMinima) {
  for (const double angle : {1.0, 2.6, 3.05, 3.1})
    for (const double tolerance : {1e-9, 1e-12}) {
      const Solution found =
          solved(singular_scene("sqrt(r'^2 + r^2)/sqrt(1 - r^2)",
                                fmt::format("start = {{ r = 1 }}\nend = {{ r = 1 }}\nduration = {}\n[guess]\n"
                                            "r = \"1 - 0.3*sin(pi*t/T)\"\n[solve]\ntolerance = {}\n",
                                            angle, tolerance),
                                "", "\"r\""));
      ASSERT_TRUE(found.converged()) << angle << ": " << found.message;
      EXPECT_NEAR(found.action, std::sqrt(pi * pi - (pi - angle) * (pi - angle)), 1e-9) << angle;
      EXPECT_EQ(found.morse_index, 0) << angle << ' ' << tolerance;
      EXPECT_TRUE(found.minimizing);
    }
}

TEST_F(SingularEnds, TheTrajectoryIsTheCycloid) {
  const Solution found = solved(singular_scene(fall, "start = { y = 0 }\nend = { y = 0 }\nduration = 10"));
  ASSERT_TRUE(found.converged()) << found.message;
  const double radius = 10 / (2 * pi);
  std::vector<double> y(1), slope(1);
  for (const double a : {1e-4, 0.01, 0.3, 1.0, 3.0, 5.0, 6.0, 6.28}) {
    found.trajectory.at(radius * (a - std::sin(a)), y, slope);
    EXPECT_NEAR(y[0], radius * (1 - std::cos(a)), 1e-9) << a;
    EXPECT_NEAR(slope[0] * (1 - std::cos(a)) / std::sin(a), 1, 1e-5) << a;
  }
}

TEST_F(SingularEnds, MediaOfOtherPowers) {
  for (const auto& [power, c] : {std::pair("^(1/3)", 1.0 / 3), {"^(1/4)", 0.25}}) {
    const Solution found = solved(singular_scene(std::string("sqrt(1 + y'^2)/y") + power,
                                                 "start = { y = 0 }\nend = { y = 0 }\nduration = 3"));
    ASSERT_TRUE(found.converged()) << found.message;
    EXPECT_NEAR(found.action, action_of_arch(c, 3), 1e-9) << power;
  }
}

/// The time to y = 1, or the action, of √(1 + y'²)/y^a by its first integral y^−a/√(1 + y'²) = c: with
/// z = (c y^a)^((1−a)/a) the integrands are smooth.
double time_to_one(double a, double c, bool action) {
  const double end = std::pow(c, 1 / a), power = (1 - a) / a;
  const int steps = 2000;
  double sum = 0;  // Simpson's rule
  const double top = std::pow(end, 1 - a);
  for (int k = 0; k <= 2 * steps; ++k) {
    const double z = top * k / (2 * steps), slope = std::pow(z, 1 / power),
                 f = (action ? 1 : slope * slope) / std::sqrt(1 - slope * slope);
    sum += f * (k == 0 || k == 2 * steps ? 1 : k % 2 == 1 ? 4 : 2);
  }
  sum *= top / (6 * steps) / (1 - a);
  return sum * std::pow(c, action ? 1 - 1 / a : -1 / a);
}

TEST_F(SingularEnds, PowersThatAreNoSimpleFractions) {
  for (const double a : {0.23, 0.3, 0.45, 0.55, 0.7, 0.8, 0.9}) {
    double low = 0, high = 1 - 1e-9;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (time_to_one(a, middle, false) < 0.8 ? low : high) = middle;
    }
    const Solution found = solved(singular_scene(fmt::format("sqrt(1 + y'^2)/y^{}", a),
                                                 "start = { y = 0 }\nend = { y = 1 }\nduration = 0.8"));
    ASSERT_TRUE(found.converged()) << a << ": " << found.message;
    EXPECT_NEAR(found.action, time_to_one(a, low, true), 1e-7) << a;
    ASSERT_TRUE(found.energy) << a;
    EXPECT_NEAR(*found.energy, -low, 1e-7) << a;
  }
}

/// One Lagrangian written so that nothing cancels at the end, and so that nearly all does.
TEST_F(SingularEnds, FormulasOfWhichTermsCancelAtTheEnd) {
  struct Pair {
    const char *apart, *cancelling, *ends;
  };
  for (const Pair& pair : {Pair{"(3 - y)*(3 + y)", "9 - y^2", "start = { y = 3 }\nend = { y = 2.5 }"},
                           Pair{"(3 - y)*(3 + y)", "9 - y^2", "start = { y = 2.5 }\nend = { y = 3 }"},
                           Pair{"2*exp(y/2)*sinh(y/2)", "exp(y) - 1", "start = { y = 0 }\nend = { y = 0.7 }"},
                           Pair{"2*(y - 2)/y", "1 - (4 - y)/y", "start = { y = 2 }\nend = { y = 3 }"}}) {
    const auto found = [&](const char* medium) {
      return solved(singular_scene(fmt::format("sqrt((1 + y'^2)/({}))", medium),
                                   fmt::format("{}\nduration = 0.6", pair.ends)));
    };
    const Solution expected = found(pair.apart), other = found(pair.cancelling);
    ASSERT_TRUE(expected.converged()) << pair.apart << ": " << expected.message;
    ASSERT_TRUE(other.converged()) << pair.cancelling << ": " << other.message;
    EXPECT_NEAR(other.action, expected.action, 1e-10) << pair.cancelling;
    EXPECT_NEAR(*other.energy, *expected.energy, 1e-8) << pair.cancelling;
  }
}

/// From rest at infinity, x' = √(2c) x^(−a/2): x ~ t^(1/(1 + a/2)), and the action is ∫ x' dx.
TEST_F(SingularEnds, WeakPowers) {
  for (const double a : {0.1, 0.2, 0.25, 0.4}) {
    const double c = 0.3, duration = 1 / (std::sqrt(2 * c) * (1 + a / 2)),
                 action = std::sqrt(2 * c) / (1 - a / 2);
    const Solution found = solved(
        singular_scene(fmt::format("y'^2/2 + {}/y^{}", c, a),
                       fmt::format("start = {{ y = 0 }}\nend = {{ y = 1 }}\nduration = {:.17g}", duration)));
    ASSERT_TRUE(found.converged()) << a << ": " << found.message;
    EXPECT_NEAR(found.action, action, 1e-10) << a;
    EXPECT_NEAR(found.momentum_end.at(0), std::sqrt(2 * c), 1e-8) << a;
  }
}

TEST_F(SingularEnds, InSeveralCoordinatesAndFromGuesses) {
  // Along the diagonal the way is √(10² + 3²) long.
  const Solution slanted = solved(
      singular_scene("sqrt((1 + y'^2 + z'^2)/(2*9.81*y))",
                     "start = { y = 0, z = 0 }\nend = { y = 5, z = 3 }\nduration = 10", "", "\"y\", \"z\""));
  ASSERT_TRUE(slanted.converged()) << slanted.message;
  EXPECT_NEAR(slanted.action, time_of_fall(std::hypot(10, 3), 5), 1e-10);
  const Solution guessed = solved(singular_scene(fall, "start = { y = 0 }\nend = { y = 0 }\nduration = 10",
                                                 "[guess]\ny = \"t*(10 - t)/10\"\n"));
  ASSERT_TRUE(guessed.converged()) << guessed.message;
  EXPECT_NEAR(guessed.action, std::sqrt(2 * pi * 10 / g), 1e-10);
}

TEST_F(SingularEnds, ARadialCollisionOfKepler) {
  const Solution found =
      solved(singular_scene("r'^2/2 + 1/r", "start = { r = 0 }\nend = { r = 1 }\nduration = 1", "", "\"r\""));
  ASSERT_TRUE(found.converged()) << found.message;
  // r = a (1 − cos η), t = a^{3/2} (η − sin η).
  const double a = -0.5 / *found.energy, eta = std::acos(1 - 1 / a);
  EXPECT_NEAR(std::pow(a, 1.5) * (eta - std::sin(eta)), 1, 1e-8);
}

TEST_F(SingularEnds, LayersThinnerThanTheDigitsOfTheTime) {
  LONG_TEST();
  for (const double mu : {50.0, 70.0, 100.0}) {
    const std::string lagrangian = fmt::format("y'^2/2 + cosh({}*y)", mu);
    for (const bool late : {true, false}) {
      const Solution found = solved(singular_scene(
          lagrangian,
          fmt::format("start = {{ y = {} }}\nend = {{ y = {} }}\nduration = 1", late ? 0 : 1, late ? 1 : 0)));
      ASSERT_TRUE(found.converged()) << mu << ": " << found.message;
      // ∫ √(2 (cosh(μ y) − 1)) dy + T.
      EXPECT_NEAR(found.action / (4 / mu * (std::cosh(mu / 2) - 1) + 1), 1, 1e-9) << mu;
      const double slope = late ? found.momentum_end[0] : -found.momentum_start[0];
      EXPECT_NEAR(slope / std::sqrt(2 * std::cosh(mu) - 2), 1, 1e-9) << mu;
      EXPECT_EQ(found.morse_index, 0) << mu;
      std::vector<double> y(1), v(1);
      for (const double t : {0.0, 1.0}) {
        found.trajectory.at(t, y, v);
        EXPECT_NEAR(y[0], (t == 1) == late, 1e-12) << mu << " at " << t;
      }
    }
  }
}

TEST_F(SingularEnds, WithoutAFiniteActionThereIsNone) {
  for (const char* lagrangian : {"y'^2/2 + 1/y^2", "y'^2/2 - 1/y", "sqrt(1 + y'^2)/y"}) {
    const Solution found =
        solved(singular_scene(lagrangian, "start = { y = 0 }\nend = { y = 1 }\nduration = 1"));
    EXPECT_FALSE(found.converged()) << lagrangian;
    EXPECT_NE(found.message.find("L is not finite at the start"), std::string::npos) << found.message;
  }
}

TEST_F(SingularEnds, DurationsThatTheEnergyCloses) {
  for (const double T : {2.0, 10.0}) {
    const std::string ends = "start = { y = 0 }\nend = { y = 1 }\n";
    const Solution given = solved(singular_scene(fall, ends + fmt::format("duration = {}", T)));
    ASSERT_TRUE(given.converged()) << given.message;
    const Solution free = solved(
        singular_scene(fall, ends + fmt::format("duration = \"free\"\nenergy = {:.17g}", *given.energy),
                       fmt::format("[guess]\nduration = {}\n", 0.9 * T)));
    ASSERT_TRUE(free.converged()) << free.message;
    EXPECT_NEAR(free.duration(), T, 1e-8 * T);
    EXPECT_NEAR(free.action, given.action, 1e-9);
    EXPECT_LT(free.error_estimate, 1e-8 * T);
  }
}

/// Where the free end comes to a given level.
TEST_F(SingularEnds, DurationsThatAConditionCloses) {
  const Solution found = solved(singular_scene(
      fall, "start = { y = 0 }\nduration = \"free\"\nwhere = \"y(T) = 2\"", "[guess]\nduration = 10\n"));
  ASSERT_TRUE(found.converged()) << found.message;
  // Half an arch of a cycloid of radius 1.
  EXPECT_NEAR(found.duration(), pi, 1e-8);
  EXPECT_NEAR(found.action, std::sqrt(pi * pi / g), 1e-9);
}

TEST_F(SingularEnds, FamiliesFromValueToValue) {
  const std::string ends = "start = { y = 0 }\nend = { y = 5 }\n";
  const Study in_time = study(singular_scene(
      fall, ends + "duration = 10", "[continuation]\nparameter = \"duration\"\nto = 4\npoints = 4\n"));
  for (const BranchPoint& point : follow(in_time).points)
    EXPECT_NEAR(point.solution.action, time_of_fall(point.parameter, 5), 1e-9) << point.parameter;
  EXPECT_EQ(follow(in_time).points.size(), 4u);
  std::string heavier = singular_scene("sqrt((1 + y'^2)/(2*w*y))", ends + "duration = 10",
                                       "[continuation]\nparameter = \"w\"\nto = 39.24\npoints = 4\n");
  heavier.replace(heavier.find("lagrangian"), 0, "parameters = { w = 9.81 }\n");
  const FollowedBranch branch = follow(study(heavier));
  EXPECT_EQ(branch.branches.front().end, BranchEnd::target) << branch.branches.front().message;
  EXPECT_NEAR(branch.points.back().solution.action, time_of_fall(10, 5) / 2, 1e-9);
}

/// x'' = 1/√t: x = 4/3 t^(3/2) − t/3 and S = 19/18. At either end, and in a motion x'' + w² x = 1/√t that has
/// conjugate points at π/w, 2π/w, …
TEST_F(SingularEnds, ForcesThatAreInfiniteAtATime) {
  const std::string ends = "start = { x = 0 }\nend = { x = 1 }\nduration = 1",
                    reversed = "start = { x = 1 }\nend = { x = 0 }\nduration = 1";
  const auto scene = [&](const std::string& lagrangian, const std::string& boundary) {
    return singular_scene(lagrangian, boundary, "", "\"x\"");
  };
  const Solution late = solved(scene("x'^2/2 + x/sqrt(t)", ends)),
                 early = solved(scene("x'^2/2 + x/sqrt(1 - t)", reversed));
  for (const Solution* found : {&late, &early}) {
    ASSERT_TRUE(found->converged()) << found->message;
    EXPECT_NEAR(found->action, 19.0 / 18, 1e-12);
    EXPECT_EQ(found->morse_index, 0);
    EXPECT_NE(found->message.find("L is singular in t"), std::string::npos) << found->message;
  }
  std::vector<double> x(1), v(1);
  late.trajectory.at(0.3, x, v);
  EXPECT_NEAR(x[0], 4 / 3.0 * std::pow(0.3, 1.5) - 0.1, 1e-10);
  EXPECT_NEAR(late.momentum_start.at(0), -1 / 3.0, 1e-10);
  for (const auto& [w, index] : {std::pair(2.0, 0), {4.0, 1}, {7.0, 2}})
    for (const char* force : {"x/sqrt(t)", "x/sqrt(t*(1 - t))", "x*log(t)", "x/t^0.4"}) {
      const Solution found = solved(scene(fmt::format("x'^2/2 - {}*x^2/2 + {}", w * w, force), ends));
      ASSERT_TRUE(found.converged()) << force << ": " << found.message;
      EXPECT_EQ(found.morse_index, index) << force << ' ' << w;
    }
  // A place that moves: singular at t = 0 for x = 0 alone.
  const Solution moving = solved(scene("x'^2/2 + log((x - t)^2)", ends));
  EXPECT_NE(moving.message.find("L is not finite at the start, x = 0; move this end"), std::string::npos)
      << moving.message;
}

/// x'' = τ^p with the time τ from an end is finite, but no polynomial begins like it, and momenta at the ends
/// miss some of it: elements become shorter there.
TEST_F(SingularEnds, ForcesThatBeginSteeply) {
  for (const double p : {0.05, 0.1, 0.3, 0.5, 0.7}) {
    const double c = 1 / ((1 + p) * (2 + p)), slow = 1 - c, fast = slow + 1 / (1 + p);
    const double action = (fast + slow / (2 + p) + c / (3 + 2 * p)) / 2;
    for (const bool at_end : {false, true}) {
      const std::string time = at_end ? "(1 - t)" : "t", ends = at_end ? "start = { y = 1 }\nend = { y = 0 }"
                                                                       : "start = { y = 0 }\nend = { y = 1 }";
      const Solution found =
          solved(singular_scene(fmt::format("y'^2/2 + y*{}^{}", time, p), ends + "\nduration = 1"));
      ASSERT_TRUE(found.converged()) << p << ' ' << at_end << ": " << found.message;
      EXPECT_NEAR(found.action, action, 1e-9);
      const double allowed = 2e-8;  // ten tolerances, and that is an estimate
      EXPECT_NEAR(found.momentum_start[0], at_end ? -fast : slow, allowed);
      EXPECT_NEAR(found.momentum_end[0], at_end ? -slow : fast, allowed);
    }
  }
}

/// Radial Bessel functions: L = t u'²/2 − w² t u²/2 + u²/(2t), u = J₁(w t)/J₁(w) and S = u'(1)/2, with the
/// zeros of J₁ at 3.83, 7.02 and 10.17.
TEST_F(SingularEnds, CentrifugalTermsAreRegularAlongTheMotion) {
  for (const auto& [w, index] : {std::pair(2.0, 0), {5.0, 1}, {8.0, 2}, {12.0, 3}}) {
    const Solution found =
        solved(singular_scene(fmt::format("t*u'^2/2 - {}*t*u^2/2 + u^2/(2*t)", w * w),
                              "start = { u = 0 }\nend = { u = 1 }\nduration = 1", "", "\"u\""));
    ASSERT_TRUE(found.converged()) << w << ": " << found.message;
    const double slope = w * std::cyl_bessel_j(0, w) / std::cyl_bessel_j(1, w) - 1;
    EXPECT_NEAR(found.action, slope / 2, 1e-11 * std::abs(slope)) << w;
    EXPECT_EQ(found.morse_index, index) << w;
    std::vector<double> u(1), v(1);
    for (const double t : {1e-6, 0.01, 0.37}) {
      found.trajectory.at(t, u, v);
      EXPECT_NEAR(u[0], std::cyl_bessel_j(1, w * t) / std::cyl_bessel_j(1, w), 1e-9) << w << ' ' << t;
    }
  }
}

/// L = t^a u'²/2: u = 1 + c t^(1−a) and S = (1 − a) (u(1) − 1)²/2 for a < 1.
TEST_F(SingularEnds, WeightsThatVanishAtATime) {
  const std::string ends = "start = { u = 1 }\nend = { u = 0.3 }\nduration = 1";
  for (const double a : {0.25, 0.5, 2.0 / 3, 0.8, 0.9}) {
    const Solution found = solved(singular_scene(fmt::format("t^{}*u'^2/2", a), ends, "", "\"u\""));
    ASSERT_TRUE(found.converged()) << a << ": " << found.message;
    EXPECT_NEAR(found.action, (1 - a) * 0.49 / 2, 1e-10) << a;
  }
  for (const char* weight : {"t", "t^2"}) {
    const Solution found =
        solved(singular_scene(fmt::format("{}*(u'^2 + u^2)/2", weight), ends, "", "\"u\""));
    EXPECT_EQ(found.status, Status::no_solution_near) << weight;
    EXPECT_NE(found.message.find("leave the coordinates out of 'start'"), std::string::npos) << found.message;
  }
}

/// x'' = t^−a between x = 0 and 0: S = (1/(3 − 2a) − 1/(2 − a))/(2 (1 − a)(2 − a)), at either end. From a = 1
/// on the momentum is infinite, and where the action hardly converges that is told.
TEST_F(SingularEnds, ForcesOfAnyPowerOfTheTime) {
  const std::string ends = "start = { x = 0 }\nend = { x = 0 }\nduration = 1";
  for (const double a : {0.25, 1.0 / 3, 0.6, 0.85, 1.2})
    for (const char* time : {"t", "(1 - t)"}) {
      const Solution found =
          solved(singular_scene(fmt::format("x'^2/2 + x*{}^(-{:.17g})", time, a), ends, "", "\"x\""));
      ASSERT_TRUE(found.converged()) << a << ' ' << time << ": " << found.message;
      EXPECT_NEAR(found.action, (1 / (3 - 2 * a) - 1 / (2 - a)) / (2 * (1 - a) * (2 - a)), 2e-10)
          << a << time;
      EXPECT_EQ(found.morse_index, 0) << a << ' ' << time;
      const std::vector<double>& momentum = time[0] == 't' ? found.momentum_start : found.momentum_end;
      EXPECT_EQ(momentum.empty(), a > 0.6) << a << ' ' << time;  // infinite, or of a slow power
      if (!momentum.empty()) {
        EXPECT_NEAR(std::abs(momentum[0]), 1 / ((1 - a) * (2 - a)), 1e-8) << a << ' ' << time;
      }
    }
  const Solution slow = solved(singular_scene("x'^2/2 + x*t^(-1.45)", ends, "", "\"x\""));
  EXPECT_NE(slow.message.find("converges too slowly towards the start"), std::string::npos) << slow.message;
}

/// Bessel functions of any order m, whose power t^m is that of Euler's equation; also where that attracts:
/// L = x'²/2 − c x²/(2t²) has x = t^r, r = ½ + √(¼ − c), with the action r/2, and its index is not told.
TEST_F(SingularEnds, PowersOfEulersEquation) {
  for (const double m : {0.3, 0.5, 2.7}) {
    const Solution found =
        solved(singular_scene(fmt::format("t*u'^2/2 - 49*t*u^2/2 + {}*u^2/(2*t)", m * m),
                              "start = { u = 0 }\nend = { u = 1 }\nduration = 1", "", "\"u\""));
    ASSERT_TRUE(found.converged()) << m << ": " << found.message;
    std::vector<double> u(1), v(1);
    for (const double t : {0.01, 0.37}) {
      found.trajectory.at(t, u, v);
      EXPECT_NEAR(u[0], std::cyl_bessel_j(m, 7 * t) / std::cyl_bessel_j(m, 7.0), 1e-8) << m << ' ' << t;
    }
  }
  for (const double c : {0.1, 0.1875, 0.2}) {
    const Solution found =
        solved(singular_scene(fmt::format("x'^2/2 - {}*x^2/(2*t^2)", c),
                              "start = { x = 0 }\nend = { x = 1 }\nduration = 1", "", "\"x\""));
    ASSERT_TRUE(found.converged()) << c << ": " << found.message;
    EXPECT_NEAR(found.action, (0.5 + std::sqrt(0.25 - c)) / 2, 1e-9) << c;
    EXPECT_FALSE(found.morse_index) << c;
  }
}

/// Extremals there are, but their actions are infinite.
TEST_F(SingularEnds, ActionsThatDivergeAtATimeAreNone) {
  for (const char* term : {"u^2/(2*t)", "1/t", "u^2/t^1.5"}) {
    const Solution found = solved(singular_scene(
        fmt::format("u'^2/2 + {}", term), "start = { u = 1 }\nend = { u = 2 }\nduration = 1", "", "\"u\""));
    EXPECT_FALSE(found.converged()) << term << ": " << found.action;
  }
}

/// Beside the start L is finite, about the end it is not.
TEST_F(SingularEnds, TheEndOutsideOfTheDomainIsNamed) {
  const Solution found =
      solved(singular_scene("sqrt((1 + y'^2)/y)", "start = { y = 0 }\nend = { y = -2 }\nduration = 3"));
  EXPECT_EQ(found.message.find("L is not finite about the end, y = -2; move this end"), 0u) << found.message;
}

/// Where L is finite but not its momenta.
TEST_F(SingularEnds, MeanVelocitiesAtTheLargestOneAreOutOfReach) {
  const Solution found =
      solved(singular_scene("-sqrt(1 - y'^2) - y^2/3", "start = { y = 1 }\nend = { y = 4 }\nduration = 3"));
  EXPECT_NE(found.message.find("they may be out of reach in this duration; try a longer one"),
            std::string::npos)
      << found.message;
}

TEST_F(SingularEnds, WhatIsNotAvailableIsRefused) {
  const std::string ends = "start = { y = 0 }\nend = { y = 5 }\nduration = 10";
  const auto refused = [&](const std::string& boundary, const std::string& more, const std::string& place,
                           const std::string& part) {
    const std::string text = message(singular_scene(fall, boundary, more));
    EXPECT_EQ(text.find("scene.toml:" + place + ": L is infinite at the start, y = 0, and there " + part), 0u)
        << text;
    EXPECT_NE(text.find(", or move the start aside, to y = 0.0"), std::string::npos) << text;
  };
  refused(ends, "[search]\nsolutions = 2\n", "9:13", "[search] is not available; leave it out");
  refused(ends, "[solve]\nscheme = \"midpoint\"\n", "9:11", "elements of 'midpoint' are not adapted");
  refused(ends, "[solve]\nscheme = \"simpson\"\nelements = 9\n", "9:11",
          "'simpson' evaluates it; write gauss(s)");
  refused(ends, "[path]\nconstraints = [\"y <= 6\"]\n", "8:1", "[path] is not available");
  refused(ends + "\nintegrals = [\"y = 30\"]", "", "8:15", "integrals are not available");
  refused("start = { y = 0 }\nend = { p_y = 0.1 }\nduration = 10", "", "6:9", "momenta at ends");
  EXPECT_EQ(message(singular_scene(fall, "start = { y = 0.005 }\nend = { y = 5 }\nduration = 10",
                                   "[search]\nsolutions = 2\n")),
            "");
  // Gauss's rule has no point at the ends.
  const Solution pinned =
      solved(singular_scene(fall, ends, "[solve]\nscheme = \"gauss(3)\"\nelements = 200\n"));
  ASSERT_TRUE(pinned.converged()) << pinned.message;
  EXPECT_NEAR(pinned.action, time_of_fall(10, 5), 0.2);
}
