#include "problem/recurrence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "action/systems.hpp"
#include "problem/problem.hpp"

/// \file Motions recur where forces do and momenta close; elsewhere periodic problems are refused.

namespace extremal {
namespace {

using std::numbers::pi;
using Values = std::vector<double>;

/// One coordinate, q(T) = sign q(0) + shift, guessed by a swing.
Problem oscillation(std::shared_ptr<const Lagrangian> lagrangian, double T, double sign = 1,
                    double shift = 0) {
  Problem problem;
  problem.lagrangian = std::move(lagrangian);
  problem.names = {"x"};
  problem.boundary.coordinates = 1;
  const int row = problem.boundary.add_row(shift);
  problem.boundary.add(row, 0, -sign);
  problem.boundary.add(row, 1, 1);
  problem.periodic = true;
  problem.duration.value = T;
  for (int k = 0; k <= 20; ++k) {
    problem.guess.tau.push_back(k / 20.0);
    problem.guess.q.push_back(0.3 * std::cos(pi * k / 10) + shift * k / 20);
  }
  return problem;
}

/// What the problem is refused with; "" if it is not.
std::string refused_with(const Problem& problem) {
  try {
    check_recurrence(problem);
    return "";
  } catch (const RecurrenceError& e) {
    return e.what();
  }
}

/// x'²/2 − 2x² and a term of x, x' and t.
template <class Term>
auto oscillator(const Term& term) {
  return trace(
      1, [term](auto q, auto v, auto t) { return v[0] * v[0] / 2 - 2 * q[0] * q[0] + term(q[0], v[0], t); });
}

/// x² cos t repeats after 2π; no time makes x³ what it is at −x.
TEST(Recurrence, MapsThatChangeLAtAllTimesAreToldFromDurations) {
  const auto driven = oscillator([](auto x, auto, auto t) { return x * x * x / 5 + x * x * cos(t); });
  const std::string refused = refused_with(oscillation(driven, pi, -1));
  EXPECT_NE(refused.find("; L repeats after 6.28318530717959, but the map changes it: leave the map out"),
            std::string::npos)
      << refused;
}

TEST(Recurrence, DrivesOfAnotherPeriodAreRefused) {
  const auto driven = oscillator([](auto x, auto, auto t) { return 0.5 * x * cos(1.4 * pi * t); });
  const std::string refused = refused_with(oscillation(driven, 1));
  EXPECT_EQ(refused.rfind("L does not repeat after the duration 1: the force on x changes by ", 0), 0u)
      << refused;
  EXPECT_NE(refused.find("L repeats after 1.42857142857143"), std::string::npos) << refused;
  EXPECT_EQ(refused_with(oscillation(driven, 1.42857142857143)), "");
  EXPECT_EQ(refused_with(oscillation(driven, 3 * 1.42857142857143)), "");
  EXPECT_NE(refused_with(oscillation(driven, 1.4285)), "");
}

/// The force changes by at most the difference of two cosines, and by nearly that somewhere.
TEST(Recurrence, AmountsAreThoseOfTheForce) {
  const double f = 0.5, omega = 2.3, T = 1.7, most = 2 * f * std::abs(std::sin(omega * T / 2));
  const auto change = closing_change(
      oscillation(oscillator([=](auto x, auto, auto t) { return f * x * cos(omega * t); }), T), T);
  ASSERT_TRUE(change);
  EXPECT_FALSE(change->momentum);
  EXPECT_LE(change->change, most * (1 + 1e-9));
  EXPECT_GT(change->change, 0.95 * most);
}

TEST(Recurrence, PeriodsOfL) {
  const auto time = [](const auto& term) {
    return recurrence_time(oscillation(oscillator(term), 1)).value_or(NAN);
  };
  EXPECT_NEAR(time([](auto x, auto, auto t) { return x * cos(t) * cos(t); }), pi, 1e-12);
  EXPECT_NEAR(time([](auto x, auto, auto t) { return x * tan(2 * t) / 9; }), pi / 2, 1e-12);
  EXPECT_NEAR(time([](auto x, auto, auto t) { return x * sin(2 * t) + x * x * cos(3 * t + 1); }), 2 * pi,
              1e-12);
  EXPECT_NEAR(time([](auto x, auto, auto t) { return cos(x - 5 * t); }), 2 * pi / 5, 1e-12);
  EXPECT_NEAR(time([](auto x, auto, auto t) { return x / (2 + exp(sin(0.7 * t))); }), 2 * pi / 0.7, 1e-12);
  EXPECT_TRUE(std::isnan(time([](auto x, auto, auto t) { return x * (cos(t) + cos(std::sqrt(2) * t)); })));
  EXPECT_TRUE(std::isnan(time([](auto x, auto, auto t) { return x * exp(0.2 * t); })));
}

TEST(Recurrence, WhatGrowsOrDecaysIsRefused) {
  const auto grows = oscillator([](auto x, auto, auto t) { return x * exp(0.2 * t); });
  EXPECT_NE(refused_with(oscillation(grows, 1)).find("outside of sin, cos and tan"), std::string::npos);
  // Its equation of motion, x'' + 0.2 x' + 4x = 0, repeats; its momenta do not.
  const auto damped =
      trace(1, [](auto q, auto v, auto t) { return exp(0.2 * t) * (v[0] * v[0] / 2 - 2 * q[0] * q[0]); });
  EXPECT_NE(refused_with(oscillation(damped, 1)), "");
  // A pulse within a fortieth of the duration.
  const auto pulse =
      oscillator([](auto x, auto, auto t) { return x * exp(-4000 * (t - 0.31) * (t - 0.31)); });
  EXPECT_NE(refused_with(oscillation(pulse, 1)), "");
}

/// d/dt f(x, t) moves no extremal, but its momentum ∂f/∂x closes only where it is as at the start.
TEST(Recurrence, TotalDerivatives) {
  const auto with = [](const auto& term) { return refused_with(oscillation(oscillator(term), 1)); };
  EXPECT_EQ(with([](auto x, auto v, auto t) { return v * (t * t - t) + x * (2 * t - 1); }), "");
  EXPECT_EQ(with([](auto x, auto v, auto) { return v * sin(x); }), "");
  EXPECT_EQ(with([](auto, auto, auto t) { return exp(t) + t * t; }), "");
  const std::string jumps = with([](auto x, auto v, auto t) { return t * v + x; });
  EXPECT_NE(jumps.find("the momentum ∂L/∂q' of x changes by 1,"), std::string::npos) << jumps;
}

TEST(Recurrence, UpToAMap) {
  const auto driven = oscillator([](auto x, auto, auto t) { return x * cos(pi * t); });
  EXPECT_EQ(refused_with(oscillation(driven, 1, -1)), "");
  EXPECT_EQ(refused_with(oscillation(driven, 2)), "");
  EXPECT_NE(refused_with(oscillation(driven, 1)).find("L repeats after 2:"), std::string::npos)
      << refused_with(oscillation(driven, 1));
  const std::string mapped = refused_with(oscillation(driven, 2, -1));
  EXPECT_NE(mapped.find("up to the map, after the duration 2"), std::string::npos) << mapped;
  EXPECT_NE(mapped.find("L repeats after 1:"), std::string::npos) << mapped;
  const auto pendulum = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); });
  EXPECT_EQ(refused_with(oscillation(pendulum, 2, 1, 2 * pi)), "");
  const std::string shifted = refused_with(oscillation(pendulum, 2, 1, 2));
  EXPECT_EQ(shifted.rfind("the map changes the Lagrangian: the force on x changes by ", 0), 0u) << shifted;
}

