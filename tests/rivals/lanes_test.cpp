#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "motion/flow.hpp"
#include "rivals/almost_block_diagonal.hpp"
#include "rivals/batch_dop853.hpp"
#include "rivals/lane_flow.hpp"
#include "rivals/problems.hpp"

namespace extremal {
namespace {

/// One system of each kind that the flow treats in its own way.
std::vector<std::shared_ptr<const Lagrangian>> kinds() {
  return {kepler(), henon_heiles(), double_pendulum(),
          // Gyroscopic, with a full constant mass.
          trace(2,
                [](auto q, auto v, auto) {
                  return v[0] * v[0] + v[0] * v[1] / 2.0 + v[1] * v[1] / 2.0 + q[0] * v[1] -
                         2.0 * q[1] * v[0] + cos(q[0]) - q[1] * q[1];
                }),
          // Momentum not linear in velocity, with time.
          trace(2, [](auto q, auto v, auto t) {
            return exp(t / 5.0) * (v[0] * v[0] + v[1] * v[1]) / 2.0 + v[0] * v[0] * v[0] * v[0] / 20.0 +
                   q[0] * q[1] * v[1] / 3.0 - q[0] * q[0] * cos(t) - q[1] * q[1];
          })};
}

TEST(LaneFlow, IsTheFlowInEveryLane) {
  constexpr int n = 2, columns = 3, blocks = 1 + columns;
  const int lanes = simd_lanes();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> some(0.3, 1.2);
  for (const auto& system : kinds()) {
    LaneFlow lane_flow(*system);
    Flow flow(*system);
    AlignedDoubles y(2 * n * blocks * lanes), slope(y.size()), t(lanes);
    std::vector<std::vector<double>> states(lanes, std::vector<double>(2 * n * blocks));
    for (int l = 0; l < lanes; ++l) {
      t[l] = some(random);
      for (double& x : states[l]) x = some(random);
      const std::vector<double> v = {some(random), some(random)};
      ASSERT_TRUE(flow.momentum({states[l].data(), n}, v, t[l], {states[l].data() + n, n}));
      for (std::size_t r = 0; r < states[l].size(); ++r) y[r * lanes + l] = states[l][r];
    }
    lane_flow.slope(t.data(), y.data(), columns, slope.data());
    for (int l = 0; l < lanes; ++l) {
      std::vector<double> expected(2 * n * blocks);
      ASSERT_TRUE(flow.slope_with_variations(t[l], states[l], expected));
      for (std::size_t r = 0; r < expected.size(); ++r)
        EXPECT_NEAR(slope[r * lanes + l], expected[r], 1e-12 * (1 + std::abs(expected[r]))) << l << " " << r;
    }
  }
}

TEST(LaneFlow, ALostLaneLosesNoOther) {
  const auto system = double_pendulum();
  LaneFlow flow(*system);
  const int lanes = simd_lanes(), lost = lanes - 1;
  AlignedDoubles y(4 * lanes, 0.3), slope(y.size()), t(lanes);
  y[0 * lanes + lost] = NAN;
  flow.slope(t.data(), y.data(), 0, slope.data());
  y[0 * lanes + lost] = 0.3;
  AlignedDoubles again(y.size());
  flow.slope(t.data(), y.data(), 0, again.data());
  for (int r = 0; r < 4; ++r)
    for (int l = 0; l < lanes; ++l) {
      EXPECT_EQ(std::isfinite(slope[r * lanes + l]) || r > 0, l != lost || r > 0);
      EXPECT_NEAR(again[r * lanes + l], again[r * lanes], 1e-14);
      if (l != lost) {
        EXPECT_NEAR(slope[r * lanes + l], again[r * lanes + l], 1e-13);
      }
    }
}

TEST(BatchDop853, SpansOfManyLengths) {
  // q = sin t from t = 0: 20 spans on fewer lanes, each with the variation by p, which is sin t too.
  const auto system = oscillator();
  LaneFlow flow(*system);
  BatchDop853 integrator(flow);
  const std::vector<double> initial = {0, 1, 0, 1};
  std::vector<double> final(20 * 4);
  std::vector<MotionSpan> spans(20);
  for (int k = 0; k < 20; ++k)
    spans[k] = {
        .start = 0, .end = 0.1 + k * k * 0.05, .initial = initial.data(), .final = final.data() + 4 * k};
  ASSERT_TRUE(integrator.run(spans, 1, 1e-12, 1000));
  for (int k = 0; k < 20; ++k) {
    EXPECT_TRUE(spans[k].complete);
    EXPECT_NEAR(final[4 * k], std::sin(spans[k].end), 2e-11) << k;
    EXPECT_NEAR(final[4 * k + 3], std::cos(spans[k].end), 2e-11) << k;
    EXPECT_GT(spans[k].first_step, 0);
  }
  // The step found fit is where the next run begins.
  const int before = spans[19].steps;
  ASSERT_TRUE(integrator.run(spans, 1, 1e-12, 1000));
  EXPECT_LT(spans[19].steps, before);
}

TEST(BatchDop853, ErrorFollowsTheTolerance) {
  const auto system = kepler();
  LaneFlow flow(*system);
  BatchDop853 integrator(flow);
  // e = 0.6 from pericentre to apocentre.
  const std::vector<double> initial = {0.4, 0, 0, 2};
  std::vector<double> final(4);
  int steps = 0;
  for (const double tolerance : {1e-4, 1e-7, 1e-10, 1e-13}) {
    MotionSpan span{.start = 0, .end = std::acos(-1.0), .initial = initial.data(), .final = final.data()};
    ASSERT_TRUE(integrator.run({&span, 1}, 0, tolerance, 1000));
    EXPECT_NEAR(final[0], -1.6, 100 * tolerance);
    EXPECT_GT(span.steps, steps);
    steps = span.steps;
  }
}

TEST(BatchDop853, SaysWhatCannotBeIntegrated) {
  const auto central = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 1.0 / abs(q[0]); });
  LaneFlow flow(*central);
  BatchDop853 integrator(flow);
  // Free fall from 1 reaches the centre after π/(2√2) = 1.11.
  const std::vector<double> initial = {1, 0};
  std::vector<double> final(4);
  std::vector<MotionSpan> spans(2);
  for (int k = 0; k < 2; ++k)
    spans[k] = {.start = 0, .end = 1.0 + k, .initial = initial.data(), .final = final.data() + 2 * k};
  EXPECT_FALSE(integrator.run(spans, 0, 1e-10, 100000));
  EXPECT_FALSE(spans[1].complete);
  EXPECT_TRUE(integrator.run({spans.data(), 1}, 0, 1e-10, 100000));
  EXPECT_FALSE(integrator.run({spans.data(), 1}, 0, 1e-10, 3));
}

