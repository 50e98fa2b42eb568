#include "linear/sparse.hpp"

#include <cholmod.h>
#include <fmt/core.h>
#include <umfpack.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

#include "linear/chain_kernels.hpp"
#include "linear/sparse_pattern.hpp"

namespace extremal {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

}  // namespace

struct SparseSymmetric::Work {
  struct Growth {
    double most = 0;          ///< Σ l²|d|, largest over the rows
    double cancellation = 0;  ///< (|a_ii| + Σ l²|d|) / |d_i|, largest
    Inertia inertia;
  };

  int n = 0;
  bool factored = false, pivoted = false, refine = false;
  cholmod_common common;
  cholmod_sparse lower = {};  // A scaled, in compressed columns
  cholmod_factor* factor = nullptr;
  SparsePattern pattern, full;  // the lower triangle, and for UMFPACK both
  std::vector<double> entry, value, scale;
  std::vector<double> full_value, x, b, r;
  void* symbolic = nullptr;
  void* numeric = nullptr;
  Growth growth;

  Work();
  ~Work();
  Work(const Work&) = delete;
  void clear();
  void equilibrate();
  bool factor_plain(double shift, Growth& result);
  bool factor_pivoted();
  void solve_column(double* x);
  void multiply(const double* x, double* y) const;
};

SparseSymmetric::Work::Work() {
  cholmod_start(&common);
  common.print = 0;
  common.error_handler = nullptr;
  common.supernodal = CHOLMOD_SIMPLICIAL;
  common.final_ll = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  common.postorder = 1;
}

SparseSymmetric::Work::~Work() {
  clear();
  cholmod_finish(&common);
}

void SparseSymmetric::Work::clear() {
  if (factor) cholmod_free_factor(&factor, &common);
  if (symbolic) umfpack_di_free_symbolic(&symbolic);
  if (numeric) umfpack_di_free_numeric(&numeric);
  factored = false;
}

/// Scales by powers of two (Ruiz, as for the chain).
void SparseSymmetric::Work::equilibrate() {
  const int sweeps = 3;
  scale.assign(n, 1.0);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    x.assign(n, 0.0);
    for (int j = 0; j < n; ++j)
      for (int p = pattern.begin[j]; p < pattern.begin[j + 1]; ++p) {
        const double size = std::abs(value[p]) * scale[j] * scale[pattern.row[p]];
        x[j] = std::max(x[j], size);
        x[pattern.row[p]] = std::max(x[pattern.row[p]], size);
      }
    for (int i = 0; i < n; ++i)
      if (x[i] > 0) scale[i] = std::ldexp(scale[i], -(std::ilogb(x[i]) / 2));
  }
  for (int j = 0; j < n; ++j)
    for (int p = pattern.begin[j]; p < pattern.begin[j + 1]; ++p)
      value[p] *= scale[j] * scale[pattern.row[p]];
}

/// LDLᵀ of A + shift I. False where a pivot is zero or not finite.
bool SparseSymmetric::Work::factor_plain(double shift, Growth& result) {
  result = {};
  double beta[2] = {shift, 0};
  cholmod_factorize_p(&lower, beta, nullptr, 0, factor, &common);
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (common.status < 0 || factor->xtype != CHOLMOD_REAL || factor->minor < std::size_t(n)) return false;
  const int* const p = static_cast<const int*>(factor->p);
  const int* const i = static_cast<const int*>(factor->i);
  const int* const count = static_cast<const int*>(factor->nz);
  const int* const order = static_cast<const int*>(factor->Perm);
  const double* const l = static_cast<const double*>(factor->x);
  x.assign(n, 0.0);  // Σ l²|d|
  for (int j = 0; j < n; ++j) {
    const double d = l[p[j]];
    const double size = std::abs(value[pattern.begin[order[j]]] + shift);
    ++(d > 0 ? result.inertia.positive : d < 0 ? result.inertia.negative : result.inertia.zero);
    result.most = std::max(result.most, x[j]);
    const double lost = (size + x[j]) / std::abs(d);
    if (!(lost <= result.cancellation)) result.cancellation = lost;
    for (int k = p[j] + 1; k < p[j] + count[j]; ++k) x[i[k]] += l[k] * l[k] * std::abs(d);
  }
  return std::isfinite(result.most) && std::isfinite(result.cancellation) && result.inertia.zero == 0;
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
  return status == UMFPACK_OK && info[UMFPACK_RCOND] > eps;
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
  const int* const p = static_cast<const int*>(factor->p);
  const int* const i = static_cast<const int*>(factor->i);
  const int* const count = static_cast<const int*>(factor->nz);
  const int* const order = static_cast<const int*>(factor->Perm);
  const double* const l = static_cast<const double*>(factor->x);
  x.resize(n);
  for (int j = 0; j < n; ++j) x[j] = y[order[j]];
  for (int j = 0; j < n; ++j)
    for (int k = p[j] + 1; k < p[j] + count[j]; ++k) x[i[k]] -= l[k] * x[j];
  for (int j = n - 1; j >= 0; --j) {
    x[j] /= l[p[j]];
    for (int k = p[j] + 1; k < p[j] + count[j]; ++k) x[j] -= l[k] * x[i[k]];
  }
  for (int j = 0; j < n; ++j) y[order[j]] = x[j];
}

