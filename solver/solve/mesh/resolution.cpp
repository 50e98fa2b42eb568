#include "solve/mesh/resolution.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::resolution;

namespace {

/// Legendre coefficient k of every coordinate, over the elements of a batch: n × lanes.
void coefficients(const double* x, const SchemeTables& tables, int width, int k, double* out) {
  const double* row = tables.legendre.data() + static_cast<std::size_t>(k) * tables.functions;
  std::fill_n(out, width, 0.0);
  const auto add = [&](double factor, const double* from) {
    for (int u = 0; u < width; ++u) out[u] += factor * from[u];
  };
  for (int j = 0; j + 2 < tables.functions; ++j) add(row[j], x + static_cast<std::size_t>(j) * width);
  if (k == 1) add(0.5, x + static_cast<std::size_t>(tables.degree) * width);
}

/// Least and largest entries of some rows that come one by one.
struct Extremes {
  static constexpr int most = 64;  ///< entries of a row
  double low[most], high[most];
  Extremes() {
    std::fill_n(low, most, INFINITY);
    std::fill_n(high, most, -INFINITY);
  }
  template <class Value>
  void add(int count, const Value& value) {
    for (int k = 0; k < count; ++k) {
      const double x = value(k);
      low[k] = x < low[k] ? x : low[k];
      high[k] = x > high[k] ? x : high[k];
    }
  }
  double least(int first, int count) const { return *std::min_element(low + first, low + first + count); }
  double largest(int first, int count) const { return *std::max_element(high + first, high + first + count); }
};

}  // namespace

Scales scales(const Path& path, const ElementTables& tables) {
  const int n = path.coordinates(), degree = path.degree(), lanes = path.lanes(), width = n * lanes;
  Scales result;
  for (int from = 0; from < width; from += Extremes::most) {
    // Lane by lane; idle lanes repeat the last element.
    const int count = std::min(Extremes::most, width - from);
    Extremes values, speeds;
    double rates[Extremes::most];
    for (int b = 0; b < path.batches(); ++b) {
      const double *x = path.x(b) + from, *start = x + static_cast<std::size_t>(degree - 1) * width,
                   *delta = start + width, *h = path.h(b);
      values.add(count, [&](int k) { return start[k]; });
      values.add(count, [&](int k) { return start[k] + delta[k]; });
      for (int j = 1; j < degree; ++j) {
        const double tau = tables.scheme().lobatto[j];
        const double* inner = x + static_cast<std::size_t>(j - 1) * width;
        values.add(count, [&](int k) { return start[k] + tau * delta[k] + inner[k]; });
      }
      for (int k = 0; k < count; k += lanes)
        for (int lane = 0; lane < lanes; ++lane) rates[k + lane] = delta[k + lane] / h[lane];
      speeds.add(count, [&](int k) { return rates[k]; });
    }
    for (int k = 0; k < count; k += lanes) {
      const double least = values.least(k, lanes), most = values.largest(k, lanes);
      result.magnitude = std::max({result.magnitude, std::abs(most), std::abs(least)});
      result.q = std::max(result.q, most - least);
      result.v = std::max(result.v, speeds.largest(k, lanes) - speeds.least(k, lanes));
    }
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
  const int n = path.coordinates(), s = scheme.degree, lanes = path.lanes(), width = n * lanes;
  degree_ = s;
  tails_.clear();
  coefficients_.resize(static_cast<std::size_t>(4 * width));
  double* const c = coefficients_.data();
  for (int b = 0; b < path.batches(); ++b) {
    const double* const x = path.x(b);
    double extent[most_lanes] = {}, last[most_lanes] = {}, second[most_lanes] = {}, before[most_lanes] = {},
           own[most_lanes] = {};
    for (int u = 0; u < n * (s - 1); ++u)
      for (int lane = 0; lane < lanes; ++lane)
        extent[lane] = std::max(extent[lane], std::abs(x[u * lanes + lane]));
    for (int a = 0; a < n; ++a)
      for (int lane = 0; lane < lanes; ++lane)
        extent[lane] = std::max(extent[lane], 0.5 * std::abs(x[(s * n + a) * lanes + lane]));
    for (int k = 0; k < 4; ++k) {
      if (s - k >= 1)
        coefficients(x, scheme, width, s - k, c + k * width);
      else
        std::fill_n(c + k * width, width, 0.0);
    }
    for (int u = 0; u < width; u += lanes)
      for (int lane = 0; lane < lanes; ++lane) {
        const double* const at = c + u + lane;
        const double c0 = std::abs(at[0]), c1 = std::abs(at[width]),
                     earlier = std::max(std::abs(at[2 * width]), std::abs(at[3 * width]));
        own[lane] = std::max(c0, c1) > std::max(last[lane], second[lane]) ? earlier : own[lane];
        last[lane] = std::max(last[lane], c0);
        second[lane] = std::max(second[lane], c1);
        before[lane] = std::max(before[lane], earlier);
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
