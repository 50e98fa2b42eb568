#include "system/minimal_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "machine/aligned.hpp"
#include "machine/simd.hpp"
#include "system/structure.hpp"

namespace extremal {

namespace {

constexpr int most_steps_of_w = 24;
/// A step of this part of w is the last: it squares the error.
constexpr double last_step_of_w = 1e-9;

}  // namespace

Tape tape_of(const std::shared_ptr<const Kernel>& kernel, const std::vector<Scaled>& roots) {
  std::vector<int> rows(roots.size());
  for (std::size_t k = 0; k < roots.size(); ++k) rows[k] = static_cast<int>(k);
  const Tape::Contribution all[] = {{kernel, roots, std::move(rows)}};
  return Tape(all, static_cast<int>(roots.size()), {});
}

MinimalLagrangian::MinimalLagrangian(const MinimalExpressions& made, Chart chart) : chart_(std::move(chart)) {
  const auto kernel = std::make_shared<const Kernel>(made.kernel);
  structure_.coordinates = chart_.free;
  structure_.autonomous = structure_.harmonic = made.autonomous;
  structure_.pulses = pulses(*kernel, made.value.node);
  std::vector<Scaled> roots{made.value};
  orders_[0] = tape_of(kernel, roots);
  for (const Partial& p : made.gradient) {
    structure_.gradient.push_back(static_cast<int>(p.input));
    roots.push_back(p.value);
  }
  orders_[1] = tape_of(kernel, roots);
  for (const auto& [row, column, value] : made.hessian) {
    structure_.hessian.push_back({row, column});
    roots.push_back(value);
  }
  orders_[2] = tape_of(kernel, roots);
  roots = made.steps;
  roots.insert(roots.end(), made.pivots.begin(), made.pivots.end());
  moves_ = tape_of(kernel, roots);
  start_ = tape_of(kernel, made.start);
  rates_ = tape_of(kernel, made.rates);
  slopes_ = tape_of(kernel, made.slopes);
  for (Tape* tape : {&orders_[0], &orders_[1], &orders_[2], &start_, &moves_, &rates_, &slopes_})
    for (const Tape* other : {&orders_[2], &moves_}) tape->fit(*other);
}

/// w for the u that stand in `y`, by Newton's method at all points at a time.
void MinimalLagrangian::find(const Points& points, double* y, double* moves, Scratch& scratch) const {
  const int m = constraints(), d = chart_.free;
  const double last = last_step_of_w * chart_.size;
  const Points at{points.count, points.stride, y, nullptr, points.t};
  start_.play(at, y + d * points.stride, scratch);
  bool left = true;
  for (int k = 0; k < most_steps_of_w && left; ++k) {
    moves_.play(at, moves, scratch);
    double longest = 0;
    for (int l = 0; l < m; ++l) {
      double* w = y + (d + l) * points.stride;
      const double* step = moves + l * points.stride;
      for (int i = 0; i < points.count; ++i) {
        w[i] -= step[i];
        longest = std::abs(step[i]) > longest ? std::abs(step[i]) : longest;
      }
    }
    left = longest > last;
  }
  // Beyond the chart, and where steps have not become small.
  for (int l = 0; l < m; ++l) {
    const double *step = moves + l * points.stride, *pivot = moves + (m + l) * points.stride;
    for (int i = 0; i < points.count; ++i) {
      if (pivot[i] > 0 && std::abs(step[i]) <= last) continue;
      for (int k = d; k < chart_.coordinates; ++k)
        y[k * points.stride + i] = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

double* MinimalLagrangian::dependent(const Points& points, std::size_t doubles, std::size_t further,
                                     Scratch& scratch) const {
  std::size_t of_tapes = doubles;
  for (const Tape* tape : {&orders_[0], &orders_[1], &orders_[2], &start_, &moves_, &rates_, &slopes_})
    of_tapes = std::max(of_tapes, tape->doubles(points.count));
  const std::size_t n = chart_.coordinates, m = constraints();
  double* y = scratch.reserve(of_tapes + (n + std::max(2 * m, further)) * points.stride) + of_tapes;
  for (int a = 0; a < chart_.free; ++a)
    std::copy_n(points.q + a * points.stride, points.count, y + a * points.stride);
  find(points, y, y + n * points.stride, scratch);
  return y;
}

void MinimalLagrangian::evaluate(const Points& points, Order order, double* out, Scratch& scratch) const {
  const double* y = dependent(points, 0, 0, scratch);
  orders_[static_cast<int>(order)].play({points.count, points.stride, y, points.v, points.t}, out, scratch);
}

void MinimalLagrangian::sensitivity(const Points&, int, double*, Scratch&) const {
  throw std::logic_error("minimal coordinates have no parameters");
}

MinimalLagrangian::Lifted MinimalLagrangian::lift(std::span<const double> u, std::span<const double> du,
                                                  std::span<const double> t) const {
  const std::size_t points = t.size();
  const int n = chart_.coordinates, d = chart_.free, m = constraints(), velocities = du.empty() ? 0 : d;
  const std::ptrdiff_t stride =
      (static_cast<std::ptrdiff_t>(points) + most_lanes - 1) / most_lanes * most_lanes;
  AlignedDoubles rows(static_cast<std::size_t>(d + velocities + 1) * stride);
  double *const rates = rows.data() + d * stride, *const times = rates + velocities * stride;
  for (std::ptrdiff_t i = 0; i < stride; ++i) {
    const std::size_t k = std::min(static_cast<std::size_t>(i), points - 1);
    for (int a = 0; a < d; ++a) rows[a * stride + i] = u[k * d + a];
    for (int a = 0; a < velocities; ++a) rates[a * stride + i] = du[k * d + a];
    times[i] = t[k];
  }
  Scratch scratch;
  const Points all{static_cast<int>(stride), stride, rows.data(), rates, times};
  double* const y = dependent(all, 0, static_cast<std::size_t>(m) * d, scratch);
  double* const further = y + n * stride;
  const Points at{all.count, stride, y, rates, times};
  Lifted result;
  result.q.resize(points * n);
  const std::size_t size = n;
  std::vector<double> whole(points * n), direction(n);
  const auto point = [&](std::size_t i) { return std::span<const double>(&whole[i * n], size); };
  for (std::size_t i = 0; i < points; ++i) {
    for (int a = 0; a < n; ++a) whole[i * n + a] = y[a * stride + static_cast<std::ptrdiff_t>(i)];
    chart_.lift(point(i), {&result.q[i * n], size});
  }
  if (velocities > 0) {
    rates_.play(at, further, scratch);
    result.v.resize(points * n);
    for (std::size_t i = 0; i < points; ++i) {
      for (int a = 0; a < n; ++a) direction[a] = (a < d ? rates + a * stride : further + (a - d) * stride)[i];
      chart_.lift(point(i), direction, {&result.v[i * n], size});
    }
  }
  slopes_.play(at, further, scratch);
  std::vector<double> sums(n), column(n);
  for (std::size_t i = 0; i < points; ++i) {
    std::ranges::fill(sums, 0.0);
    for (int j = 0; j < d; ++j) {
      std::ranges::fill(direction, 0.0);
      direction[j] = 1;
      for (int l = 0; l < m; ++l)
        direction[d + l] = further[(l * d + j) * stride + static_cast<std::ptrdiff_t>(i)];
      chart_.lift(point(i), direction, column);
      for (int a = 0; a < n; ++a) sums[a] += std::abs(column[a]);
    }
    result.stretch.push_back(*std::ranges::max_element(sums));
  }
  return result;
}

}  // namespace extremal
