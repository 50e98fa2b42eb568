#include "problem/symmetry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "action/systems.hpp"
#include "problem/problem.hpp"
#include "system/formula.hpp"

/// \file Generators against the groups that are known.

namespace extremal {
namespace {

using Values = std::vector<double>;
using std::numbers::pi;

/// q_a(T) = Σ_b map(a, b) q_b(0) + shift_a, guessed by a loop.
Problem closed(std::shared_ptr<const Lagrangian> lagrangian, const Values& map = {},
               const Values& shift = {}) {
  const int n = lagrangian->structure().coordinates;
  Problem problem;
  problem.lagrangian = std::move(lagrangian);
  problem.boundary.coordinates = n;
  for (int a = 0; a < n; ++a) {
    const int row = problem.boundary.add_row(shift.empty() ? 0 : shift[a]);
    problem.boundary.add(row, n + a, 1);
    for (int b = 0; b < n; ++b)
      if (const double entry = map.empty() ? a == b : map[a * n + b]; entry != 0)
        problem.boundary.add(row, b, -entry);
  }
  problem.periodic = true;
  problem.duration.value = 2;
  for (int k = 0; k <= 20; ++k) {
    problem.guess.tau.push_back(k / 20.0);
    for (int a = 0; a < n; ++a) problem.guess.q.push_back((1 + 0.3 * a) * std::cos(pi * k / 10 + a));
  }
  return make_problem(std::move(problem));
}

std::size_t count(const Problem& problem) { return problem.symmetries.size(); }

auto three_bodies() {
  return trace(6, [](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (int i = 0; i < 6; ++i) l = l + (1 + i / 2) * v[i] * v[i] / 2;
    for (int i = 0; i < 3; ++i)
      for (int j = i + 1; j < 3; ++j) {
        const auto x = q[2 * i] - q[2 * j], y = q[2 * i + 1] - q[2 * j + 1];
        l = l + (1 + i) * (1 + j) / sqrt(x * x + y * y);
      }
    return l;
  });
}

/// Two translations, a rotation about the centre of mass and one of it, whatever the masses; none for a
/// pendulum.
TEST(Symmetry, CountsTheGroup) {
  EXPECT_EQ(count(closed(three_bodies())), 4u);
  EXPECT_EQ(count(closed(systems::pendulum())), 0u);
  EXPECT_EQ(count(closed(systems::kepler())), 1u);
  const auto free = trace(2, [](auto, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2; });
  EXPECT_EQ(count(closed(free)), 3u);
}

/// v·A with A = B (−y, x)/2 changes by a total derivative when it is moved.
TEST(Symmetry, TranslationsInAMagneticField) {
  const auto field = trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 0.7 * (q[0] * v[1] - q[1] * v[0]);
  });
  EXPECT_EQ(count(closed(field)), 3u);
}

/// About the guess they are zero to roundoff, or exactly, but not everywhere.
TEST(Symmetry, OfPotentialsThatAreFlatInOnePlace) {
  const auto count = [](const Problem& problem) {
    EXPECT_GT(continuous_symmetries(problem).size(), 0u);
    return continuous_symmetries(problem, everywhere()).size();
  };
  const auto bottom = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2 - pow(q[0] / 30.0, 16); });
  EXPECT_EQ(count(closed(bottom)), 0u);
  const auto written = [](std::vector<std::string> coordinates, std::string lagrangian) {
    return compile({.coordinates = std::move(coordinates), .lagrangian = std::move(lagrangian)}).lagrangian;
  };
  EXPECT_EQ(count(closed(written({"x"}, "x'^2/2 - max(0, abs(x) - 9000)^2"))), 0u);
  EXPECT_EQ(count(closed(written({"x", "y"}, "(x'^2 + y'^2)/2 - max(0, abs(x - y) - 9000)^2"))), 1u);
  EXPECT_EQ(count(closed(written({"x", "y"}, "(x'^2 + y'^2)/2 - max(0, x^2 + y^2 - 9000)^2"))), 1u);
}

/// L depends on time, the rotation is there.
TEST(Symmetry, DrivenSystem) {
  const auto driven = trace(2, [](auto q, auto v, auto t) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 - (1 + cos(pi * t)) * (q[0] * q[0] + q[1] * q[1]);
  });
  EXPECT_EQ(count(closed(driven)), 1u);
}

