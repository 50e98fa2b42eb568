#include "solve/homotopy/weakened_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "machine/aligned.hpp"
#include "machine/bisect.hpp"
#include "machine/simd.hpp"
#include "solve/homotopy/limits.hpp"

namespace extremal {

using namespace limits::weakened_lagrangian;

namespace {

/// Quantiles of the density (1 + cos πz)/2 on [−1, 1], which averages waves away as their number cubed.
std::vector<double> quantiles(int count) {
  std::vector<double> result(count);
  for (int i = 0; i < count; ++i) {
    const auto below = [&](double z) {
      return 1 + z + std::sin(std::numbers::pi * z) / std::numbers::pi < (2 * i + 1.0) / count;
    };
    result[i] = bisect(-1, 1, bisections, below).middle();
  }
  return result;
}

/// Points within two spreads about the middle of the guess, as a batch of the Lagrangian: a Latin hypercube.
/// Means of functions of one variable, such as a force on each coordinate alone, are integrals without noise.
struct Cloud {
  AlignedDoubles q, v, t;
  int count;

  Cloud(const Problem& problem, double spread)
      : count((samples + simd_lanes() - 1) / simd_lanes() * simd_lanes()) {
    const std::size_t n = problem.coordinates();
    const double T = problem.duration.value;
    q.resize(n * count);
    v.resize(n * count);
    t.resize(count);
    const std::vector<double>& ends = problem.ends.offset;
    double extent = 0;
    for (const double x : problem.guess.given() ? problem.guess.q : ends)
      extent = std::max(extent, std::abs(x));
    if (!(extent > 0)) extent = 1;
    std::vector<double> middle(n);
    if (problem.guess.given())
      problem.guess.at(0.5, middle);
    else
      for (std::size_t a = 0; a < n; ++a) middle[a] = 0.5 * (ends[a] + ends[n + a]);
    std::vector<double> z = quantiles(count);
    std::minstd_rand random;
    const auto fill = [&](double* row, double center, double width) {
      for (std::size_t i = z.size() - 1; i > 0; --i) std::swap(z[i], z[random() % (i + 1)]);
      std::ranges::transform(z, row, [=](double x) { return center + width * x; });
    };
    fill(t.data(), 0.5 * T, 0.5 * T);
    for (std::size_t a = 0; a < n; ++a) {
      fill(q.data() + a * count, middle[a], 2 * spread * extent);
      fill(v.data() + a * count, 0, 2 * spread * extent / T);
    }
  }

  Points points(const Structure& structure) const {
    return {count, count, q.data(), structure.velocity_free ? nullptr : v.data(),
            structure.autonomous ? nullptr : t.data()};
  }
  /// Values of q_a or q'_a.
  const double* row(int z, int n) const {
    return (z < n ? q.data() : v.data() - static_cast<std::ptrdiff_t>(n) * count) +
           static_cast<std::ptrdiff_t>(z) * count;
  }
};

}  // namespace

WeakenedLagrangian::WeakenedLagrangian(std::shared_ptr<const Lagrangian> whole) : whole_(std::move(whole)) {
  structure_ = whole_->structure();
  structure_.parameters = 0;
}

int WeakenedLagrangian::row_of(int z) const {
  const std::vector<int>& all = structure_.gradient;
  return static_cast<int>(std::ranges::lower_bound(all, z) - all.begin());
}

std::shared_ptr<WeakenedLagrangian> WeakenedLagrangian::about(const Problem& problem, double spread) {
  std::shared_ptr<WeakenedLagrangian> result(new WeakenedLagrangian(problem.lagrangian));
  const Structure& structure = result->structure_;
  const int n = structure.coordinates, slopes = static_cast<int>(structure.gradient.size());
  const Cloud cloud(problem, spread);
  const auto stride = static_cast<std::size_t>(cloud.count);
  AlignedDoubles rows(problem.lagrangian->rows(Order::hessian) * stride);
  Scratch scratch;
  problem.lagrangian->evaluate(cloud.points(structure), Order::hessian, rows.data(), scratch);
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < stride; ++i) {
    double sum = 0;
    for (std::size_t row = 0; row * stride < rows.size(); ++row) sum += rows[row * stride + i];
    if (std::isfinite(sum)) usable.push_back(i);
  }
  if (2 * usable.size() < stride) return nullptr;
  const auto mean_of = [&](const double* row) {
    double sum = 0;
    for (const std::size_t i : usable) sum += row[i];
    return sum / static_cast<double>(usable.size());
  };
  for (std::size_t e = 0; e < structure.hessian.size(); ++e)
    result->curvatures_.push_back(mean_of(rows.data() + (1 + slopes + e) * stride));
  for (std::size_t e = 0; e < structure.hessian.size(); ++e) {
    const auto [r, c] = structure.hessian[e];
    const auto take = [&](int z, int by) {
      double* const slope = rows.data() + (1 + result->row_of(z)) * stride;
      const double* const x = cloud.row(by, n);
      for (std::size_t i = 0; i < stride; ++i) slope[i] -= result->curvatures_[e] * x[i];
    };
    take(r, c);
    if (r != c) take(c, r);
  }
  for (int k = 0; k < slopes; ++k) result->slopes_.push_back(mean_of(rows.data() + (1 + k) * stride));
  return result;
}

/// Rows of L by λ, and those of Q by 1 − λ.
void WeakenedLagrangian::evaluate(const Points& points, Order order, double* out, Scratch& scratch) const {
  const auto stride = points.stride;
  const std::ptrdiff_t n = structure_.coordinates, count = points.count;
  const double rest = 1 - part_;
  if (part_ == 0) {
    std::fill_n(out, rows(order) * stride, 0.0);
  } else {
    whole_->evaluate(points, order, out, scratch);
    for (std::ptrdiff_t i = 0; i < rows(order) * stride; ++i) out[i] *= part_;
  }
  const auto values_of = [&](int z) { return z < n ? points.q + z * stride : points.v + (z - n) * stride; };
  const auto slopes = static_cast<std::ptrdiff_t>(structure_.gradient.size());
  for (std::ptrdiff_t k = 0; k < slopes; ++k) {
    const double* const x = values_of(structure_.gradient[k]);
    for (std::ptrdiff_t i = 0; i < count; ++i) out[i] += rest * slopes_[k] * x[i];
    if (order == Order::value) continue;
    for (std::ptrdiff_t i = 0; i < count; ++i) out[(1 + k) * stride + i] += rest * slopes_[k];
  }
  for (std::size_t e = 0; e < structure_.hessian.size(); ++e) {
    const auto [r, c] = structure_.hessian[e];
    const double factor = rest * curvatures_[e];
    const double *const x = values_of(r), *const y = values_of(c);
    for (std::ptrdiff_t i = 0; i < count; ++i) out[i] += (r == c ? 0.5 : 1) * factor * x[i] * y[i];
    if (order == Order::value) continue;
    double *const by_x = out + (1 + row_of(r)) * stride, *const by_y = out + (1 + row_of(c)) * stride;
    for (std::ptrdiff_t i = 0; i < count; ++i) by_x[i] += factor * y[i];
    if (r != c)
      for (std::ptrdiff_t i = 0; i < count; ++i) by_y[i] += factor * x[i];
    if (order != Order::hessian) continue;
    double* const second = out + (1 + slopes + static_cast<std::ptrdiff_t>(e)) * stride;
    for (std::ptrdiff_t i = 0; i < count; ++i) second[i] += factor;
  }
}

}  // namespace extremal
