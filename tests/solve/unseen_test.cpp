#include <cmath>
#include <numbers>

#include "machine/long_test.hpp"
#include "solve/laws.hpp"
#include "solve/refused.hpp"
#include "study/study.hpp"

/// \file What the points of the elements do not see, and what roundoff hides, is no solution.

namespace extremal::laws {
namespace {

/// A body that falls in from 370 lengths away, free to start anywhere, meets the centre's force in the last
/// 0.003 of its way, between two points of the last element; near a focal point that moves its start by far
/// more than its end.
TEST(Unseen, ForceJustBeforeTheEnd) {
  LONG_TEST();
  const auto hill = trace(3, [](auto q, auto v, auto) {
    const auto r = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + (q[0] * v[1] - q[1] * v[0]) + 1.5 * q[0] * q[0] -
           q[2] * q[2] / 2 + 1 / r;
  });
  const Problem problem = with_ends(hill, 1.8386363858303114, [](BoundaryRelation& b) {
    b.fix(0, true, 0.09888550987587896);
    b.fix(1, true, -0.7612695457414451);
    b.fix(2, true, 0.4111700014519001);
  });
  const Solution exact = solve(problem, within(1e-12));
  int refused = 0;
  for (const double tolerance : {1e-5, 8e-7, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11}) {
    const Solution s = Solver().solve(problem, within(tolerance));
    refused += !s.converged();
    if (!s.converged()) continue;
    if (s.strategy != exact.strategy) {
      expect_verified(problem, s, tolerance);
      continue;
    }
    Values q(3), v(3);
    const double error = distance(s.trajectory, [&](double t) { return exact.trajectory.at(t, q, v), q; });
    EXPECT_LT(error, 10 * std::max(s.error_estimate, tolerance)) << tolerance;
  }
  EXPECT_LT(refused, 7);
}

/// A wall that repels over a hundredth throws a body far away, where it is long at full speed: an element
/// that begins at the wall may have hardly another point in its reach. E = p²/2 + V holds, so p(0) follows
/// from p(T).
TEST(Unseen, MomentumAtAWall) {
  LONG_TEST();
  const double start = 0.075;
  const auto answer = [&](double strength, double end, double tolerance) {
    const auto wall = trace(1, [&](auto q, auto v, auto) {
      const auto q2 = q[0] * q[0], q4 = q2 * q2;
      return v[0] * v[0] / 2 - strength / (q4 * q4 * q4);
    });
    Solution s = Solver().solve(fixed_ends(wall, {start}, {end}, 1), within(tolerance));
    if (!s.converged()) return false;
    const auto twice_potential = [&](double q) { return 2 * strength / std::pow(q, 12); };
    const double last = s.momentum_end[0],
                 square = last * last + twice_potential(end) - twice_potential(start);
    EXPECT_NEAR(std::abs(s.momentum_start[0]), std::sqrt(std::max(square, 0.0)), 100 * tolerance * last)
        << end << ' ' << tolerance;
    return true;
  };
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
    answer(1.9, 1.4e7, tolerance);
    EXPECT_TRUE(answer(1e-15, 0.5, tolerance));
  }
}

/// From rest at the wall the body would arrive in about half the time: there is no extremal, though elements
/// of given schemes that step over the wall, and others of higher degree on the same mesh, find the same
/// path.
TEST(Unseen, NoMotionFromAWall) {
  LONG_TEST();
  const double start = 0.075, end = 40;
  const auto from_wall = [&](double potential) {
    const double strength = potential * end * end / 2 * std::pow(start, 12);
    const auto wall = trace(1, [&](auto q, auto v, auto) {
      const auto q2 = q[0] * q[0], q4 = q2 * q2;
      return v[0] * v[0] / 2 - strength / (q4 * q4 * q4);
    });
    return fixed_ends(wall, {start}, {end}, 1);
  };
  int found = 0;
  for (const char* name : {"linear", "rectangle", "quadratic", "lobatto(3)", "gauss(4)"})
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6}) {
      SolveOptions options = within(tolerance);
      options.scheme = scheme(name);
      EXPECT_FALSE(Solver().solve(from_wall(4), options).converged()) << name << ' ' << tolerance;
      found += tolerance == 1e-6 && Solver().solve(from_wall(0.9), options).converged();
    }
  // Momenta of rectangles are of first order: velocities would need more elements than there may be.
  EXPECT_GE(found, 3);
}

