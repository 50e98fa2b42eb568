#include "system/minimal_copies.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "machine/aligned.hpp"
#include "system/structure.hpp"

namespace extremal {

MinimalCopies::MinimalCopies(std::shared_ptr<const MinimalLagrangian> one, const MinimalExpressions& made)
    : one_(std::move(one)) {
  const auto kernel = std::make_shared<const Kernel>(made.kernel);
  const int d = one_->chart().free;
  structure_.coordinates = 2 * d;
  structure_.autonomous = structure_.harmonic = made.autonomous && made.autonomous_forces;
  structure_.pulses = std::ranges::any_of(made.motion, [&](Scaled m) { return pulses(*kernel, m.node); });
  // (q₁, q₂, q₁', q₂'): the second copies have the opposite of the first.
  std::vector<Scaled> roots;
  for (int z = 0; z < 4 * d; ++z) {
    structure_.gradient.push_back(z);
    const Scaled first = made.motion[z / (2 * d) * d + z % d];
    roots.push_back(z / d % 2 == 0 ? first : -first);
  }
  motion_ = tape_of(kernel, roots);
  for (const auto& [row, column, value] : made.copies_hessian) {
    structure_.hessian.push_back({row, column});
    roots.push_back(value);
  }
  hessian_ = tape_of(kernel, roots);
}

bool MinimalCopies::agree(const Points& points) const {
  const int d = one_->chart().free;
  for (const double* rows : {points.q, points.v})
    for (int a = 0; a < d; ++a) {
      const double* first = rows + a * points.stride;
      if (!std::equal(first, first + points.count, first + d * points.stride)) return false;
    }
  return true;
}

void MinimalCopies::evaluate_agreeing(const Points& one, Order order, double* out, Scratch& scratch) const {
  std::fill_n(out, one.count, 0.0);
  if (order == Order::value) return;
  const Tape& tape = order == Order::gradient ? motion_ : hessian_;
  const double* y = one_->dependent(one, tape.doubles(one.count), 0, scratch);
  tape.play({one.count, one.stride, y, one.v, one.t}, out + one.stride, scratch);
}

/// Λ is linear in λ: with ζ half the differences, of opposite signs for the copies, and G, H the derivatives
/// at the mean, the value is G ζ, the gradient G + H ζ.
void MinimalCopies::evaluate_apart(const Points& points, Order order, double* out, Scratch& scratch) const {
  const std::ptrdiff_t stride = points.stride;
  const int d = one_->chart().free;
  AlignedDoubles mean(static_cast<std::size_t>(2 * d) * stride),
      half(static_cast<std::size_t>(4 * d) * stride),
      rows(static_cast<std::size_t>(this->rows(Order::hessian)) * stride);
  for (int a = 0; a < 2 * d; ++a) {
    const int first = a / d * 2 * d + a % d;
    const double* const from = (a < d ? points.q : points.v) + a % d * stride;
    for (int i = 0; i < points.count; ++i) {
      const double x = from[i], other = from[d * stride + i];
      mean[a * stride + i] = (x + other) / 2;
      half[first * stride + i] = (x - other) / 2;
      half[(first + d) * stride + i] = (other - x) / 2;
    }
  }
  const Points one{points.count, stride, mean.data(), mean.data() + d * stride, points.t};
  evaluate_agreeing(one, Order::hessian, rows.data(), scratch);
  for (int k = 0; k < this->rows(order); ++k) std::copy_n(&rows[k * stride], points.count, out + k * stride);
  const double* const slopes = rows.data() + stride;
  for (int z = 0; z < 4 * d; ++z)
    for (int i = 0; i < points.count; ++i) out[i] += slopes[z * stride + i] * half[z * stride + i];
  if (order == Order::value) return;
  const double* second = slopes + 4 * d * stride;
  for (const auto& [row, column] : structure_.hessian) {
    for (int i = 0; i < points.count; ++i) {
      out[(1 + row) * stride + i] += second[i] * half[column * stride + i];
      if (row != column) out[(1 + column) * stride + i] += second[i] * half[row * stride + i];
    }
    second += stride;
  }
}

void MinimalCopies::evaluate(const Points& points, Order order, double* out, Scratch& scratch) const {
  if (agree(points))
    evaluate_agreeing(points, order, out, scratch);
  else
    evaluate_apart(points, order, out, scratch);
}

void MinimalCopies::sensitivity(const Points&, int, double*, Scratch&) const {
  throw std::logic_error("minimal coordinates have no parameters");
}

MinimalSystem minimal_system(const ConstrainedGraph& system, const Chart& chart) {
  const MinimalExpressions made = minimal_expressions(system, chart);
  MinimalSystem result{std::make_shared<const MinimalLagrangian>(made, chart), nullptr};
  if (!system.forces.empty()) result.copies = std::make_shared<const MinimalCopies>(result.lagrangian, made);
  return result;
}

}  // namespace extremal
