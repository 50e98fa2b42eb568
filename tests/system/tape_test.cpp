#include "system/tape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "system/allocations.hpp"
#include "system/oracle.hpp"
#include "system/systems.hpp"
#include "system/tape_lagrangian.hpp"

namespace extremal {
namespace {

using oracle::Long;

/// Rows of random points between 0.3 and 1.3, padding included.
struct Batch {
  int n, count;
  AlignedDoubles rows;
  Batch(int n, int count) : n(n), count(count), rows(static_cast<std::size_t>(2 * n + 1) * count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.3, 1.3);
    for (double& x : rows) x = uniform(random);
  }
  Points points() const {
    return {count, count, rows.data(), rows.data() + n * count, rows.data() + 2 * n * count};
  }
  std::vector<double> state(int i) const {
    std::vector<double> z;
    for (int a = 0; a < 2 * n; ++a) z.push_back(rows[a * count + i]);
    return z;
  }
  double time(int i) const { return rows[2 * n * count + i]; }
};

double relative(double value, const Long& exact) {
  return std::abs(double(value - exact)) / (1 + std::abs(double(exact)));
}

class EverySystem : public testing::TestWithParam<systems::Named> {
 protected:
  const LagrangianGraph& graph() const { return GetParam().lagrangian; }
};

TEST_P(EverySystem, IsWhatTheDifferencesSay) {
  const auto l = make_lagrangian(graph());
  const int n = graph().coordinates;
  const Batch batch(n, simd_lanes());
  const std::vector<double> z = batch.state(0);
  Scratch scratch;
  const PointValues values =
      evaluate_at(*l, std::span(z).first(n), std::span(z).last(n), batch.time(0), Order::hessian, scratch);
  auto exact = oracle::differences(graph(), z, batch.time(0));
  EXPECT_LT(relative(values.value, exact.value()), 1e-14);
  const int some = std::min(n, 4);  // enough of the long ones
  for (int a = 0; a < some; ++a) {
    EXPECT_LT(relative(values.dq[a], exact.first(a)), 1e-14) << a;
    EXPECT_LT(relative(values.dv[a], exact.first(n + a)), 1e-14) << a;
    for (int b = 0; b < some; ++b) {
      EXPECT_LT(relative(values.qq[a * n + b], exact.second(a, b)), 3e-14) << a << " " << b;
      EXPECT_LT(relative(values.vq[a * n + b], exact.second(n + a, b)), 3e-14) << a << " " << b;
      EXPECT_LT(relative(values.vv[a * n + b], exact.second(n + a, n + b)), 3e-14) << a << " " << b;
    }
  }
}

TEST_P(EverySystem, HasTheSameRowsInEveryOrderAndPlace) {
  const auto l = make_lagrangian(graph());
  const int n = graph().coordinates;
  Scratch scratch;
  const Batch one(n, simd_lanes());
  for (const int count : {8, 64, 72, 136, 328}) {
    Batch batch(n, count);
    for (int row = 0; row <= 2 * n; ++row)
      for (int i = 0; i < count; ++i)
        batch.rows[row * count + i] = one.rows[row * simd_lanes() + i % simd_lanes()];
    AlignedDoubles full(static_cast<std::size_t>(l->rows(Order::hessian)) * count, NAN), part = full;
    l->evaluate(batch.points(), Order::hessian, full.data(), scratch);
    for (std::size_t k = 0; k < full.size(); ++k)
      ASSERT_EQ(full[k], full[k - k % count + k % simd_lanes()]) << count;
    for (const Order order : {Order::value, Order::gradient}) {
      l->evaluate(batch.points(), order, part.data(), scratch);
      for (int k = 0; k < l->rows(order) * count; ++k)
        ASSERT_NEAR(part[k], full[k], 1e-14 * (1 + std::abs(full[k])));
    }
  }
}

TEST_P(EverySystem, EvaluatesWithoutAllocation) {
  const auto l = make_lagrangian(graph());
  const Batch batch(graph().coordinates, 72);
  AlignedDoubles out(static_cast<std::size_t>(l->rows(Order::hessian)) * 72);
  Scratch scratch;
  l->evaluate(batch.points(), Order::value, out.data(), scratch);
  const long before = allocations();
  for (const Order order : {Order::hessian, Order::gradient, Order::value})
    l->evaluate(batch.points(), order, out.data(), scratch);
  EXPECT_EQ(allocations(), before);
}

INSTANTIATE_TEST_SUITE_P(Systems, EverySystem, testing::ValuesIn(systems::all()),
                         [](const auto& info) { return info.param.name; });

TEST(Tape, SensitivitiesAreDifferencesByTheParameters) {
  LagrangianGraph graph = systems::bodies(3);
  graph.parameters = 2;  // the constant of gravity and the first mass, on which the kinetic energy depends
  const auto l = make_lagrangian(graph);
  const int n = graph.coordinates;
  const Batch batch(n, simd_lanes());
  AlignedDoubles out(static_cast<std::size_t>(l->rows(Order::gradient)) * simd_lanes(), NAN);
  Scratch scratch;
  const int lane = simd_lanes() - 1;
  auto exact = oracle::differences(graph, batch.state(lane), batch.time(lane));
  for (int p = 0; p < 2; ++p) {
    l->sensitivity(batch.points(), p, out.data(), scratch);
    const std::size_t input = 2 * n + 1 + p;
    EXPECT_LT(relative(out[lane], exact.first(input)), 1e-14);
    for (std::size_t k = 0; k < l->structure().gradient.size(); ++k)
      EXPECT_LT(relative(out[(1 + k) * simd_lanes() + lane], exact.second(l->structure().gradient[k], input)),
                1e-14)
          << k;
  }
  EXPECT_THROW(l->sensitivity(batch.points(), 2, out.data(), scratch), std::out_of_range);
}

TEST(Tape, TheRemainderOfKeplerIsShort) {
  const TapeLagrangian kepler(systems::kepler());
  EXPECT_LE(kepler.summary(Order::value).instructions, 3);
  EXPECT_LE(kepler.summary(Order::gradient).instructions, 7);
  EXPECT_LE(kepler.summary(Order::hessian).instructions, 14);
  EXPECT_LE(kepler.summary(Order::hessian).slots, 4);
}

TEST(Tape, PairsAndBondsAreOneKernel) {
  const TapeSummary pairs = TapeLagrangian(systems::bodies(6)).summary(Order::hessian);
  EXPECT_EQ(pairs.kernels, 1);
  EXPECT_EQ(pairs.rows, 15);
  EXPECT_LE(pairs.instructions, 53);
  const TapeSummary bonds = TapeLagrangian(systems::chain(10000, false)).summary(Order::hessian);
  EXPECT_EQ(bonds.kernels, 1);
  EXPECT_EQ(bonds.rows, 9999);
  EXPECT_LE(bonds.instructions, 25);
}

TEST(Tape, RowsWhereInputsCoincideAreRight) {
  // Σ_ij sin(x_i x_j) over all i, j: the diagonal terms are sin(x²).
  LagrangianGraph l;
  l.coordinates = 12;
  const Symbol a(&l.graph, l.graph.input(0)), b(&l.graph, l.graph.input(1));
  Term term{sin(a * b).node(l.graph), 2, {}};
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = 0; j < 12; ++j) term.table.insert(term.table.end(), {i, j});
  l.terms = {term};
  const auto lagrangian = make_lagrangian(l);
  const Batch batch(12, simd_lanes());
  const std::vector<double> z = batch.state(0);
  Scratch scratch;
  const PointValues values =
      evaluate_at(*lagrangian, std::span(z).first(12), std::span(z).last(12), 0, Order::hessian, scratch);
  auto exact = oracle::differences(l, z, 0);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(relative(values.dq[k], exact.first(k)), 1e-14);
    EXPECT_LT(relative(values.qq[k * 12 + k], exact.second(k, k)), 1e-14);
    EXPECT_LT(relative(values.qq[k * 12 + k + 1], exact.second(k, k + 1)), 1e-14);
  }
}

