#include "motion/lanes.hpp"

#include "machine/lanes.hpp"

namespace extremal::EXTREMAL_LEVEL {

namespace {

inline const Vec& row(const double* p, long k) { return at(p + lanes * k); }
inline Vec& row(double* p, long k) { return at(p + lanes * k); }

inline Vec larger(Vec a, Vec b) { return a > b ? a : b; }
inline Vec magnitude(Vec a) { return a < 0 ? -a : a; }

inline Vec sum(const LaneStage* stages, int count, long r) {
  Vec total = stages[0].weight * row(stages[0].slope, r);
  for (int j = 1; j < count; ++j) total += stages[j].weight * row(stages[j].slope, r);
  return total;
}

void combine(const double* y, const double* h, const LaneStage* stages, int count, double* out, int rows) {
  const Vec step = at(h);
  for (long r = 0; r < rows; ++r) row(out, r) = row(y, r) + step * sum(stages, count, r);
}

void add_products(const LaneEntry* entries, int count, double sign, const double* x, double* y, int columns,
                  long x_stride, long y_stride) {
  for (int e = 0; e < count; ++e) {
    const Vec value = sign * at(entries[e].value);
    const double* from = x + lanes * entries[e].column;
    double* to = y + lanes * entries[e].row;
    for (int c = 0; c < columns; ++c) row(to, c * y_stride) += value * row(from, c * x_stride);
  }
}

void add_errors(const double* y, const double* next, const LaneStage* first, int first_count,
                const LaneStage* second, int second_count, double tolerance, double* sums, int rows) {
  Vec scale = broadcast(0), squares5 = scale, squares3 = scale;
  for (long r = 0; r < rows; ++r)
    scale = larger(scale, larger(magnitude(row(y, r)), magnitude(row(next, r))));
  // A block that is zero has no error.
  const Vec inverse = scale > 0 ? 1 / (tolerance * scale) : broadcast(0);
  for (long r = 0; r < rows; ++r) {
    const Vec e5 = inverse * sum(first, first_count, r), e3 = inverse * sum(second, second_count, r);
    squares5 += e5 * e5;
    squares3 += e3 * e3;
  }
  row(sums, 0) += squares5;
  row(sums, 1) += squares3;
}

void factor(double* matrix, int n) {
  for (int j = 0; j < n; ++j) {
    const Vec inverse = 1 / row(matrix, j * n + j);
    for (int m = j + 1; m < n; ++m) {
      const Vec scaled = inverse * row(matrix, m * n + j);
      for (int i = m; i < n; ++i) row(matrix, i * n + m) -= scaled * row(matrix, i * n + j);
    }
    for (int i = j + 1; i < n; ++i) row(matrix, i * n + j) *= inverse;
    row(matrix, j * n + j) = inverse;
  }
}

void solve(const double* factors, int n, double* x, int columns, long stride) {
  for (int c = 0; c < columns; ++c, x += lanes * stride) {
    for (int j = 0; j < n; ++j)
      for (int i = j + 1; i < n; ++i) row(x, i) -= row(factors, i * n + j) * row(x, j);
    for (int j = n - 1; j >= 0; --j) {
      Vec value = row(factors, j * n + j) * row(x, j);
      for (int i = j + 1; i < n; ++i) value -= row(factors, i * n + j) * row(x, i);
      row(x, j) = value;
    }
  }
}

}  // namespace

LaneKernels lane_kernels() { return {combine, add_products, add_errors, factor, solve}; }

}  // namespace extremal::EXTREMAL_LEVEL
