#include "solve/resolution.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

namespace {

constexpr double noise = 0x1p-50;

/// Legendre coefficient k of coordinate a over the eight elements of a batch.
void coefficient(const double* x, const SchemeTables& tables, int n, int a, int k, double* out) {
  const double* row = tables.legendre.data() + static_cast<std::size_t>(k) * tables.functions;
  std::fill_n(out, lanes, 0.0);
  for (int j = 0; j + 2 < tables.functions; ++j)
    for (int lane = 0; lane < lanes; ++lane) out[lane] += row[j] * x[(j * n + a) * lanes + lane];
  if (k != 1) return;
  const double* delta = x + static_cast<std::size_t>((tables.degree * n) + a) * lanes;
  for (int lane = 0; lane < lanes; ++lane) out[lane] += 0.5 * delta[lane];
}

}  // namespace

Scales scales(const Path& path, const ElementTables& tables) {
  const int n = path.coordinates(), degree = path.degree();
  Scales result;
  for (int a = 0; a < n; ++a) {
    double low = path.node(0)[a], high = low, fast = 0, slow = 0;
    bool first = true;
    for (int k = 0; k < path.elements(); ++k) {
      const double* x = path.x(k / lanes) + k % lanes;
      const double qa = path.node(k)[a], delta = x[(degree * n + a) * lanes];
      const double h = path.h(k / lanes)[k % lanes], speed = delta / h;
      if (first || speed > fast) fast = speed;
      if (first || speed < slow) slow = speed;
      first = false;
      high = std::max(high, qa + delta);
      low = std::min(low, qa + delta);
      for (int j = 0; j + 1 < degree; ++j) {
        const double q = qa + tables.scheme().lobatto[j + 1] * delta + x[(j * n + a) * lanes];
        high = std::max(high, q);
        low = std::min(low, q);
      }
    }
    const double magnitude = std::max(std::abs(high), std::abs(low));
    const double range = high - low > 1e-12 * magnitude ? high - low : magnitude;
    result.q = std::max(result.q, range);
    result.magnitude = std::max(result.magnitude, magnitude);
    result.v = std::max({result.v, fast - slow});
  }
  // A uniform motion has no range of velocity: then its own size.
  result.v = std::max(result.v, path.duration() > 0 ? result.q / path.duration() : 0.0);
  return result;
}

void Resolution::measure(const Path& path, const ElementTables& tables) {
  const SchemeTables& scheme = tables.scheme();
  const int n = path.coordinates(), s = scheme.degree;
  degree_ = s;
  tails_.clear();
  double c[4][lanes], extent[lanes];
  for (int b = 0; b < path.batches(); ++b) {
    double last[lanes] = {}, second[lanes] = {}, before[lanes] = {};
    std::fill_n(extent, lanes, 0.0);
    for (int u = 0; u < n * (s - 1); ++u)
      for (int lane = 0; lane < lanes; ++lane)
        extent[lane] = std::max(extent[lane], std::abs(path.x(b)[u * lanes + lane]));
    for (int a = 0; a < n; ++a)
      for (int lane = 0; lane < lanes; ++lane)
        extent[lane] = std::max(extent[lane], 0.5 * std::abs(path.x(b)[(s * n + a) * lanes + lane]));
    for (int a = 0; a < n; ++a) {
      for (int k = 0; k < 4; ++k) {
        if (s - k >= 1)
          coefficient(path.x(b), scheme, n, a, s - k, c[k]);
        else
          std::fill_n(c[k], lanes, 0.0);
      }
      for (int lane = 0; lane < lanes; ++lane) {
        last[lane] = std::max(last[lane], std::abs(c[0][lane]));
        second[lane] = std::max(second[lane], std::abs(c[1][lane]));
        before[lane] = std::max({before[lane], std::abs(c[2][lane]), std::abs(c[3][lane])});
      }
    }
    const int count = std::min(lanes, path.elements() - b * lanes);
    for (int lane = 0; lane < count; ++lane) {
      // Coefficients at roundoff of the element's own extent tell nothing.
      if (std::max(last[lane], second[lane]) < noise * extent[lane]) last[lane] = second[lane] = 0;
      const double size = std::max(last[lane], second[lane]);
      const double rate = before[lane] > 0 ? std::clamp(size / before[lane], 1e-6, 0.95) : 0.95;
      tails_.push_back(
          {std::max(last[lane], second[lane] * std::sqrt(rate)), size == 0 ? 1e-6 : rate, path.h(b)[lane]});
    }
  }
}

Resolution::Error Resolution::at(int degree) const {
  Error error;
  const double steps = 0.5 * (degree - degree_) + 0.5;
  for (const Tail& tail : tails_) {
    const double size = tail.size * std::pow(tail.rate, steps);
    error.q = std::max(error.q, size);
    error.v = std::max(error.v, size * (degree + 1) * (degree + 2) / tail.h);
  }
  return error;
}

}  // namespace extremal
