#include "linear/sparse.hpp"

#include <fmt/core.h>
#include <umfpack.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "linear/sparse_pattern.hpp"
#include "linear/supernodal.hpp"
#include "machine/roundoff.hpp"

namespace extremal {

namespace {

/// Growth beyond which solutions are refined, and beyond which refinement is not trusted to bring back what
/// it costs.
constexpr double mild = 16, wild = 1e5;

}  // namespace

struct SparseSymmetric::Work {
  int n = 0;
  bool factored = false, pivoted = false, refine = false;
  SupernodalFactor plain;
  SparsePattern pattern, full;     // the lower triangle, and for UMFPACK both
  std::vector<int> rows, columns;  // as the pattern was given
  std::vector<double> entry, value, scale;
  std::vector<double> full_value, x, b, r, first;
  void* symbolic = nullptr;
  void* numeric = nullptr;

  Work() = default;
  ~Work() { clear(); }
  Work(const Work&) = delete;
  void clear();
  void equilibrate();
  bool factor_pivoted();
  void solve_column(double* x);
  void multiply(const double* x, double* y) const;
};

void SparseSymmetric::Work::clear() {
  if (symbolic) umfpack_di_free_symbolic(&symbolic);
  if (numeric) umfpack_di_free_numeric(&numeric);
  factored = false;
}

/// Scales by powers of two (Ruiz, as for the chain), in so many sweeps or until none changes.
void SparseSymmetric::Work::equilibrate() {
  const int sweeps = 3;
  scale.assign(n, 1.0);
  bool changed = true;
  for (int sweep = 0; sweep < sweeps && std::exchange(changed, false); ++sweep) {
    x.assign(n, 0.0);
    for (int j = 0; j < n; ++j) {
      double largest = x[j];
      for (int p = pattern.begin[j]; p < pattern.begin[j + 1]; ++p) {
        const int i = pattern.row[p];
        const double size = std::abs(value[p]) * scale[j] * scale[i];
        largest = std::max(largest, size);
        x[i] = std::max(x[i], size);
      }
      x[j] = std::max(x[j], largest);
    }
    for (int i = 0; i < n; ++i) {
      const int halves = x[i] > 0 ? std::ilogb(x[i]) / 2 : 0;
      if (halves == 0) continue;
      scale[i] = std::ldexp(scale[i], -halves);
      changed = true;
    }
  }
  for (int j = 0; j < n; ++j)
    for (int p = pattern.begin[j]; p < pattern.begin[j + 1]; ++p)
      value[p] *= scale[j] * scale[pattern.row[p]];
}

bool SparseSymmetric::Work::factor_pivoted() {
  if (full.begin.empty()) full = both_triangles(pattern), full_value.resize(full.row.size());
  for (std::size_t k = 0; k < full.slot.size(); ++k) full_value[k] = value[full.slot[k]];
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  umfpack_di_defaults(control);
  control[UMFPACK_PRL] = 0;
  if (numeric) umfpack_di_free_numeric(&numeric);
  int status = UMFPACK_OK;
  if (!symbolic)
    status = umfpack_di_symbolic(n, n, full.begin.data(), full.row.data(), full_value.data(), &symbolic,
                                 control, info);
  if (status == UMFPACK_OK)
    status = umfpack_di_numeric(full.begin.data(), full.row.data(), full_value.data(), symbolic, &numeric,
                                control, info);
  if (status == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
  return status == UMFPACK_OK && info[UMFPACK_RCOND] > machine_epsilon;
}

void SparseSymmetric::Work::multiply(const double* from, double* to) const {
  std::fill_n(to, n, 0.0);
  for (int j = 0; j < n; ++j)
    for (int p = pattern.begin[j]; p < pattern.begin[j + 1]; ++p) {
      to[pattern.row[p]] += value[p] * from[j];
      if (pattern.row[p] != j) to[j] += value[p] * from[pattern.row[p]];
    }
}

/// The scaled system, in place.
void SparseSymmetric::Work::solve_column(double* y) {
  if (pivoted) {
    double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
    umfpack_di_defaults(control);
    control[UMFPACK_PRL] = 0;
    x.resize(n);
    umfpack_di_solve(UMFPACK_A, full.begin.data(), full.row.data(), full_value.data(), x.data(), y, numeric,
                     control, info);
    std::copy_n(x.data(), n, y);
    return;
  }
  plain.solve(y);
}

SparseSymmetric::SparseSymmetric() : work_(std::make_unique<Work>()) {}
SparseSymmetric::~SparseSymmetric() = default;
SparseSymmetric::SparseSymmetric(SparseSymmetric&&) noexcept = default;
SparseSymmetric& SparseSymmetric::operator=(SparseSymmetric&&) noexcept = default;

bool SparseSymmetric::pattern(int n, std::span<const int> rows, std::span<const int> columns,
                              const Deadline& deadline) {
  if (n < 0 || rows.size() != columns.size())
    throw std::invalid_argument(fmt::format("sparse: order {} with {} rows and {} columns of entries", n,
                                            rows.size(), columns.size()));
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (std::min(rows[k], columns[k]) < 0 || std::max(rows[k], columns[k]) >= n)
      throw std::invalid_argument(
          fmt::format("sparse: entry {} at ({}, {}) of order {}", k, rows[k], columns[k], n));
  Work& w = *work_;
  w.factored = false;
  if (n == w.n && std::ranges::equal(rows, w.rows) && std::ranges::equal(columns, w.columns)) return true;
  w.clear();
  w.n = n;
  w.rows.assign(rows.begin(), rows.end());
  w.columns.assign(columns.begin(), columns.end());
  w.pattern = lower_triangle(n, rows, columns);
  w.full = {};
  w.entry.assign(rows.size(), 0.0);
  w.value.assign(w.pattern.row.size(), 0.0);
  if (w.plain.analyse(w.pattern, deadline)) return true;
  *this = {};
  return false;
}

double* SparseSymmetric::values() { return work_->entry.data(); }

bool SparseSymmetric::pivoted() const { return work_->pivoted; }

bool SparseSymmetric::factor(const Deadline& deadline) {
  Work& w = *work_;
  w.factored = w.pivoted = w.refine = false;
  if (!std::all_of(w.entry.begin(), w.entry.end(), [](double v) { return std::isfinite(v); })) return false;
  if (w.n == 0) return w.factored = true;
  std::fill(w.value.begin(), w.value.end(), 0.0);
  for (std::size_t k = 0; k < w.entry.size(); ++k) w.value[w.pattern.slot[k]] += w.entry[k];
  w.equilibrate();
  const double roundoff = 64 * machine_epsilon * std::sqrt(double(w.n));
  const SupernodalFactor::Growth& growth = w.plain.growth();
  const bool plain =
      w.plain.factor(w.value, 0, deadline) && growth.most <= wild && growth.cancellation * roundoff < 1;
  if (!plain && deadline.passed()) return false;
  w.pivoted = !plain;
  w.refine = growth.most > mild;
  return w.factored = plain || w.factor_pivoted();
}

void SparseSymmetric::solve(double* x, int columns) {
  Work& w = *work_;
  if (!w.factored) throw std::logic_error("sparse: solve without a regular factorisation");
  const auto n = std::size_t(w.n);
  w.b.resize(n), w.r.resize(n);
  for (int c = 0; c < columns; ++c) {
    for (std::size_t i = 0; i < n; ++i) w.b[i] = w.r[i] = x[i * columns + c] * w.scale[i];
    w.solve_column(w.r.data());
    for (std::size_t i = 0; i < n; ++i) x[i * columns + c] = w.r[i] * w.scale[i];
    if (!w.refine || w.pivoted) continue;  // UMFPACK refines by itself
    w.first = w.r;
    w.multiply(w.first.data(), w.r.data());
    for (std::size_t i = 0; i < n; ++i) w.r[i] = w.b[i] - w.r[i];
    w.solve_column(w.r.data());
    for (std::size_t i = 0; i < n; ++i) x[i * columns + c] += w.r[i] * w.scale[i];
  }
}

void SparseSymmetric::solve_step(double* x) {
  Work& w = *work_;
  if (!w.factored) throw std::logic_error("sparse: solve without a regular factorisation");
  for (int i = 0; i < w.n; ++i) x[i] *= w.scale[i];
  w.solve_column(x);
  for (int i = 0; i < w.n; ++i) x[i] *= w.scale[i];
}

Inertia SparseSymmetric::inertia() {
  Work& w = *work_;
  if (!w.pivoted) return w.plain.growth().inertia;
  for (double shift = 1e-13; shift < 1e-3; shift *= 10) {
    const bool first = w.plain.factor(w.value, shift);
    const SupernodalFactor::Growth above = w.plain.growth();
    const bool trusted = first && w.plain.factor(w.value, -shift);
    const SupernodalFactor::Growth& below = w.plain.growth();
    if (!trusted || 16 * machine_epsilon * std::max(above.most, below.most) > shift) continue;
    return {below.inertia.positive, above.inertia.negative,
            w.n - below.inertia.positive - above.inertia.negative};
  }
  return {0, 0, w.n};
}

}  // namespace extremal
