#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "problem/beside_level.hpp"
#include "problem/singular_ends.hpp"

/// \file L̃(w, w', s) = φ' (L − dF/dt)(q, q'/φ', T φ), its derivatives by those of L − dF/dt.

namespace extremal {

namespace {

/// c x^e, 0 where c is.
double term(double c, double x, double e) { return c == 0 ? 0 : c * std::pow(x, e); }

}  // namespace

SmoothedLagrangian::SmoothedLagrangian(std::shared_ptr<const Lagrangian> base, const EndVariables& variables)
    : OpenEnds(variables.singular(false), variables.singular(true)),
      base_(std::move(base)),
      variables_(variables) {
  const int n = base_->structure().coordinates;
  structure_.coordinates = n;
  structure_.autonomous = structure_.harmonic = false;
  for (int z = 0; z < 2 * n; ++z) {
    structure_.gradient.push_back(z);
    for (int y = 0; y <= z; ++y) structure_.hessian.push_back({z, y});
  }
}

/// With r = φ', A = dq/dw, q' = A w'/r: ∂/∂w of q' is C/r, C = w' dA/dw.
void SmoothedLagrangian::evaluate(const Points& points, Order order, double* out, Scratch&) const {
  const std::size_t n = structure_.coordinates;
  const bool levelled = variables_.has_level();
  const std::size_t a = levelled ? variables_.coordinate : n;
  const std::ptrdiff_t stride = points.stride;
  const double m = variables_.power, side = variables_.side;
  BesideLevel beside(*base_, variables_.coordinate, variables_.level, side);
  std::vector<double> q(n), v(n);
  for (int i = 0; i < points.count; ++i) {
    const double s = points.t[i], r = variables_.rate(s);
    for (std::size_t b = 0; b < n; ++b) {
      q[b] = points.q[static_cast<std::ptrdiff_t>(b) * stride + i];
      v[b] = points.v[static_cast<std::ptrdiff_t>(b) * stride + i] / r;
    }
    double distance = 0, u = 0, slope = 1, bend = 0, twist = 0;
    if (levelled) {
      const double far = std::pow(q[a], m);
      distance = beside.rounded(far);
      const double w = distance == far ? q[a] : std::pow(distance, 1 / m);
      u = v[a] * r;
      slope = term(side * m, w, m - 1);
      bend = term(side * m * (m - 1), w, m - 2);
      twist = term(side * m * (m - 1) * (m - 2), w, m - 3);
      v[a] *= slope;
    }
    const double c = bend * u;
    beside.at(distance, q, v, variables_.precise_time(s), order);
    const BesideLevel::Values& l = beside.without(variables_.gauge());
    double* to = out + i;
    const auto put = [&](double x) {
      *to = x;
      to += stride;
    };
    const auto of = [](const DoubleDouble& x) { return to_double(x); };
    put(r * of(l.value));
    if (order == Order::value) continue;
    for (std::size_t b = 0; b < n; ++b)
      put(b == a ? r * slope * of(l.q[a]) + c * of(l.v[a]) : r * of(l.q[b]));
    for (std::size_t b = 0; b < n; ++b) put((b == a ? slope : 1) * of(l.v[b]));
    if (order == Order::gradient) continue;
    const auto factor = [&](std::size_t b) { return b == a ? slope : 1; };
    const auto extra = [&](std::size_t b) { return b == a ? c : 0; };
    const auto qq = [&](std::size_t b, std::size_t d) { return of(l.qq[b * n + d]); };
    const auto vq = [&](std::size_t b, std::size_t d) { return of(l.vq[b * n + d]); };
    const auto vv = [&](std::size_t b, std::size_t d) { return of(l.vv[b * n + d]) / r; };
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t d = 0; d <= b; ++d) {
        double x = r * factor(b) * factor(d) * qq(b, d) + factor(b) * extra(d) * vq(d, b) +
                   extra(b) * factor(d) * vq(b, d) + extra(b) * extra(d) * vv(b, d);
        if (b == a && d == a) x += r * bend * of(l.q[a]) + twist * u * of(l.v[a]);
        put(x);
      }
    for (std::size_t b = 0; b < n; ++b) {
      for (std::size_t d = 0; d < n; ++d) {
        double x = factor(b) * (factor(d) * vq(b, d) + extra(d) * vv(b, d));
        if (b == a && d == a) x += bend * of(l.v[a]);
        put(x);
      }
      for (std::size_t d = 0; d <= b; ++d) put(factor(b) * factor(d) * vv(b, d));
    }
  }
}

void SmoothedLagrangian::sensitivity(const Points&, int, double*, Scratch&) const {
  throw std::logic_error("a Lagrangian in smooth variables has no active parameters");
}

}  // namespace extremal
