#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "report/figure.hpp"

namespace extremal {

namespace {

/// Of 1, 2 and 5 times a power of ten, the first step that leaves at most `count` intervals.
struct TickStep {
  int leading = 1, power = 0;
  double size() const { return leading * std::pow(10.0, power); }
};

TickStep round_step(double length, double count) {
  const double wanted = length / std::max(count, 1.0);
  const int power = static_cast<int>(std::floor(std::log10(wanted)));
  const double mantissa = wanted / std::pow(10.0, power);
  for (const int leading : {1, 2, 5}) {
    if (mantissa <= leading * (1 + 1e-9)) return {leading, power};
  }
  return {1, power + 1};
}

std::string superscript(int number) {
  static constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : digits[c - '0'];
  return text;
}

std::string fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() != '-') return text;
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return (zero ? "" : "−") + text.substr(1);
}

}  // namespace

Axis make_axis(const AxisName& name, double low, double high, double count) {
  if (!(low < high) || !std::isfinite(high - low)) {
    throw std::invalid_argument(fmt::format("an axis from {} to {} cannot be drawn", low, high));
  }
  const TickStep step = round_step(high - low, count);
  const double largest = std::max(std::abs(low), std::abs(high));
  const int magnitude = static_cast<int>(std::floor(std::log10(largest)));
  const int exponent = magnitude >= 5 || magnitude < -2 ? magnitude : 0;
  const int decimals = std::max(0, exponent - step.power);

  Axis axis{.label = name.name, .low = low, .high = high, .ticks = {}};
  const std::string power = exponent != 0 ? "10" + superscript(exponent) : "";
  if (!name.unit.empty())
    axis.label += fmt::format(" ({}{}{})", power, power.empty() ? "" : " ", name.unit);
  else if (!power.empty())
    axis.label += fmt::format("  ({})", power);
  // Counted in whole steps: an accumulated sum would miss the last tick.
  const double slack = 1e-9;
  const double first = std::ceil(low / step.size() - slack), last = std::floor(high / step.size() + slack);
  for (double k = first; k <= last; k += 1) {
    const double at = k * step.size();
    axis.ticks.push_back({at, fixed(at / std::pow(10.0, exponent), decimals)});
  }
  return axis;
}

Extent extent(const std::vector<const Column*>& columns, double margin) {
  Extent all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Column* column : columns) {
    for (const double value : *column) {
      all.low = std::min(all.low, value);
      all.high = std::max(all.high, value);
    }
  }
  const double largest = std::max(std::abs(all.low), std::abs(all.high));
  if (all.size() <= 1e-9 * largest || all.size() < 1e-280) {
    const double half = largest < 1e-280 ? 1 : largest / 2;
    return {all.centre() - half, all.centre() + half, true};
  }
  const double more = margin * all.size();
  return {all.low - more, all.high + more};
}

}  // namespace extremal
