#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "linear/chain.hpp"
#include "linear/sparse.hpp"
#include "machine/simd.hpp"

// Block-tridiagonal systems: times of factorisation and solve, medians, on one core.

using namespace extremal;

#ifdef EXTREMAL_HAS_LAPACK
extern "C" {
void dgbtrf_(const int* m, const int* n, const int* kl, const int* ku, double* ab, const int* ldab,
             int* pivots, int* info);
void dgbtrs_(const char* trans, const int* n, const int* kl, const int* ku, const int* nrhs, const double* ab,
             const int* ldab, const int* pivots, double* b, const int* ldb, int* info, std::size_t length);
}
#endif

namespace {

/// Median processor seconds of one call, in about `budget` seconds altogether.
template <class Call>
double median(const Call& call, double budget = 0.03) {
  const auto now = [] {  // of this process, so that its neighbours do not count
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  const auto seconds = [&](int calls) {
    const double start = now();
    for (int i = 0; i < calls; ++i) call();
    return now() - start;
  };
  seconds(1);
  const int samples = 9;
  const int calls = std::max(1, int(budget / samples / std::max(seconds(1), 1e-9)));
  std::vector<double> times(samples);
  for (double& t : times) t = seconds(calls) / calls;
  std::nth_element(times.begin(), times.begin() + samples / 2, times.end());
  return times[samples / 2];
}

/// Random blocks; indefinite, but no pivot is small.
void fill(Chain& a, int blocks, int n) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  a.resize(blocks, n);
  for (int k = 0; k < blocks; ++k) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j)
        a.diagonal(k)[i * n + j] = a.diagonal(k)[j * n + i] =
            normal(engine) + (i == j ? 6 * std::sqrt(n) : 0);
    for (int i = 0; i < n * n && k + 1 < blocks; ++i) a.lower(k)[i] = normal(engine);
  }
}

struct Times {
  double factor, solve;
};

Times chain_times(Chain& a) {
  std::vector<double> b(a.order(), 1.0), x = b;
  const double factor = median([&] { a.factor(); });
  const double solve = median([&] {
    std::copy(b.begin(), b.end(), x.begin());
    a.solve(x.data(), 1);
  });
  return {factor, solve};
}

Times sparse_times(const Chain& a) {
  std::vector<int> rows, columns;
  std::vector<double> values;
  const int n = a.size();
  for (int k = 0; k < a.blocks(); ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (j <= i)
          rows.push_back(k * n + i), columns.push_back(k * n + j), values.push_back(a.diagonal(k)[i * n + j]);
        if (k + 1 < a.blocks())
          rows.push_back((k + 1) * n + i), columns.push_back(k * n + j),
              values.push_back(a.lower(k)[i * n + j]);
      }
  SparseSymmetric sparse;
  sparse.pattern(a.order(), rows, columns);
  std::copy(values.begin(), values.end(), sparse.values());
  std::vector<double> b(a.order(), 1.0), x = b;
  const double factor = median([&] { sparse.factor(); });
  const double solve = median([&] {
    std::copy(b.begin(), b.end(), x.begin());
    sparse.solve(x.data(), 1);
  });
  return {factor, solve};
}

#ifdef EXTREMAL_HAS_LAPACK
Times banded_times(const Chain& a) {
  const int n = a.size(), order = a.order(), band = 2 * n - 1, stride = 3 * band + 1, one = 1;
  std::vector<double> matrix(std::size_t(stride) * order, 0.0), factors = matrix, b(order, 1.0), x = b;
  const auto set = [&](int i, int j, double v) { matrix[std::size_t(j) * stride + 2 * band + i - j] = v; };
  for (int k = 0; k < a.blocks(); ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        set(k * n + i, k * n + j, a.diagonal(k)[i * n + j]);
        if (k + 1 == a.blocks()) continue;
        set((k + 1) * n + i, k * n + j, a.lower(k)[i * n + j]);
        set(k * n + j, (k + 1) * n + i, a.lower(k)[i * n + j]);
      }
  std::vector<int> pivots(order);
  int info = 0;
  const double factor = median([&] {
    factors = matrix;
    dgbtrf_(&order, &order, &band, &band, factors.data(), &stride, pivots.data(), &info);
  });
  const double solve = median([&] {
    x = b;
    dgbtrs_("N", &order, &band, &band, &one, factors.data(), &stride, pivots.data(), x.data(), &order, &info,
            1);
  });
  return {factor, solve};
}
#endif

std::string cell(const Times& t) { return fmt::format("{:.0f} + {:.0f}", 1e6 * t.factor, 1e6 * t.solve); }

void large_table() {
  fmt::print("1000 blocks, microseconds: factor + solve of one right-hand side\n\n");
  fmt::print("| b | chain | chosen pivots, refined | CHOLMOD LDLt | LAPACK banded LU |\n");
  fmt::print("| --- | --- | --- | --- | --- |\n");
  for (int n : {1, 2, 3, 6, 12, 18, 36}) {
    Chain a, singular;
    fill(a, 1000, n);
    fill(singular, 1000, n);
    std::fill_n(singular.diagonal(0), n * n, 0.0);
    std::string banded = "not installed";
#ifdef EXTREMAL_HAS_LAPACK
    banded = cell(banded_times(a));
#endif
    fmt::print("| {} | {} | {} | {} | {} |\n", n, cell(chain_times(a)), cell(chain_times(singular)),
               cell(sparse_times(a)), banded);
  }
}

void small_table() {
  fmt::print("\nFew blocks, nanoseconds a block: factor + solve of one right-hand side\n\n");
  fmt::print("| b | 7 blocks | 15 | 31 | 100 |\n| --- | --- | --- | --- | --- |\n");
  for (int n : {1, 2, 3, 4, 6}) {
    fmt::print("| {} |", n);
    for (int blocks : {7, 15, 31, 100}) {
      Chain a;
      fill(a, blocks, n);
      const Times t = chain_times(a);
      fmt::print(" {:.1f} + {:.1f} |", 1e9 * t.factor / blocks, 1e9 * t.solve / blocks);
    }
    fmt::print("\n");
  }
}

}  // namespace

int main() {
  fmt::print("instruction set {}\n\n", name(simd_level()));
  large_table();
  small_table();
}
