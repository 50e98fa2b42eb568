#include "solution/columns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "action/rule.hpp"
#include "system/tape.hpp"

/// \file Columns of samples against single points.

namespace extremal::columns {
namespace {

constexpr std::size_t coordinates = 2;

/// Nodes and slopes at random: what is interpolated need not be smooth.
Trajectory random_trajectory(int degree, std::vector<double> times) {
  Trajectory trajectory{coordinates, degree, std::move(times), {}};
  std::mt19937 random(degree);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < trajectory.elements() * (degree + 1) * coordinates; ++k) {
    trajectory.nodes.push_back(normal(random));
    trajectory.slopes.push_back(normal(random));
  }
  return trajectory;
}

struct Columns {
  std::vector<std::vector<double>> values;
  explicit Columns(std::size_t count) : values(coordinates, std::vector<double>(count)) {}
  std::vector<double*> places() { return {values[0].data(), values[1].data()}; }
};

const std::vector<double> uneven = {0, 1e-3, 0.7, 0.75, 2};

std::vector<double> times_of(const Trajectory& trajectory) {
  std::vector<double> times;
  for (int k = 0; k <= 3000; ++k) times.push_back(trajectory.duration() * k / 3000);
  for (int k = 0; k < trajectory.elements(); ++k)
    for (const double x : lobatto_rule(trajectory.degree + 1).nodes)
      times.push_back(trajectory.times[k] + (trajectory.times[k + 1] - trajectory.times[k]) * x);
  times.push_back(trajectory.duration());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, trajectory.duration());
  for (int k = 0; k < 500; ++k) times.push_back(uniform(random));
  return times;
}

TEST(Columns, AreTheValuesOfSinglePoints) {
  for (int s = 1; s <= max_degree; ++s) {
    const Trajectory trajectory = random_trajectory(s, uneven);
    const std::vector<double> times = times_of(trajectory);
    Columns q(times.size()), v(times.size());
    evaluate_columns(trajectory, times, q.places(), v.places());
    std::vector<double> point(coordinates), rate(coordinates);
    for (std::size_t i = 0; i < times.size(); ++i) {
      trajectory.at(times[i], point, rate);
      for (std::size_t a = 0; a < coordinates; ++a) {
        EXPECT_NEAR(q.values[a][i], point[a], 3e-14) << s << ", t = " << times[i];
        EXPECT_NEAR(v.values[a][i], rate[a], 3e-14) << s << ", t = " << times[i];
      }
    }
  }
}

TEST(Columns, HaveTheValueOfANodeThere) {
  for (int s = 1; s <= max_degree; ++s) {
    const Trajectory trajectory = random_trajectory(s, uneven);
    std::vector<double> times;
    for (int k = 0; k < trajectory.elements(); ++k)
      for (int j = 0; j < s; ++j)
        times.push_back(trajectory.times[k] +
                        (trajectory.times[k + 1] - trajectory.times[k]) * lobatto_rule(s + 1).nodes[j]);
    Columns q(times.size()), v(times.size());
    evaluate_columns(trajectory, times, q.places(), v.places());
    for (std::size_t i = 0; i < times.size(); ++i)
      for (std::size_t a = 0; a < coordinates; ++a) {
        const std::size_t node = i / s * (s + 1) + i % s;
        EXPECT_EQ(q.values[a][i], trajectory.nodes[node * coordinates + a]) << s << ", " << i;
        EXPECT_EQ(v.values[a][i], trajectory.slopes[node * coordinates + a]) << s << ", " << i;
      }
  }
}

TEST(Columns, WithoutSlopesTakeDerivatives) {
  Trajectory trajectory = random_trajectory(5, uneven);
  trajectory.slopes.clear();
  const std::vector<double> times = times_of(trajectory);
  Columns q(times.size()), v(times.size());
  evaluate_columns(trajectory, times, q.places(), v.places());
  std::vector<double> point(coordinates), rate(coordinates);
  for (std::size_t i = 0; i < times.size(); ++i) {
    trajectory.at(times[i], point, rate);
    EXPECT_EQ(q.values[1][i], point[1]);
    EXPECT_EQ(v.values[1][i], rate[1]);
  }
}

TEST(Columns, RefuseTimesOutside) {
  const Trajectory trajectory = random_trajectory(4, uneven);
  Columns q(2), v(2);
  for (const double t : {-0.1, 2.1, std::nan("")})
    EXPECT_THROW(evaluate_columns(trajectory, std::vector<double>{1, t}, q.places(), v.places()),
                 std::invalid_argument);
}

TEST(Columns, MomentaAreThoseOfSinglePoints) {
  const auto lagrangian = trace(coordinates, [](auto q, auto v, auto t) {
    return (2 * v[0] * v[0] + v[1] * v[1]) / 2 + v[0] * v[1] / 3 + q[1] * v[0] + v[1] + cos(q[0] * t) * v[0] +
           sqrt(1 + v[1] * v[1]);
  });
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  constexpr std::size_t count = 150;  // no multiple of a batch
  std::vector<double> times(count);
  Columns q(count), v(count), p(count);
  for (std::size_t i = 0; i < count; ++i) {
    times[i] = normal(random);
    for (std::size_t a = 0; a < coordinates; ++a) {
      q.values[a][i] = normal(random);
      v.values[a][i] = normal(random);
    }
  }
  const std::vector<const double*> from_q{q.values[0].data(), q.values[1].data()},
      from_v{v.values[0].data(), v.values[1].data()};
  momentum_columns(*lagrangian, times, from_q, from_v, p.places());
  Scratch scratch;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> point{q.values[0][i], q.values[1][i]}, rate{v.values[0][i], v.values[1][i]};
    const PointValues at = evaluate_at(*lagrangian, point, rate, times[i], Order::gradient, scratch);
    for (std::size_t a = 0; a < coordinates; ++a) EXPECT_NEAR(p.values[a][i], at.dv[a], 1e-14);
  }
}

}  // namespace
}  // namespace extremal::columns
