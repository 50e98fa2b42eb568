#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "problem/singular_ends.hpp"

/// \file L̃(w, w', s) = φ' L(q, q'/φ', T φ), its derivatives by those of L.

namespace extremal {

namespace {

/// L and its derivatives at one point of a batch, n × n row by row.
struct WholeValues {
  double value = 0;
  std::vector<double> q, v, qq, vq, vv;

  explicit WholeValues(std::size_t n) : q(n), v(n), qq(n * n), vq(n * n), vv(n * n) {}

  /// With the quadratic part, which the rows leave out; `rows` has the stride of the points.
  void read(const Structure& s, const double* rows, std::ptrdiff_t stride, const double* at_q,
            const double* at_v, Order order) {
    const std::size_t n = s.coordinates;
    value = rows[0];
    for (std::vector<double>* part : {&q, &v, &qq, &vq, &vv}) std::fill(part->begin(), part->end(), 0.0);
    if (order != Order::value)
      for (std::size_t k = 0; k < s.gradient.size(); ++k) {
        const std::size_t z = s.gradient[k];
        (z < n ? q[z] : v[z - n]) = rows[static_cast<std::ptrdiff_t>(1 + k) * stride];
      }
    if (order == Order::hessian)
      read_hessian(s, rows + static_cast<std::ptrdiff_t>(1 + s.gradient.size()) * stride, stride);
    for (const Triplet& m : s.mass) {
      value += 0.5 * at_v[m.row * stride] * m.value * at_v[m.column * stride];
      v[m.row] += m.value * at_v[m.column * stride];
      vv[m.row * n + m.column] += m.value;
    }
    for (const Triplet& c : s.gyroscopic) {
      value += at_v[c.row * stride] * c.value * at_q[c.column * stride];
      v[c.row] += c.value * at_q[c.column * stride];
      q[c.column] += at_v[c.row * stride] * c.value;
      vq[c.row * n + c.column] += c.value;
    }
    for (std::size_t a = 0; a < s.linear.size(); ++a) {
      value += s.linear[a] * at_v[static_cast<std::ptrdiff_t>(a) * stride];
      v[a] += s.linear[a];
    }
  }

 private:
  void read_hessian(const Structure& s, const double* rows, std::ptrdiff_t stride) {
    const int n = s.coordinates;
    for (std::size_t k = 0; k < s.hessian.size(); ++k) {
      const auto [a, b] = s.hessian[k];
      const double h = rows[static_cast<std::ptrdiff_t>(k) * stride];
      if (a < n)
        qq[a * n + b] = qq[b * n + a] = h;
      else if (b < n)
        vq[(a - n) * n + b] = h;
      else
        vv[(a - n) * n + b - n] = vv[(b - n) * n + a - n] = h;
    }
  }
};

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
void SmoothedLagrangian::evaluate(const Points& points, Order order, double* out, Scratch& scratch) const {
  const std::size_t n = structure_.coordinates, a = variables_.coordinate;
  const std::ptrdiff_t stride = points.stride;
  const double m = variables_.power;
  const double side = variables_.side;
  Scratch own;
  double* const q = own.reserve((2 * n + 1 + base_->rows(order)) * stride);
  double *const v = q + n * stride, *const t = v + n * stride, *const rows = t + stride;
  for (int i = 0; i < points.count; ++i) {
    const double rate = variables_.rate(points.t[i]);
    t[i] = variables_.time(points.t[i]);
    for (std::size_t b = 0; b < n; ++b) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(b) * stride + i;
      q[at] = points.q[at];
      v[at] = points.v[at] / rate;
    }
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(a) * stride + i;
    const double w = points.q[at];
    q[at] = variables_.coordinate_at(w);
    v[at] *= term(side * m, variables_.rounded(w, q[at]), m - 1);
  }
  base_->evaluate({points.count, stride, q, v, t}, order, rows, scratch);
  WholeValues l(n);
  for (int i = 0; i < points.count; ++i) {
    l.read(base_->structure(), rows + i, stride, q + i, v + i, order);
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(a) * stride + i;
    const double r = variables_.rate(points.t[i]), w = variables_.rounded(points.q[at], q[at]),
                 u = points.v[at];
    const double slope = term(side * m, w, m - 1), bend = term(side * m * (m - 1), w, m - 2),
                 twist = term(side * m * (m - 1) * (m - 2), w, m - 3), c = bend * u;
    double* to = out + i;
    const auto put = [&](double x) {
      *to = x;
      to += stride;
    };
    put(r * l.value);
    if (order == Order::value) continue;
    for (std::size_t b = 0; b < n; ++b) put(b == a ? r * slope * l.q[a] + c * l.v[a] : r * l.q[b]);
    for (std::size_t b = 0; b < n; ++b) put((b == a ? slope : 1) * l.v[b]);
    if (order == Order::gradient) continue;
    const auto s = [&](std::size_t b) { return b == a ? slope : 1; };
    const auto extra = [&](std::size_t b) { return b == a ? c : 0; };
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t d = 0; d <= b; ++d) {
        double x = r * s(b) * s(d) * l.qq[b * n + d] + s(b) * extra(d) * l.vq[d * n + b] +
                   extra(b) * s(d) * l.vq[b * n + d] + extra(b) * extra(d) * l.vv[b * n + d] / r;
        if (b == a && d == a) x += r * bend * l.q[a] + twist * u * l.v[a];
        put(x);
      }
    for (std::size_t b = 0; b < n; ++b) {
      for (std::size_t d = 0; d < n; ++d) {
        double x = s(b) * (s(d) * l.vq[b * n + d] + extra(d) * l.vv[b * n + d] / r);
        if (b == a && d == a) x += bend * l.v[a];
        put(x);
      }
      for (std::size_t d = 0; d <= b; ++d) put(s(b) * s(d) * l.vv[b * n + d] / r);
    }
  }
}

void SmoothedLagrangian::sensitivity(const Points&, int, double*, Scratch&) const {
  throw std::logic_error("a Lagrangian in smooth variables has no active parameters");
}

}  // namespace extremal
