#include "system/lagrangian.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// So many doubles of a vector, from a multiple of 64 bytes on.
double* aligned(std::vector<double>& memory, std::size_t doubles) {
  constexpr std::uintptr_t alignment = 64;
  const std::size_t needed = doubles + alignment / sizeof(double);
  if (memory.size() < needed) memory.resize(needed);
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  return memory.data() + (alignment - address % alignment) % alignment / sizeof(double);
}

/// Adds ½ vᵀ M v + vᵀ C q + aᵀ v and its derivatives.
void add_quadratic_form(const Structure& s, std::span<const double> q, std::span<const double> v, Order order,
                        PointValues& values) {
  const int n = s.coordinates;
  const bool first = order != Order::value, second = order == Order::hessian;
  for (const Triplet& m : s.mass) {
    values.value += 0.5 * v[m.row] * m.value * v[m.column];
    if (first) values.dv[m.row] += m.value * v[m.column];
    if (second) values.vv[m.row * n + m.column] += m.value;
  }
  for (const Triplet& c : s.gyroscopic) {
    values.value += v[c.row] * c.value * q[c.column];
    if (first) values.dv[c.row] += c.value * q[c.column];
    if (first) values.dq[c.column] += v[c.row] * c.value;
    if (second) values.vq[c.row * n + c.column] += c.value;
  }
  for (std::size_t a = 0; a < s.linear.size(); ++a) {
    values.value += s.linear[a] * v[a];
    if (first) values.dv[a] += s.linear[a];
  }
}

void put_hessian(const Structure& s, const double* rows, int stride, PointValues& values) {
  const int n = s.coordinates;
  for (std::size_t k = 0; k < s.hessian.size(); ++k) {
    const auto [a, b] = s.hessian[k];
    const double h = rows[k * stride];
    if (a < n) {
      values.qq[a * n + b] = values.qq[b * n + a] = h;
    } else if (b < n) {
      values.vq[(a - n) * n + b] = h;
    } else {
      values.vv[(a - n) * n + b - n] = values.vv[(b - n) * n + a - n] = h;
    }
  }
}

}  // namespace

double* Scratch::reserve(std::size_t doubles) { return aligned(memory, doubles); }

PointValues evaluate_at(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
                        double t, Order order, Scratch& scratch) {
  const Structure& s = lagrangian.structure();
  const auto n = static_cast<std::size_t>(s.coordinates);
  if (q.size() != n || v.size() != n)
    throw std::invalid_argument("a point of " + std::to_string(q.size()) + " coordinates and " +
                                std::to_string(v.size()) + " velocities; the system has " +
                                std::to_string(n));
  // One batch: the point in every lane.
  const int lanes = simd_lanes();
  const std::size_t read = (2 * n + 1) * lanes,
                    written = static_cast<std::size_t>(lagrangian.rows(order)) * lanes;
  double* const rows = aligned(scratch.point, read + most_lanes + written);
  double* const out = rows + (read + most_lanes - 1) / most_lanes * most_lanes;
  for (std::size_t a = 0; a < n; ++a) {
    std::fill_n(&rows[a * lanes], lanes, q[a]);
    std::fill_n(&rows[(n + a) * lanes], lanes, v[a]);
  }
  std::fill_n(&rows[2 * n * lanes], lanes, t);
  const Points points{lanes, lanes, rows, rows + n * lanes, rows + 2 * n * lanes};
  lagrangian.evaluate(points, order, out, scratch);

  PointValues values{.value = out[0], .dq = {}, .dv = {}, .qq = {}, .vq = {}, .vv = {}};
  if (order != Order::value) {
    values.dq.resize(n);
    values.dv.resize(n);
    for (std::size_t k = 0; k < s.gradient.size(); ++k) {
      const auto z = static_cast<std::size_t>(s.gradient[k]);
      (z < n ? values.dq[z] : values.dv[z - n]) = out[(1 + k) * lanes];
    }
  }
  if (order == Order::hessian) {
    values.qq.resize(n * n);
    values.vq.resize(n * n);
    values.vv.resize(n * n);
    put_hessian(s, out + (1 + s.gradient.size()) * lanes, lanes, values);
  }
  add_quadratic_form(s, q, v, order, values);
  return values;
}

}  // namespace extremal