/// To fall by 1 with energy E = v0²/2 takes √(v0² + 2) − v0, with v0 of either sign; √2 at E = 0, the least,
/// where a last digit of E is half the digits of T.
TEST(Unseen, RoundoffOfTheEnergyAtAFold) {
  const auto falling = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + q[0]; });
  std::vector<SolveOptions> ways{within(1e-4), within(1e-9), within(1e-12)};
  for (const double tolerance : {1e-7, 1e-11}) {
    ways.push_back(within(tolerance));
    ways.back().scheme = scheme("quadratic");
  }
  for (const double energy : {0.0, 1e-12, 1e-6, 1e-2})
    for (const SolveOptions& options : ways) {
      Problem problem = fixed_ends(falling, {0}, {1}, 1.3);
      problem.duration = {.value = 1.3, .free = true, .energy = energy, .where = {}};
      const Solution s = Solver().solve(make_problem(problem), options);
      EXPECT_TRUE(s.converged() || energy < 1e-2) << options.tolerance << ": " << s.message;
      if (!s.converged()) continue;
      const double v0 = std::sqrt(2 * energy), fall = std::sqrt(v0 * v0 + 2);
      const double error = std::min(std::abs(s.duration() - fall + v0), std::abs(s.duration() - fall - v0));
      EXPECT_LT(error, 10 * s.error_estimate + 1e-15) << energy << ' ' << options.tolerance;
      EXPECT_EQ(s.nullity, 0);
    }
}

/// A body is led along x, a well at y = 0 holds it less than exponentially far away, where every direction
/// across is null: it rests at the well's bottom, or nowhere.
TEST(Unseen, WherePullsVanish) {
  LONG_TEST();
  const auto well =
      trace(2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 + exp(-(q[1] * q[1])); });
  const auto led = with_ends(well, 1, [](BoundaryRelation& b) {
    b.fix(0, false, 0);
    b.fix(0, true, 1);
  });
  for (const double aside : {0.3, 1.0, 1.5, 2.0, 3.0})
    for (const double tolerance : {1e-4, 1e-9}) {
      const Solution s = Solver().solve(guessed(led,
                                                [&](double tau) {
                                                  return Values{tau, aside};
                                                }),
                                        within(tolerance));
      if (!s.converged()) continue;
      for (std::size_t k = 1; k < s.trajectory.nodes.size(); k += 2)
        ASSERT_NEAR(s.trajectory.nodes[k], 0, 10 * tolerance) << aside;
    }
}

