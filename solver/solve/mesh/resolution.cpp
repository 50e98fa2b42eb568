#include "solve/mesh/resolution.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

namespace {

/// Coefficients are known to so many roundings of the extent of their element.
constexpr double noise = 8 * unit_roundoff;
/// Squares of how much smaller one coefficient may be expected than the last, of all coordinates together.
/// Where all of one is in the coefficients before, another's seem to fall faster than they do: what falls by
/// more than `fast` is judged by the coordinate with the largest of the last.
constexpr double fastest = 1e-6, fast = 1e-4, slowest = 0.95;
/// A range this much smaller than the coordinates is roundoff.
constexpr double negligible = 1e-12;
/// Velocities are not asked for more digits than this share of the mean speed gives.
constexpr double nearly_uniform = 1e-3;

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
    // Lane by lane; idle lanes repeat the last element.
    double low[lanes], high[lanes], slow[lanes], fast[lanes];
    std::fill_n(low, lanes, path.node(0)[a]);
    std::fill_n(high, lanes, path.node(0)[a]);
    std::fill_n(slow, lanes, INFINITY);
    std::fill_n(fast, lanes, -INFINITY);
    for (int b = 0; b < path.batches(); ++b) {
      const double* x = path.x(b) + static_cast<std::size_t>(a) * lanes;
      const double *start = x + static_cast<std::size_t>((degree - 1) * n) * lanes,
                   *delta = start + n * lanes;
      for (int j = 0; j <= degree; ++j) {
        const double tau = tables.scheme().lobatto[j];
        const double* inner = x + static_cast<std::size_t>((j - 1) * n) * lanes;
        const bool end = j == 0 || j == degree;
        for (int lane = 0; lane < lanes; ++lane) {
          const double q = start[lane] + tau * delta[lane] + (end ? 0 : inner[lane]);
          low[lane] = q < low[lane] ? q : low[lane];
          high[lane] = q > high[lane] ? q : high[lane];
        }
      }
      for (int lane = 0; lane < lanes; ++lane) {
        const double speed = delta[lane] / path.h(b)[lane];
        slow[lane] = speed < slow[lane] ? speed : slow[lane];
        fast[lane] = speed > fast[lane] ? speed : fast[lane];
      }
    }
    const double least = *std::min_element(low, low + lanes), most = *std::max_element(high, high + lanes);
    result.magnitude = std::max({result.magnitude, std::abs(most), std::abs(least)});
    result.q = std::max(result.q, most - least);
    result.v =
        std::max(result.v, *std::max_element(fast, fast + lanes) - *std::min_element(slow, slow + lanes));
  }
  result.range = result.q;
  if (result.q <= negligible * result.magnitude) result.q = result.magnitude;
  // A motion that is nearly uniform has hardly a range of velocity.
  if (path.duration() > 0) result.slowest = nearly_uniform * result.q / path.duration();
  result.v = std::max(result.v, result.slowest);
  return result;
}

void Resolution::measure(const Path& path, const ElementTables& tables) {
  const SchemeTables& scheme = tables.scheme();
  const int n = path.coordinates(), s = scheme.degree;
  degree_ = s;
  tails_.clear();
  double c[4][lanes], extent[lanes];
  for (int b = 0; b < path.batches(); ++b) {
    double last[lanes] = {}, second[lanes] = {}, before[lanes] = {}, own[lanes] = {};
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
        const double c0 = std::abs(c[0][lane]), c1 = std::abs(c[1][lane]),
                     earlier = std::max(std::abs(c[2][lane]), std::abs(c[3][lane]));
        own[lane] = std::max(c0, c1) > std::max(last[lane], second[lane]) ? earlier : own[lane];
        last[lane] = std::max(last[lane], c0);
        second[lane] = std::max(second[lane], c1);
        before[lane] = std::max(before[lane], earlier);
      }
    }
    const int count = std::min(lanes, path.elements() - b * lanes);
    for (int lane = 0; lane < count; ++lane) {
      // Coefficients at roundoff of the element's own extent are no measure.
      if (std::max(last[lane], second[lane]) < noise * extent[lane]) last[lane] = second[lane] = 0;
      const double size = std::max(last[lane], second[lane]);
      const double least = size > 0 ? std::clamp(size / own[lane], fastest, fast) : fastest;
      const double fall = std::sqrt(size == 0          ? fastest
                                    : before[lane] > 0 ? std::clamp(size / before[lane], least, slowest)
                                                       : slowest);
      tails_.push_back({std::max(last[lane], second[lane] * fall), fall, path.h(b)[lane]});
    }
  }
}

Resolution::Error Resolution::at(int degree) const {
  Error error;
  for (const Tail& tail : tails_) {
    double size = tail.size * tail.fall;
    for (int k = degree_; k < degree; ++k) size *= tail.fall;
    for (int k = degree; k < degree_; ++k) size /= tail.fall;
    error.q = std::max(error.q, size);
    const double slope = size * (degree + 1) * (degree + 2) / tail.h;
    error.v = std::max(error.v, slope);
    error.a = std::max(error.a, slope * degree * (degree + 3) / (2 * tail.h));
  }
  return error;
}

int Resolution::degree_for(const Error& allowed, int highest) const {
  int degree = degree_;
  for (; degree <= highest; ++degree) {
    const Error error = at(degree);
    if (error.q <= allowed.q && error.v <= allowed.v) break;
  }
  return degree;
}

}  // namespace extremal