TEST(Tape, RowsThatNothingReachesAreZero) {
  const auto free = trace(1, [](auto, auto v, auto) { return v[0] * v[0] / 2; });
  const Batch batch(1, 16);
  AlignedDoubles out(16, NAN);
  Scratch scratch;
  free->evaluate(batch.points(), Order::value, out.data(), scratch);
  for (const double value : out) EXPECT_EQ(value, 0);
  const auto constant = trace(1, [](auto, auto, auto) { return Symbol(4.5); });
  constant->evaluate(batch.points(), Order::value, out.data(), scratch);
  for (const double value : out) EXPECT_EQ(value, 4.5);
}

TEST(Tape, WhatIsNotReadMayBeNull) {
  const auto kepler = make_lagrangian(systems::kepler());
  const Batch batch(2, 24);
  AlignedDoubles with(6 * 24), without(6 * 24);
  Scratch scratch;
  kepler->evaluate(batch.points(), Order::hessian, with.data(), scratch);
  kepler->evaluate({24, 24, batch.points().q, nullptr, nullptr}, Order::hessian, without.data(), scratch);
  EXPECT_EQ(with, without);
}

TEST(Tape, PartsOfABatchAreRefused) {
  const auto kepler = make_lagrangian(systems::kepler());
  const Batch batch(2, 16);
  Points points = batch.points();
  points.count = simd_lanes() + 1;
  AlignedDoubles out(6 * 16);
  Scratch scratch;
  EXPECT_THROW(kepler->evaluate(points, Order::hessian, out.data(), scratch), std::invalid_argument);
}

TEST(Tape, SymbolsOfTwoGraphsDoNotMix) {
  Graph g, h;
  const Symbol x(&g, g.input(0)), y(&h, h.input(0));
  EXPECT_THROW(x + y, std::invalid_argument);
  EXPECT_EQ((Symbol(3) * Symbol(4)).value(), 12);
  EXPECT_EQ(sqrt(Symbol(16)).value(), 4);
}

}  // namespace
}  // namespace extremal