SparseSymmetric::SparseSymmetric() : work_(std::make_unique<Work>()) {}
SparseSymmetric::~SparseSymmetric() = default;
SparseSymmetric::SparseSymmetric(SparseSymmetric&&) noexcept = default;
SparseSymmetric& SparseSymmetric::operator=(SparseSymmetric&&) noexcept = default;

void SparseSymmetric::pattern(int n, std::span<const int> rows, std::span<const int> columns) {
  if (n < 0 || rows.size() != columns.size())
    throw std::invalid_argument(fmt::format("sparse: order {} with {} rows and {} columns of entries", n,
                                            rows.size(), columns.size()));
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (std::min(rows[k], columns[k]) < 0 || std::max(rows[k], columns[k]) >= n)
      throw std::invalid_argument(
          fmt::format("sparse: entry {} at ({}, {}) of order {}", k, rows[k], columns[k], n));
  Work& w = *work_;
  w.clear();
  w.n = n;
  w.pattern = lower_triangle(n, rows, columns);
  w.full = {};
  w.entry.assign(rows.size(), 0.0);
  w.value.assign(w.pattern.row.size(), 0.0);
  w.lower = {};
  w.lower.nrow = w.lower.ncol = n;
  w.lower.nzmax = w.pattern.row.size();
  w.lower.p = w.pattern.begin.data();
  w.lower.i = w.pattern.row.data();
  w.lower.x = w.value.data();
  w.lower.stype = -1;
  w.lower.itype = CHOLMOD_INT;
  w.lower.xtype = CHOLMOD_REAL;
  w.lower.dtype = CHOLMOD_DOUBLE;
  w.lower.sorted = w.lower.packed = 1;
  if (n > 0 && !(w.factor = cholmod_analyze(&w.lower, &w.common))) throw std::bad_alloc();
}

double* SparseSymmetric::values() { return work_->entry.data(); }

bool SparseSymmetric::pivoted() const { return work_->pivoted; }

bool SparseSymmetric::factor() {
  Work& w = *work_;
  w.factored = w.pivoted = w.refine = false;
  w.growth = {};
  if (!std::all_of(w.entry.begin(), w.entry.end(), [](double v) { return std::isfinite(v); })) return false;
  if (w.n == 0) return w.factored = true;
  std::fill(w.value.begin(), w.value.end(), 0.0);
  for (std::size_t k = 0; k < w.entry.size(); ++k) w.value[w.pattern.slot[k]] += w.entry[k];
  w.equilibrate();
  const double roundoff = 64 * eps * std::sqrt(double(w.n));
  const bool plain =
      w.factor_plain(0, w.growth) && w.growth.most <= wild_growth && w.growth.cancellation * roundoff < 1;
  w.pivoted = !plain;
  w.refine = w.growth.most > mild_growth;
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
    const std::vector<double> first = w.r;
    w.multiply(first.data(), w.r.data());
    for (std::size_t i = 0; i < n; ++i) w.r[i] = w.b[i] - w.r[i];
    w.solve_column(w.r.data());
    for (std::size_t i = 0; i < n; ++i) x[i * columns + c] += w.r[i] * w.scale[i];
  }
}

Inertia SparseSymmetric::inertia() {
  Work& w = *work_;
  if (!w.pivoted) return w.growth.inertia;
  Work::Growth above, below;
  for (double shift = 1e-13; shift < 1e-3; shift *= 10) {
    const bool trusted = w.factor_plain(shift, above) && w.factor_plain(-shift, below);
    if (!trusted || 16 * eps * std::max(above.most, below.most) > shift) continue;
    return {below.inertia.positive, above.inertia.negative,
            w.n - below.inertia.positive - above.inertia.negative};
  }
  return {0, 0, w.n};
}

}  // namespace extremal
