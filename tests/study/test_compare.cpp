#include "study/compare.hpp"

#include <cmath>

#include "study/deviation.hpp"
#include "study/scenes.hpp"

using namespace extremal;
using namespace extremal::test;

namespace {

/// size · sin(t + phase) for `duration`.
Motion wave(double duration, double phase, double size = 1) {
  return {duration, [=](const std::vector<double>& times) {
            MotionSamples samples;
            for (const double t : times) {
              samples.q.push_back(size * std::sin(t + phase));
              samples.v.push_back(size * std::cos(t + phase));
            }
            return samples;
          }};
}

const std::string oscillator =
    "[system]\ncoordinates = [\"q\"]\nlagrangian = \"(q'^2 - q^2)/2\"\n"
    "[boundary]\nstart = { q = 0.0 }\nend = { q = 1.0 }\nduration = \"pi/2\"\n";

}  // namespace

TEST(Deviation, IsTheLargestDifference) {
  EXPECT_NEAR(deviation(wave(4, 0, 1.25), wave(4, 0), 1), 0.25, 1e-5);
  // A motion that ends earlier goes on uniformly: by δ²/2 at most off.
  EXPECT_NEAR(deviation(wave(1.5, 0), wave(1.51, 0), 1), 1e-4 / 2, 1e-6);
}

TEST(Deviation, OfPhases) {
  EXPECT_NEAR(deviation(wave(6, 0.3), wave(6, 0), 1), 2 * std::sin(0.15), 1e-4);
  EXPECT_LT(deviation(wave(6, 0.3), wave(6, 0), 1, {.in_time = true}), 1e-8);
  EXPECT_NEAR(deviation(wave(6, 0.3, 1.001), wave(6, 0), 1, {.in_time = true}), 0.001, 1e-5);
}

/// Of an ellipse that is turned by 0.4 and 0.3 later on its way: with the rotation of the plane nothing is
/// left.
TEST(Deviation, OfTurnedOrbits) {
  const auto ellipse = [](double phase, double angle) {
    return Motion{6, [=](const std::vector<double>& times) {
                    MotionSamples samples;
                    const auto add = [&](std::vector<double>& to, double x, double y) {
                      to.push_back(std::cos(angle) * x - std::sin(angle) * y);
                      to.push_back(std::sin(angle) * x + std::cos(angle) * y);
                    };
                    for (const double t : times) {
                      add(samples.q, 2 * std::cos(t + phase), std::sin(t + phase));
                      add(samples.v, -2 * std::sin(t + phase), std::cos(t + phase));
                    }
                    return samples;
                  }};
  };
  const Generator turn{{0, -1, 1, 0}, {0, 0}};
  EXPECT_GT(deviation(ellipse(0.3, 0.4), ellipse(0, 0), 2, {.in_time = true}), 0.1);
  EXPECT_LT(deviation(ellipse(0.3, 0.4), ellipse(0, 0), 2, {.in_time = true, .symmetries = {turn}}), 1e-8);
}

TEST(Deviation, OfWhatBreaksOff) {
  const Motion broken{4, [](const std::vector<double>&) { return MotionSamples{}; }};
  EXPECT_EQ(deviation(broken, wave(4, 0), 1), INFINITY);
}

using Comparing = Scenes;

/// The path that is zero has no range that errors could be relative to; shooting finds it as well.
TEST_F(Comparing, ThePathThatIsZero) {
  const CompareOptions options{.tolerances = {1e-4, 1e-8}, .row_seconds = 0, .progress = nullptr};
  const Comparison found = compare(
      study(
          "[system]\ncoordinates = [\"q\"]\nlagrangian = \"(q'^2 - q^2)/2\"\n[boundary]\nstart = { q = 0 }\n"
          "end = { q = 0 }\nduration = 1\n"),
      options);
  ASSERT_TRUE(found.reference) << found.message;
  EXPECT_TRUE(found.any());
  EXPECT_EQ(found.rows.front().error, 0);
}

TEST_F(Comparing, InfiniteDurationsAreRefused) {
  const std::string kink =
      "[system]\ncoordinates = [\"u\"]\nlagrangian = \"u'^2/2 + 1 - cos(u)\"\n[boundary]\nstart = { u = 0 }\n"
      "end = { u = \"2*pi\" }\nduration = \"infinite\"\n";
  try {
    load(write("scene.toml", kink), {}, Purpose::comparison);
    FAIL();
  } catch (const SceneError& e) {
    EXPECT_NE(std::string(e.what()).find("scene.toml:7:12: with an infinite duration shooting"),
              std::string::npos)
        << e.what();
  }
}

TEST_F(Comparing, ErrorsFollowTolerances) {
  CompareOptions options{.tolerances = {1e-4, 1e-8}, .row_seconds = 0, .progress = nullptr};
  int shown = 0;
  options.progress = [&](const ComparisonRow&) { ++shown; };
  const Comparison found = compare(study(oscillator), options);
  ASSERT_TRUE(found.reference) << found.message;
  EXPECT_NEAR(found.reference->range, 1, 1e-9);
  EXPECT_TRUE(found.any());
  ASSERT_EQ(found.rows.size(), 8u);
  EXPECT_EQ(shown, 8);
  for (const ComparisonRow& row : found.rows) {
    EXPECT_EQ(row.status, Status::converged) << row.method;
    ASSERT_TRUE(row.error) << row.method;
    EXPECT_LE(*row.error, 10 * row.tolerance) << row.method;
    EXPECT_GE(*row.error, found.reference->error_estimate);
  }
}

TEST_F(Comparing, MarchesBesideIntegration) {
  const std::string scene =
      "[system]\nuse = \"henon-heiles\"\n[boundary]\nstart = { x = 0.0, y = 0.1, p_x = 0.35, p_y = 0.1 "
      "}\nduration = 30\n";
  const Comparison found =
      compare(study(scene), {.tolerances = {1e-4, 1e-8}, .row_seconds = 0, .progress = nullptr});
  ASSERT_TRUE(found.reference) << found.message;
  ASSERT_EQ(found.rows.size(), 4u);
  EXPECT_EQ(found.rows[2].method, "dop853");
  for (const ComparisonRow& row : found.rows) {
    EXPECT_EQ(row.status, Status::converged) << row.method;
    ASSERT_TRUE(row.error) << row.method;
    EXPECT_LE(*row.error, (row.method == "dop853" ? 1000 : 1) * row.tolerance) << row.method;
  }
}

TEST_F(Comparing, NothingWithoutAReference) {
  const Comparison found = compare(study(oscillator, {"boundary.duration=pi"}),
                                   {.tolerances = {1e-6}, .row_seconds = 0, .progress = {}});
  EXPECT_FALSE(found.reference);
  EXPECT_FALSE(found.any());
  EXPECT_EQ(found.rows.front().status, Status::conjugate_ends);
}
