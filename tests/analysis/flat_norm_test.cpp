#include "analysis/flat_norm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

/// \file The flat norm: Müller-Ortiz (3.2), the laws of a norm, and all corners of small measures.

namespace extremal {
namespace {

TEST(FlatNorm, OfPointMasses) {
  EXPECT_EQ(flat_norm({}), 0);
  EXPECT_EQ(flat_norm({{3.5, 1}}), 1);
  EXPECT_EQ(flat_norm({{3.5, {0, -2}}}), 2);
  for (double distance : {0.0, 1e-12, 0.25, 1.5, 2.0, 7.0}) {
    EXPECT_NEAR(flat_norm({{1, 1}, {1 + distance, -1}}), std::min(distance, 2.0), 1e-15) << distance;
    EXPECT_EQ(flat_norm({{1, 1}, {1 + distance, 1}}), 2);
  }
  // Moving 2 by 0.5 and taking away what is left over.
  EXPECT_NEAR(flat_norm({{0, 3}, {0.5, -2}}), 2 * 0.5 + 1, 1e-15);
  // Of the same place, with another phase.
  EXPECT_NEAR(flat_norm({{1, 1}, {1, std::polar(-1.0, 0.3)}}), std::abs(1.0 - std::polar(1.0, 0.3)), 1e-14);
}

/// The largest value over a grid of functions with |f| ≤ 1 and slopes of at most 1: where points and weights
/// are multiples of 1/4, some best function has values that are.
double best_on_grid(const std::vector<PointMass>& measure, std::complex<double> direction) {
  constexpr int values = 9;
  std::vector<double> best(values, 0.0);
  for (std::size_t k = 0; k < measure.size(); ++k) {
    std::vector<double> next(values, -std::numeric_limits<double>::infinity());
    for (int f = 0; f < values; ++f)
      for (int g = 0; g < values; ++g) {
        const double distance = k == 0 ? 2 : measure[k].at - measure[k - 1].at;
        if (std::abs(f - g) * 0.25 > distance) continue;
        next[f] =
            std::max(next[f], best[g] + (f * 0.25 - 1) * std::real(measure[k].weight * std::conj(direction)));
      }
    best = next;
  }
  return *std::max_element(best.begin(), best.end());
}

std::vector<PointMass> random_measure(std::mt19937& random, bool complex) {
  std::uniform_int_distribution<int> step(0, 5), weight(-8, 8), count(1, 9);
  std::vector<PointMass> measure(count(random));
  double at = 0;
  for (PointMass& mass : measure)
    mass = {at += 0.25 * step(random), {0.25 * weight(random), complex ? 0.25 * weight(random) : 0}};
  return measure;
}

TEST(FlatNorm, OfSignedMeasuresIsTheBestOnAGrid) {
  std::mt19937 random(3);
  for (int k = 0; k < 300; ++k) {
    const std::vector<PointMass> measure = random_measure(random, false);
    EXPECT_NEAR(flat_norm(measure), best_on_grid(measure, 1), 1e-13);
  }
}

TEST(FlatNorm, OfComplexMeasuresIsTheBestInAllDirections) {
  std::mt19937 random(4);
  for (int k = 0; k < 60; ++k) {
    const std::vector<PointMass> measure = random_measure(random, true);
    double best = 0;
    for (int j = 0; j < 2000; ++j)
      best = std::max(best, best_on_grid(measure, std::polar(1.0, j * std::numbers::pi / 1000)));
    EXPECT_LE(best, flat_norm(measure) * (1 + 1e-13));
    EXPECT_GE(best, flat_norm(measure) * std::cos(std::numbers::pi / 2000));
  }
}

/// Lines that agree but for their last digits: what is left is roundoff, and there are corners without end.
TEST(FlatNorm, OfComplexMeasuresThatCancel) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> digits(-1, 1);
  for (const double off : {1e-9, 1e-15, 0.0}) {
    std::vector<PointMass> measure;
    for (int k = 1; k <= 12; ++k) {
      const std::complex<double> weight = std::polar(1.0 / k, 0.7 * k);
      measure.push_back({0.9 * k, weight});
      measure.push_back({0.9 * k + off * digits(random), -weight * std::polar(1.0, off * digits(random))});
    }
    EXPECT_LE(flat_norm(measure), 12 * off + 1e-14);
  }
}

TEST(FlatNorm, IsANorm) {
  std::mt19937 random(5);
  for (int k = 0; k < 50; ++k) {
    std::vector<PointMass> a = random_measure(random, true), b = random_measure(random, true), sum = a,
                           turned = a;
    sum.insert(sum.end(), b.begin(), b.end());
    for (PointMass& mass : turned) mass.weight *= std::polar(3.0, 0.7);
    EXPECT_LE(flat_norm(sum), flat_norm(a) + flat_norm(b) + 1e-12);
    EXPECT_NEAR(flat_norm(turned), 3 * flat_norm(a), 1e-12 * (1 + flat_norm(a)));
  }
}

TEST(FlatNorm, RefusesWhatIsNotFinite) {
  EXPECT_THROW(flat_norm({{NAN, 1}}), std::invalid_argument);
  EXPECT_THROW(flat_norm({{1, INFINITY}}), std::invalid_argument);
}

}  // namespace
}  // namespace extremal
