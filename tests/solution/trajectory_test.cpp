#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "action/rule.hpp"
#include "solution/solution.hpp"

namespace extremal {
namespace {

constexpr int coordinates = 2;

/// Elements of uneven length that carry f at their Lobatto nodes, and 3 − 2 f.
template <class Function>
Trajectory sampled(int degree, std::vector<double> times, Function f) {
  Trajectory trajectory{coordinates, degree, std::move(times), {}};
  for (int k = 0; k < trajectory.elements(); ++k) {
    const double start = trajectory.times[k], h = trajectory.times[k + 1] - start;
    for (const double node : lobatto_rule(degree + 1).nodes) {
      trajectory.nodes.push_back(f(start + h * node));
      trajectory.nodes.push_back(3 - 2 * trajectory.nodes.back());
    }
  }
  return trajectory;
}

const std::vector<double> uneven = {0, 0.1, 0.7, 0.75, 2};

TEST(Trajectory, PolynomialsOfItsDegreeAndTheirDerivatives) {
  std::vector<double> q(coordinates), v(coordinates);
  for (int s = 1; s <= max_degree; ++s) {
    // T_s(t − 1), bounded by 1, with |T_s'| <= s².
    const auto f = [s](double t) { return std::cos(s * std::acos(std::clamp(t - 1, -1.0, 1.0))); };
    const auto slope = [s](double t) {
      const double angle = std::acos(t - 1);
      return s * std::sin(s * angle) / std::sin(angle);
    };
    const Trajectory trajectory = sampled(s, uneven, f);
    for (double t = 0.003; t < 2; t += 0.0171) {
      trajectory.at(t, q, v);
      EXPECT_NEAR(q[0], f(t), 1e-14 * s * s) << "degree " << s << ", t = " << t;
      EXPECT_NEAR(q[1], 3 - 2 * f(t), 2e-14 * s * s);
      EXPECT_NEAR(v[0], slope(t), 2e-13 * s * s * s) << "degree " << s << ", t = " << t;
      EXPECT_NEAR(v[1], -2 * slope(t), 4e-13 * s * s * s);
    }
  }
}

TEST(Trajectory, ExactOnEveryNode) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> q(coordinates), v(coordinates);
  for (int s = 1; s <= max_degree; ++s) {
    const Trajectory trajectory =
        sampled(s, {0, 1e-3, 0.7, 100, 101.3}, [&](double) { return normal(random); });
    const std::vector<double> nodes = lobatto_rule(s + 1).nodes;
    for (int k = 0; k < trajectory.elements(); ++k)
      for (int j = 0; j < s; ++j) {
        const double h = trajectory.times[k + 1] - trajectory.times[k];
        trajectory.at(trajectory.times[k] + h * nodes[j], q, v);
        for (int a = 0; a < coordinates; ++a)
          EXPECT_EQ(q[a], trajectory.nodes[(k * (s + 1) + j) * coordinates + a]) << s << " " << k << " " << j;
      }
    trajectory.at(trajectory.duration(), q, v);
    EXPECT_EQ(q[0], trajectory.nodes[trajectory.nodes.size() - 2]);
    EXPECT_EQ(q[1], trajectory.nodes.back());
  }
}

TEST(Trajectory, ConstantsAreConstantToTheLastBit) {
  const Trajectory trajectory = sampled(7, uneven, [](double) { return 1e6 / 3; });
  std::vector<double> q(coordinates), v(coordinates);
  for (double t = 0; t <= 2; t += 1 / 64.) {
    trajectory.at(t, q, v);
    EXPECT_EQ(q[0], 1e6 / 3);
    EXPECT_EQ(v[0], 0);
  }
}

TEST(Trajectory, TimesBeyondTheEndsAreRefused) {
  const Trajectory trajectory = sampled(2, uneven, [](double t) { return t; });
  std::vector<double> q(coordinates), v(coordinates);
  try {
    trajectory.at(2.5, q, v);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "t = 2.5; the trajectory runs from 0 to 2");
  }
  EXPECT_THROW(trajectory.at(-1e-3, q, v), std::invalid_argument);
  EXPECT_THROW(trajectory.at(std::nan(""), q, v), std::invalid_argument);
  trajectory.at(std::nextafter(2.0, 3.0), q, v);
  EXPECT_EQ(q[0], 2);
}

TEST(Status, NamesAreThoseOfAResult) {
  EXPECT_STREQ(name(Status::converged), "converged");
  EXPECT_STREQ(name(Status::not_converged), "not-converged");
  EXPECT_STREQ(name(Status::collision), "collision");
  EXPECT_STREQ(name(Status::lost_convexity), "lost-convexity");
  EXPECT_STREQ(name(Status::no_solution_near), "no-solution-near");
  EXPECT_STREQ(name(Status::conjugate_ends), "conjugate-ends");
  EXPECT_STREQ(name(Status::iteration_limit), "iteration-limit");
}

}  // namespace
}  // namespace extremal