/// Scenes that have no solution near their guess, or none that double precision tells from others: the path
/// that Newton's method finds is refused, and only another guess may lead to a solution. Roundoff that more
/// elements do not reduce is found by few.
TEST(Unseen, ScenesThatAreRefused) {
  LONG_TEST();
  const auto refused = [](const char* name) {
    const Study study = load(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/refused/" + name + ".toml");
    const SolveOptions& options = study.options;
    Solution first = first_judged(study.problem, counted(options));
    EXPECT_FALSE(first.converged()) << name;
    const Solution s = Solver().solve(study.problem, counted(options));
    if (s.converged()) {
      EXPECT_NE(s.strategy, "newton from the guess") << name;
      expect_verified(study.problem, s, options.tolerance);
    } else {
      EXPECT_EQ(s.status, first.status) << name;
      EXPECT_EQ(s.message, first.message) << name;
    }
    return first;
  };
  for (const char* name : {"lennard-jones-ran-away", "lennard-jones-aside", "lennard-jones-drifting",
                           "lennard-jones-coupled", "lennard-jones-pulled"}) {
    const Solution away = refused(name);
    EXPECT_EQ(away.status, Status::not_converged) << name;
    EXPECT_NE(away.message.find("forces nearly vanish"), std::string::npos) << away.message;
  }
  EXPECT_EQ(refused("magnetic-dipole-gyration").status, Status::not_converged);
  refused("j2-orbit-open");
  refused("j2-orbit-far");
  refused("magnetic-field-at-rest");
  const Solution apart = refused("lennard-jones-apart");
  EXPECT_NE(apart.message.find("roundoff"), std::string::npos) << apart.message;
  EXPECT_LT(apart.iterations, 100);
  const Solution encounter = refused("nbody-near-collision");
  EXPECT_NE(encounter.message.find("changes velocities"), std::string::npos) << encounter.message;
}

/// A force w⁻¹ exp(−((t − a)/w)²) that first elements have no point in; twice its integral is known.
TEST(Unseen, PulseInTime) {
  for (const double a : {0.07, 0.3, 0.91})
    for (const double w : {3e-3, 1e-3, 3e-4, 1e-4}) {
      const auto pulse = trace(1, [&](auto q, auto v, auto t) {
        return v[0] * v[0] / 2 + 3 / w * q[0] * exp(-((t - a) / w) * ((t - a) / w));
      });
      const Solution s = solve(fixed_ends(pulse, {0}, {1}, 1), within(1e-9));
      const auto twice = [&](double t) {  // of the force, from 0 to t
        const double u = (t - a) / w;
        return 3 * w * (0.5 * std::sqrt(std::numbers::pi) * u * (1 + std::erf(u)) + 0.5 * std::exp(-u * u));
      };
      Values q(1), v(1);
      for (const double t : {0.5 * a, a, 0.5 + 0.5 * a}) {
        s.trajectory.at(t, q, v);
        EXPECT_NEAR(q[0], t * (1 - twice(1)) + twice(t), 2e-8) << a << ' ' << w << ' ' << t;
      }
    }
}

/// A force w⁻¹/cosh²((t − a)/w), and its integral over time, tanh: the integrals of (1 − t) by them tell
/// p(0).
TEST(Unseen, PulseAndStepOfHyperbolicFunctions) {
  const double a = 0.3;
  for (const double w : {3e-3, 3e-4, 1e-4}) {
    const auto log_cosh = [](double u) { return u + std::log1p(std::exp(-2 * u)) - std::log(2.0); };  // u > 0
    const double rise = w * (log_cosh((1 - a) / w) - log_cosh(a / w));  // of ∫ tanh, from 0 to 1
    const auto pulse = trace(1, [&](auto q, auto v, auto t) {
      const auto c = cosh((t - a) / w);
      return v[0] * v[0] / 2 + q[0] / (w * c * c);
    });
    const Solution s = solve(fixed_ends(pulse, {0}, {1}, 1), within(1e-9));
    EXPECT_NEAR(s.momentum_start[0], 1 - std::tanh(a / w) - rise, 1e-8) << w;
    const auto step =
        trace(1, [&](auto q, auto v, auto t) { return v[0] * v[0] / 2 + q[0] * tanh((t - a) / w); });
    const Solution late = solve(fixed_ends(step, {0}, {1}, 1), within(1e-9));
    // Of a sharp step; its width adds π² w²/12.
    const double sharp = 0.5 * (1 - a) * (1 - a) + 0.5 * a * a - a;
    const double width = std::numbers::pi * std::numbers::pi * w * w / 12;
    EXPECT_NEAR(late.momentum_start[0], 1 - sharp - width, 1e-8) << w;
  }
}

/// A barrier at a place that first elements pass between two points. The time that it takes is known by
/// quadrature from the energy.
TEST(Unseen, PulseInSpace) {
  for (const double height : {0.3, -2.0})
    for (const double w : {3e-3, 1e-3, 3e-4, 1e-4}) {
      const auto barrier = trace(1, [&](auto q, auto v, auto) {
        return v[0] * v[0] / 2 - height * exp(-((q[0] - 0.3) / w) * ((q[0] - 0.3) / w));
      });
      const Solution s = solve(fixed_ends(barrier, {0}, {1}, 1), within(1e-9));
      const double p = s.momentum_start[0];
      double time = 1 / p;
      constexpr int steps = 2000;
      constexpr double reach = 7;
      for (int k = 0; k <= steps; ++k) {  // the trapezoidal rule, exact for what vanishes at both ends
        const double u = reach * (2.0 * k / steps - 1);
        const double speed = std::sqrt(p * p - 2 * height * std::exp(-u * u));
        time += (1 / speed - 1 / p) * w * 2 * reach / steps;
      }
      EXPECT_NEAR(time, 1, 1e-8) << height << ' ' << w;
    }
}

}  // namespace
}  // namespace extremal::laws
