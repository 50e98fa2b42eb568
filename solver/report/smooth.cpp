#include "report/smooth.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

/// Derivatives at the points by the length s. Where chords before and after a point have opposite signs, the
/// coordinate has its extreme there if it `turns` at points alone, else near there.
Column slopes(const Column& s, const Column& values, bool turns) {
  const std::size_t count = s.size();
  Column chords(count - 1), result(count);
  for (std::size_t k = 0; k + 1 < count; ++k) chords[k] = (values[k + 1] - values[k]) / (s[k + 1] - s[k]);
  if (count == 2) return {chords[0], chords[0]};
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double before = s[k] - s[k - 1], after = s[k + 1] - s[k];
    const double parabola = (after * chords[k - 1] + before * chords[k]) / (before + after);
    const double most = 3 * std::min(std::abs(chords[k - 1]), std::abs(chords[k]));
    const bool extreme = chords[k - 1] * chords[k] <= 0;
    result[k] = extreme && turns ? 0 : std::clamp(parabola, -most, most);
  }
  const auto end = [](double near, double far, double chord, double next) {
    const double parabola = ((2 * near + far) * chord - near * next) / (near + far);
    return parabola * chord <= 0 ? 0 : std::clamp(parabola, -3 * std::abs(chord), 3 * std::abs(chord));
  };
  const std::size_t last = count - 1;
  result[0] = end(s[1] - s[0], s[2] - s[1], chords[0], chords[1]);
  result[last] = end(s[last] - s[last - 1], s[last - 1] - s[last - 2], chords[last - 1], chords[last - 2]);
  return result;
}

}  // namespace

Polyline smooth(const Polyline& points, int pieces) {
  if (points.x.size() < 2) return points;
  Column s{0};
  for (std::size_t k = 1; k < points.x.size(); ++k)
    s.push_back(s.back() + std::hypot(points.x[k] - points.x[k - 1], points.y[k] - points.y[k - 1]));
  const Column x_slopes = slopes(s, points.x, true), y_slopes = slopes(s, points.y, false);
  Polyline curve{{points.x[0]}, {points.y[0]}};
  for (std::size_t k = 0; k + 1 < s.size(); ++k) {
    const double length = s[k + 1] - s[k];
    for (int i = 1; i <= pieces; ++i) {
      const double u = static_cast<double>(i) / pieces, w = 1 - u;
      const auto hermite = [&](const Column& values, const Column& slope) {
        return w * w * (1 + 2 * u) * values[k] + u * u * (1 + 2 * w) * values[k + 1] +
               length * u * w * (w * slope[k] - u * slope[k + 1]);
      };
      curve.x.push_back(i == pieces ? points.x[k + 1] : hermite(points.x, x_slopes));
      curve.y.push_back(i == pieces ? points.y[k + 1] : hermite(points.y, y_slopes));
    }
  }
  return curve;
}

}  // namespace extremal
