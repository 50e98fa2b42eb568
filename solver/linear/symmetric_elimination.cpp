#include "linear/symmetric_elimination.hpp"

#include <algorithm>
#include <cmath>

#include "machine/roundoff.hpp"

namespace extremal {

namespace {

/// Rows that are a multiple of this many doubles apart share few lines of the nearest cache.
constexpr int aliasing = 64;

int rounded_up(int n, int padding) { return (n + padding - 1) / padding * padding; }

}  // namespace

SymmetricElimination::SymmetricElimination()
    : kernels_(at_simd_level(EXTREMAL_AT_EACH_LEVEL(dense_elimination_kernels))()) {}

void SymmetricElimination::resize(int pivots, int rest) {
  const int padding = kernels_.padding, half = rounded_up(pivots, padding),
            all = half + rounded_up(rest, padding);
  const int stride = all % aliasing == 0 ? all + padding : all;
  shape_ = {pivots, half, rest, stride};
  // Tiles of rows may reach beyond the last one.
  m_.assign(std::size_t(all + padding) * stride, 0.0);
  v_.resize(std::size_t(kernels_.block) * stride + padding);
  work_.resize(2 * std::size_t(stride));
}

bool SymmetricElimination::eliminate() {
  monitor_ = {};
  double* const work = work_.data();
  completed_ = kernels_.eliminate(shape_, m_.data(), v_.data(), work, work + shape_.stride, &monitor_);
  if (!completed_) return false;
  const double kept = std::pow(10.0, -least_digits);
  return monitor_.cancellation * machine_epsilon <= kept;
}

void SymmetricElimination::substitute() { kernels_.substitute(shape_, m_.data(), v_.data()); }

}  // namespace extremal
