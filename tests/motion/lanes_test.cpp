#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "motion/batch_dop853.hpp"
#include "motion/flow.hpp"
#include "motion/lane_flow.hpp"
#include "system/tape.hpp"

namespace extremal {
namespace {

std::shared_ptr<const Lagrangian> oscillator() {
  return trace(1, [](auto q, auto v, auto) { return (v[0] * v[0] - q[0] * q[0]) / 2.0; });
}

std::shared_ptr<const Lagrangian> kepler() {
  return trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2.0 + 1.0 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
}

std::shared_ptr<const Lagrangian> double_pendulum() {
  return trace(2, [](auto q, auto v, auto) {
    return v[0] * v[0] + v[1] * v[1] / 2.0 + v[0] * v[1] * cos(q[0] - q[1]) + 2 * 9.81 * cos(q[0]) +
           9.81 * cos(q[1]);
  });
}

/// One system of each kind that the flow treats in its own way.
std::vector<std::shared_ptr<const Lagrangian>> kinds() {
  return {kepler(), double_pendulum(),
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

TEST(BatchDop853, OthersGoOnWhereOneFails) {
  const auto central = trace(1, [](auto q, auto v, auto) { return v[0] * v[0] / 2.0 + 1.0 / abs(q[0]); });
  LaneFlow flow(*central);
  BatchDop853 integrator(flow);
  // Thrown upwards from 1 at the speed of escape, r^(3/2) = 1 + 3 t/√2; every third falls into the centre.
  const double up[] = {1, std::sqrt(2.0)}, falling[] = {1, 0};
  std::vector<double> final(2 * 30);
  std::vector<MotionSpan> spans(30);
  for (int k = 0; k < 30; ++k)
    spans[k] = {.end = 2 + 0.1 * k, .initial = k % 3 == 0 ? falling : up, .final = final.data() + 2 * k};
  int told = 0;
  EXPECT_TRUE(integrator.run_each(spans, 0, 1e-10, 200, [&](int steps) { return (told += steps) > 0; }));
  int taken = 0;
  for (int k = 0; k < 30; ++k) {
    taken += spans[k].steps;
    EXPECT_EQ(spans[k].complete, k % 3 != 0) << k;
    if (k % 3 == 0) continue;
    EXPECT_NEAR(final[2 * k], std::pow(1 + 3 * spans[k].end / std::sqrt(2.0), 2.0 / 3), 1e-8) << k;
  }
  EXPECT_EQ(told, taken);
  // Where there are not enough steps, those that are done stay so.
  int left = told / 4;
  EXPECT_FALSE(integrator.run_each(spans, 0, 1e-10, 200, [&](int steps) { return (left -= steps) > 0; }));
  EXPECT_TRUE(spans[1].complete);
  EXPECT_FALSE(spans.back().complete);
}

}  // namespace
}  // namespace extremal