/// After a reflection in the y axis only translations along it close; after a rotation about the origin only
/// rotations do; a shift by 2π does not hinder translations.
TEST(Symmetry, OfThePathsThatClose) {
  const auto free = trace(2, [](auto, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2; });
  const Problem mirrored = closed(free, {-1, 0, 0, 1});
  ASSERT_EQ(count(mirrored), 1u);
  const Generator& along = mirrored.symmetries[0];
  EXPECT_NEAR(std::abs(along.shift[1]), std::hypot(along.shift[0], along.shift[1]), 1e-12);
  for (double entry : along.matrix) EXPECT_NEAR(entry, 0, 1e-12);
  EXPECT_EQ(count(closed(free, {0, -1, 1, 0})), 1u);
  EXPECT_EQ(count(closed(free, {}, {2 * pi, 0})), 2u);
}

/// Momenta of 1e12 beside coordinates of 1.
TEST(Symmetry, InUnitsFarApart) {
  const auto heavy = trace(
      2, [](auto q, auto v, auto) { return 1e12 * (v[0] * v[0] + cos(q[0]) * cos(q[0]) * v[1] * v[1]) / 2; });
  EXPECT_EQ(count(closed(heavy, {}, {0, 2 * pi})), 1u);
  EXPECT_EQ(count(closed(heavy)), 1u);
}

/// A ball in a plane pulled along x: where y is free at both ends, it may be moved along y; where they are
/// tied to x as well, not. About the centre of Kepler's problem a line through it may be turned, a point may
/// not.
TEST(Symmetry, OfTheEnds) {
  const auto with = [](std::shared_ptr<const Lagrangian> lagrangian, auto&& set) {
    Problem problem;
    problem.boundary.coordinates = lagrangian->structure().coordinates;
    problem.lagrangian = std::move(lagrangian);
    set(problem.boundary);
    problem.duration.value = 1;
    return continuous_symmetries(make_problem(std::move(problem))).size();
  };
  const auto ball =
      trace(2, [](auto q, auto v, auto) { return (v[0] * v[0] + v[1] * v[1]) / 2 - q[0] * q[0]; });
  const auto fix_x = [](BoundaryRelation& b) {
    b.fix(0, false, 1);
    b.fix(0, true, 2);
  };
  EXPECT_EQ(with(ball, fix_x), 1u);
  EXPECT_EQ(with(ball,
                 [](BoundaryRelation& b) {
                   const int row = b.add_row(1);
                   b.add(row, 0, 1);
                   b.add(row, 3, 0.5);
                 }),
            0u);
  EXPECT_EQ(with(systems::kepler(), [](BoundaryRelation&) {}), 1u);
  EXPECT_EQ(with(systems::kepler(), fix_x), 0u);
}

/// ∂L/∂q·δq + ∂L/∂q'·δq' = 0 at points that were not drawn.
TEST(Symmetry, LeavesTheLagrangianAlone) {
  const Problem problem = closed(three_bodies());
  const Values q{0.3, -1.1, 2.0, 0.4, -0.7, 1.9}, v{0.2, 0.5, -1, 0.1, 0.9, -0.3};
  Scratch scratch;
  const PointValues at = evaluate_at(*problem.lagrangian, q, v, 0, Order::gradient, scratch);
  for (const Generator& generator : problem.symmetries) {
    double change = 0, size = 0;
    for (int a = 0; a < 6; ++a) {
      double dq = generator.shift[a], dv = 0;
      for (int b = 0; b < 6; ++b) {
        dq += generator.matrix[a * 6 + b] * q[b];
        dv += generator.matrix[a * 6 + b] * v[b];
      }
      change += at.dq[a] * dq + at.dv[a] * dv;
      size = std::max({size, std::abs(dq), std::abs(dv)});
    }
    EXPECT_NEAR(change, 0, 1e-12 * size);
    EXPECT_GT(size, 0.01);
  }
}

/// Many coordinates: the translations alone are looked for.
TEST(Symmetry, OfLongChains) {
  const int n = 40;
  const auto chain = trace(n, [=](auto q, auto v, auto) {
    auto l = 0 * v[0];
    for (int a = 0; a < n; ++a) {
      const auto d = q[(a + 1) % n] - q[a];
      l = l + v[a] * v[a] / 2 - d * d / 2 - d * d * d * d / 4;
    }
    return l;
  });
  const Problem problem = closed(chain);
  ASSERT_EQ(count(problem), 1u);
  const Generator& all = problem.symmetries[0];
  for (int a = 1; a < n; ++a) EXPECT_NEAR(all.shift[a] / all.shift[0], 1, 1e-10);
}

}  // namespace
}  // namespace extremal
