#include "problem/reduction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "action/systems.hpp"

/// \file The part of an orbit that its symmetries leave to be found.

namespace extremal {
namespace {

using Values = std::vector<double>;
using std::numbers::pi;

/// A closed path q(t/T) as guess.
Problem guessed(std::shared_ptr<const Lagrangian> lagrangian, const std::function<Values(double)>& path,
                int samples = 400) {
  const int n = lagrangian->structure().coordinates;
  Problem problem;
  problem.lagrangian = std::move(lagrangian);
  problem.boundary.coordinates = n;
  for (int a = 0; a < n; ++a) {
    const int row = problem.boundary.add_row(0);
    problem.boundary.add(row, n + a, 1);
    problem.boundary.add(row, a, -1);
  }
  problem.periodic = true;
  problem.duration.value = 6;
  for (int k = 0; k <= samples; ++k) {
    problem.guess.tau.push_back(static_cast<double>(k) / samples);
    const Values q = path(static_cast<double>(k) / samples);
    problem.guess.q.insert(problem.guess.q.end(), q.begin(), q.end());
  }
  return make_problem(std::move(problem));
}

/// Three masses in the plane, x and y of one after the other.
auto bodies(double first = 1) {
  return trace(6, [first](auto q, auto v, auto) {
    const double m[] = {first, 1, 1};
    auto l = 0 * v[0];
    for (int i = 0; i < 6; ++i) l = l + m[i / 2] * v[i] * v[i] / 2;
    for (int i = 0; i < 3; ++i)
      for (int j = i + 1; j < 3; ++j) {
        const auto x = q[2 * i] - q[2 * j], y = q[2 * i + 1] - q[2 * j + 1];
        l = l + m[i] * m[j] / sqrt(x * x + y * y);
      }
    return l;
  });
}

/// Bodies a third of a period apart on a Lissajous curve, disturbed.
Values eight(double tau, double disturbed) {
  Values q;
  for (int i = 0; i < 3; ++i) {
    const double t = 2 * pi * (tau + i / 3.0);
    q.push_back(std::sin(t) + disturbed * std::cos(5 * t + i));
    q.push_back(0.4 * std::sin(2 * t) + 0.4 * disturbed * std::cos(7 * t + 2 * i));
  }
  return q;
}

int parts(const Problem& problem) { return problem.reduction ? problem.reduction->parts() : 1; }

/// The group of the figure-eight is that of the hexagon. Where one mass is another, two may still be
/// exchanged.
TEST(Reduction, FindsTheGroup) {
  EXPECT_EQ(parts(guessed(bodies(), [](double tau) { return eight(tau, 0); })), 12);
  EXPECT_EQ(parts(guessed(bodies(), [](double tau) { return eight(tau, 0.01); })), 12);
  EXPECT_EQ(parts(guessed(bodies(1.1), [](double tau) { return eight(tau, 0); })), 4);
}

TEST(Reduction, IsOnlyOfWhatIsSymmetric) {
  EXPECT_EQ(parts(guessed(bodies(), [](double tau) { return eight(tau, 0.2); })), 1);
  const auto tilted = [](double slope) {
    return trace(2, [slope](auto q, auto v, auto) {
      return (v[0] * v[0] + v[1] * v[1]) / 2 - q[0] * q[0] - q[1] * q[1] * q[1] * q[1] + slope * q[1];
    });
  };
  const auto ellipse = [](double tau) {
    return Values{std::cos(2 * pi * tau), 0.5 * std::sin(2 * pi * tau)};
  };
  EXPECT_EQ(parts(guessed(tilted(0), ellipse)), 4);
  EXPECT_EQ(parts(guessed(tilted(1e-9), ellipse)), 1);
  const auto forced = trace(1, [](auto q, auto v, auto t) {
    return v[0] * v[0] / 2 - q[0] * q[0] * q[0] * q[0] + q[0] * cos(pi / 3 * t);
  });
  EXPECT_EQ(parts(guessed(forced, [](double tau) { return Values{std::cos(2 * pi * tau)}; })), 1);
}

/// A quarter of a libration: from rest to where the pendulum hangs.
TEST(Reduction, HoldsEndsWhereSymmetriesDo) {
  const auto pendulum = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 + cos(q[0]); });
  const Problem problem = guessed(pendulum, [](double tau) { return Values{std::cos(2 * pi * tau)}; });
  ASSERT_EQ(parts(problem), 4);
  const Problem& part = problem.reduction->part;
  EXPECT_FALSE(part.periodic);
  EXPECT_DOUBLE_EQ(part.duration.value, problem.duration.value / 4);
  ASSERT_EQ(part.boundary.rows, 1);
  EXPECT_EQ(part.boundary.matrix[0].column, 1);
  EXPECT_NEAR(part.guess.q.front(), 1, 1e-12);
  EXPECT_NEAR(part.guess.q.back(), 0, 1e-12);
}

/// Noise of the guess is averaged over its images.
TEST(Reduction, GuessesTheMeanOfImages) {
  const Problem problem = guessed(bodies(), [](double tau) { return eight(tau, 0.01); });
  const Guess& guess = problem.reduction->part.guess;
  double largest = 0;
  for (std::size_t k = 0; k < guess.tau.size(); ++k) {
    const Values exact = eight(guess.tau[k] / 12, 0);
    for (int a = 0; a < 6; ++a) largest = std::max(largest, std::abs(guess.q[6 * k + a] - exact[a]));
  }
  EXPECT_LT(largest, 0.007);
}

TEST(Reduction, PermutationsAreAGroup) {
  const SignedPermutation a{{1, 2, 0}, {1, -1, 1}}, b{{0, 2, 1}, {-1, 1, 1}};
  EXPECT_EQ(a * a.inverse(), SignedPermutation::identity(3));
  EXPECT_EQ((a * b).inverse(), b.inverse() * a.inverse());
  const Values q{1, 2, 3};
  Values once(3), twice(3), product(3);
  b.apply(q.data(), once.data());
  a.apply(once.data(), twice.data());
  (a * b).apply(q.data(), product.data());
  EXPECT_EQ(twice, product);
}

}  // namespace
}  // namespace extremal