/// A shift along a uniform magnetic field's potential changes L by a total derivative, and momenta with it.
TEST(Recurrence, ShiftsInAMagneticField) {
  Problem problem;
  problem.lagrangian =
      trace(2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 + 3 * q[0] * v[1]; });
  problem.names = {"x", "y"};
  problem.boundary.coordinates = 2;
  problem.periodic = true;
  problem.duration.value = 2;
  const auto shifted = [&](double x, double y) {
    Problem result = problem;
    for (int a = 0; a < 2; ++a) {
      const int row = result.boundary.add_row(a == 0 ? x : y);
      result.boundary.add(row, a, -1);
      result.boundary.add(row, 2 + a, 1);
    }
    result.ends = solve_relation(result.boundary);
    return refused_with(result);
  };
  EXPECT_EQ(shifted(0, 1), "");
  EXPECT_NE(shifted(1, 0).find("the momentum ∂L/∂q' of y changes by 3,"), std::string::npos) << shifted(1, 0);
}

/// Roundoff of t in a fast drive is no change.
TEST(Recurrence, FastDrives) {
  for (const double omega : {1e3, 1e5})
    EXPECT_EQ(refused_with(oscillation(oscillator([=](auto x, auto, auto t) { return x * sin(omega * t); }),
                                       2 * pi / omega * 1000)),
              "")
        << omega;
}

TEST(Recurrence, IsCheckedWhereProblemsAreMade) {
  EXPECT_THROW(make_problem(oscillation(oscillator([](auto x, auto, auto t) { return x * cos(t); }), 6)),
               RecurrenceError);
}

}  // namespace
}  // namespace extremal