TEST(AlmostBlockDiagonal, AgainstADenseSystem) {
  std::srand(7);
  for (const int count : {1, 2, 5}) {
    for (const int extra : {0, 1}) {
      constexpr int b = 4, y = 3;
      AlmostBlockDiagonal::Blocks blocks;
      for (int k = 0; k < count; ++k) {
        // Growth along the chain, and decay.
        blocks.transition.push_back(10 * Eigen::MatrixXd::Random(b, k == 0 ? y : b));
        if (extra) blocks.extra.push_back(Eigen::VectorXd::Random(b));
      }
      const int rows = y + extra, unknowns = y + b * count + extra;
      blocks.by_first = Eigen::MatrixXd::Random(rows, y);
      blocks.by_last = Eigen::MatrixXd::Random(rows, b);
      if (extra) blocks.by_extra = Eigen::VectorXd::Random(rows);
      Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(unknowns, unknowns);
      for (int k = 0; k < count; ++k) {
        dense.block(k * b, k == 0 ? 0 : y + (k - 1) * b, b, blocks.transition[k].cols()) =
            blocks.transition[k];
        dense.block(k * b, y + k * b, b, b) = -Eigen::MatrixXd::Identity(b, b);
        if (extra) dense.block(k * b, unknowns - 1, b, 1) = blocks.extra[k];
      }
      dense.block(count * b, 0, rows, y) = blocks.by_first;
      dense.block(count * b, y + (count - 1) * b, rows, b) = blocks.by_last;
      if (extra) dense.block(count * b, unknowns - 1, rows, 1) = blocks.by_extra;
      Eigen::VectorXd right(unknowns);
      std::vector<Eigen::VectorXd> parts;
      for (int k = 0; k < count; ++k) parts.push_back(Eigen::VectorXd::Random(b));
      parts.push_back(Eigen::VectorXd::Random(rows));
      for (int k = 0, at = 0; k <= count; at += static_cast<int>(parts[k].size()), ++k)
        right.segment(at, parts[k].size()) = parts[k];
      const Eigen::VectorXd expected = dense.fullPivLu().solve(right);
      for (const bool singular : {false, true}) {
        blocks.may_be_singular = singular;
        AlmostBlockDiagonal system;
        system.factor(blocks);
        const AlmostBlockDiagonal::Solution found = system.solve(parts);
        EXPECT_TRUE(found.finite());
        EXPECT_LT((found.first - expected.head(y)).norm(), 1e-10 * expected.norm());
        for (int k = 0; k < count; ++k)
          EXPECT_LT((found.rest[k] - expected.segment(y + k * b, b)).norm(), 1e-10 * expected.norm());
        if (extra) {
          EXPECT_NEAR(found.extra, expected[unknowns - 1], 1e-10 * expected.norm());
        }
      }
    }
  }
}

}  // namespace
}  // namespace extremal
