#include "system/chart.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace extremal {

int Chart::features() const {
  const auto among_u = [&](const Polar& p) { return p.angle < free; };
  return 1 + free + 2 * static_cast<int>(std::ranges::count_if(polar, among_u));
}

void Chart::put_features(std::span<const double> u, std::span<double> out) const {
  out[0] = 1;
  std::copy_n(u.begin(), free, out.begin() + 1);
  std::size_t at = free + 1;
  for (const Polar& p : polar) {
    if (p.angle >= free) continue;
    out[at++] = std::cos(u[p.angle] / p.unit);
    out[at++] = std::sin(u[p.angle] / p.unit);
  }
}

void Chart::combine(std::span<const double> z, std::span<double> q) const {
  for (int a = 0; a < coordinates; ++a) {
    q[a] = 0;
    for (int b = 0; b < coordinates; ++b)
      if (const double factor = basis[a * coordinates + b]; factor != 0) q[a] += factor * z[b];
  }
}

void Chart::lift(std::span<const double> y, std::span<double> q) const {
  std::vector<double> z(y.begin(), y.end());
  for (const Polar& p : polar) {
    const double angle = y[p.angle] / p.unit, r = y[p.radius];
    z[p.angle] = p.x + r * std::cos(angle);
    z[p.radius] = p.y + r * std::sin(angle);
  }
  combine(z, q);
}

void Chart::lift(std::span<const double> y, std::span<const double> dy, std::span<double> v) const {
  std::vector<double> dz(dy.begin(), dy.end());
  for (const Polar& p : polar) {
    const double angle = y[p.angle] / p.unit, c = std::cos(angle), s = std::sin(angle);
    const double along = y[p.radius] * dy[p.angle] / p.unit, out = dy[p.radius];
    dz[p.angle] = out * c - along * s;
    dz[p.radius] = out * s + along * c;
  }
  combine(dz, v);
}

std::vector<double> Chart::slopes(std::span<const double> y) const {
  const std::size_t n = coordinates;
  std::vector<double> result(n * n), direction(n), column(n);
  for (std::size_t b = 0; b < n; ++b) {
    std::ranges::fill(direction, 0.0);
    direction[b] = 1;
    lift(y, direction, column);
    for (std::size_t a = 0; a < n; ++a) result[a * n + b] = column[a];
  }
  return result;
}

std::vector<double> Chart::coordinates_of(std::span<const double> inverse, std::span<const double> q,
                                          std::span<const double> near) const {
  const std::size_t n = coordinates;
  std::vector<double> y(n, 0.0);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) y[a] += inverse[a * n + b] * q[b];
  constexpr double whole = 2 * std::numbers::pi;
  for (const Polar& p : polar) {
    const double x = y[p.angle] - p.x, height = y[p.radius] - p.y;
    double angle = std::atan2(height, x);
    if (!near.empty()) angle += whole * std::round((near[p.angle] / p.unit - angle) / whole);
    y[p.angle] = p.unit * angle;
    y[p.radius] = std::hypot(x, height);
  }
  return y;
}

}  // namespace extremal
