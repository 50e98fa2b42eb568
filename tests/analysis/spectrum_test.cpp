#include "analysis/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

/// \file Lines of signals that are sums of known lines.

namespace extremal {
namespace {

using std::numbers::pi;

std::vector<double> signal(const std::vector<SpectralLine>& lines, double step, std::size_t count) {
  std::vector<double> x(count);
  for (std::size_t j = 0; j < count; ++j)
    for (const SpectralLine& line : lines)
      x[j] += line.amplitude * std::cos(line.frequency * step * static_cast<double>(j) + line.phase);
  return x;
}

/// `lines` by falling amplitude. A phase is that of the first sample, half of the signal away from the
/// middle, where frequency and phase are independent.
void expect_lines(const Spectrum& found, const std::vector<SpectralLine>& lines, double duration,
                  double error) {
  ASSERT_EQ(found.lines.size(), lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double relative = error * lines[0].amplitude / lines[k].amplitude;
    EXPECT_NEAR(found.lines[k].frequency, lines[k].frequency, 10 * relative / duration) << k;
    EXPECT_NEAR(found.lines[k].amplitude, lines[k].amplitude, error * lines[0].amplitude) << k;
    EXPECT_NEAR(std::remainder(found.lines[k].phase - lines[k].phase, 2 * pi), 0, 10 * relative) << k;
  }
}

TEST(Spectrum, OneLine) {
  for (double omega : {0.07, 1.0, 2.3456789, 30.0}) {
    const std::vector<SpectralLine> lines = {{omega, 1.7, -2.1}};
    expect_lines(line_spectrum(signal(lines, 0.1, 10001), 0.1, {.amplitude = 1e-10}), lines, 1000, 1e-11);
  }
}

TEST(Spectrum, LinesOfVeryDifferentAmplitude) {
  const std::vector<SpectralLine> lines = {
      {1, 1, 0.3}, {std::numbers::sqrt2, 0.5, -3}, {0.1, 1e-2, 1}, {pi, 1e-4, 2}, {9, 1e-7, 0}};
  expect_lines(line_spectrum(signal(lines, 0.15, 8378), 0.15, {.amplitude = 1e-9}), lines, 1256, 1e-12);
}

/// Fewer than four bins of 2π/T apart, so that each is on the other's main lobe.
TEST(Spectrum, LinesThatTheWindowDoesNotSeparate) {
  const double bin = 2 * pi / 1000;
  const std::vector<SpectralLine> lines = {{1, 1, 0.3}, {1 + 3 * bin, 0.6, 1.4}, {1 - 2.5 * bin, 0.2, -1}};
  expect_lines(line_spectrum(signal(lines, 0.1, 10001), 0.1, {.amplitude = 1e-9}), lines, 1000, 1e-9);
}

TEST(Spectrum, ConstantAndSlowLine) {
  const std::vector<SpectralLine> lines = {{0.05, 2, 1}, {0, 1.5, pi}};
  const Spectrum found = line_spectrum(signal(lines, 0.1, 10001), 0.1, {.amplitude = 1e-10});
  expect_lines(found, lines, 1000, 1e-10);
  EXPECT_EQ(found.lines[1].frequency, 0);
}

/// The equal samples of a scheme may be few: two a period are enough for a single line.
TEST(Spectrum, FewSamplesAPeriod) {
  const std::vector<SpectralLine> lines = {{3.0, 1, 0.5}};
  expect_lines(line_spectrum(signal(lines, 1, 200), 1, {.amplitude = 1e-9}), lines, 200, 1e-10);
}

/// Sums of two frequencies near twice the highest are close to zero for the samples, of even and odd number.
TEST(Spectrum, FastLines) {
  for (const std::size_t count : {1000, 1001}) {
    const double step = 0.1, duration = step * static_cast<double>(count - 1), bin = 2 * pi / duration;
    const double highest = pi / step;
    const std::vector<SpectralLine> lines = {
        {highest - 3 * bin, 1, 0.3}, {highest - 6.5 * bin, 0.6, 1.4}, {highest - 90 * bin, 0.2, -1}};
    expect_lines(line_spectrum(signal(lines, step, count), step, {.amplitude = 1e-9}), lines, duration, 1e-9);
  }
}

TEST(Spectrum, SaysWhatIsLeft) {
  std::vector<double> x = signal({{1, 1, 0}}, 0.1, 10001);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 1e-3);
  for (double& value : x) value += noise(random);
  const Spectrum found = line_spectrum(x, 0.1, {.lines = 1});
  ASSERT_EQ(found.lines.size(), 1u);
  EXPECT_NEAR(found.residual, 1e-3, 5e-5);
  EXPECT_NEAR(found.lines[0].frequency, 1, 1e-6);
  EXPECT_EQ(line_spectrum(x, 0.1, {.amplitude = 1e-2}).lines.size(), 1u);
}

TEST(Spectrum, OfNothingIsEmpty) {
  EXPECT_TRUE(line_spectrum(std::vector<double>(64, 0.0), 1, {}).lines.empty());
  EXPECT_THROW(line_spectrum(std::vector<double>(15, 0.0), 1, {}), std::invalid_argument);
  EXPECT_THROW(line_spectrum(std::vector<double>(64, 0.0), 0, {}), std::invalid_argument);
  EXPECT_THROW(line_spectrum(std::vector<double>(64, NAN), 1, {}), std::invalid_argument);
}

/// 1/(1 − ε cos t) has the coefficients 2 rᵏ/√(1 − ε²), r = (1 − √(1 − ε²))/ε.
TEST(Spectrum, OfAPeriodIsItsFourierSeries) {
  const double epsilon = 0.6, r = (1 - 0.8) / epsilon, period = 5;
  std::vector<double> x(128);
  for (std::size_t j = 0; j < x.size(); ++j)
    x[j] = 1 / (1 - epsilon * std::cos(2 * pi * static_cast<double>(j) / static_cast<double>(x.size())));
  const Spectrum found = fourier_spectrum(x, period, {.lines = 12});
  ASSERT_EQ(found.lines.size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) {
    const double n = static_cast<double>(k);
    EXPECT_NEAR(found.lines[k].frequency, 2 * pi * n / period, 1e-14);
    EXPECT_NEAR(found.lines[k].amplitude, (k == 0 ? 1 : 2) * std::pow(r, n) / 0.8, 1e-14);
    EXPECT_NEAR(found.lines[k].phase, 0, 1e-9);
  }
  EXPECT_NEAR(found.residual, 2 * std::pow(r, 12) / 0.8 / std::sqrt(2 * (1 - r * r)), 1e-12);
}

}  // namespace
}  // namespace extremal
