#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include "linear/border.hpp"
#include "linear/sparse.hpp"
#include "machine/sanitizer.hpp"
#include "oracle.hpp"

namespace {
std::atomic<long> allocations{0};
}

// Counts what the program takes from the heap by operator new or, as Eigen does, by malloc. A sanitizer
// has a malloc of its own.
#if !EXTREMAL_ADDRESS_SANITIZER
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace extremal {
namespace {

TEST(Allocation, NoneInFactorAndSolveOnceWarm) {
#if EXTREMAL_ADDRESS_SANITIZER
  GTEST_SKIP() << "the sanitizer counts instead";
#endif
  dense::Random random(1);
  Chain chain;
  Border border;
  for (int n : {1, 2, 3, 6, 7, 12}) {
    const auto run = [&](int blocks) {
      chain.resize(blocks, n);
      std::fill_n(chain.lower(0), blocks * n * n, 0.25);
      for (int k = 0; k < blocks; ++k)
        for (int i = 0; i < n * n; ++i) chain.diagonal(k)[i] = i % (n + 1) ? 0.5 : 9.0 * n;
      border.resize(chain.order(), 2);
      for (int i = 0; i < 2 * chain.order(); ++i) border.column_block()[i] = i % 7 - i % 2;
      std::fill_n(border.corner(), 4, 0.0);
      double x[602];
      std::fill_n(x, 602, 1.0);
      const long before = allocations;
      EXPECT_TRUE(chain.factor());
      chain.solve(x, 1);
      EXPECT_TRUE(border.factor(chain));
      border.solve(chain, x, 1);
      return allocations - before;
    };
    EXPECT_GT(run(25), 0) << "the counter does not count";
    EXPECT_EQ(run(25), 0) << n;
  }
}

TEST(Allocation, NoneInSparseFactorAndSolveOnceWarm) {
#if EXTREMAL_ADDRESS_SANITIZER
  GTEST_SKIP() << "the sanitizer counts instead";
#endif
  dense::Random random(2);
  const int n = 400;
  std::vector<int> rows, columns;
  for (int i = 0; i < n; ++i)
    for (int k : {0, 1, 20})
      if (i + k < n) rows.push_back(i + k), columns.push_back(i);
  SparseSymmetric a;
  a.pattern(n, rows, columns);
  std::vector<double> x(n, 1.0);
  const auto run = [&] {
    for (std::size_t k = 0; k < rows.size(); ++k) a.values()[k] = random();
    const long before = allocations;
    EXPECT_TRUE(a.factor());
    a.solve(x.data(), 1);
    return allocations - before;
  };
  EXPECT_GT(run(), 0) << "the counter does not count";
  EXPECT_EQ(run(), 0);
}

}  // namespace
}  // namespace extremal
