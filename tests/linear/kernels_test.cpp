#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "linear/chain_kernels.hpp"
#include "machine/simd.hpp"
#include "oracle.hpp"

namespace extremal {
namespace {

using dense::Matrix;

/// Small and large kernels of every level that this processor has, against the dense matrix.
void expect_kernel(const ChainKernels& kernels, int blocks, int n) {
  dense::Random random(n);
  Chain a;
  a.resize(blocks, n);
  random.fill(a, -6 * std::sqrt(n));
  AlignedDoubles memory(blocks * kernels.stage + kernels.work);
  ChainMonitor monitor;
  kernels.factor(a.diagonal(0), a.lower(0), blocks, n, memory.data(), &monitor);
  EXPECT_EQ(monitor.negative, n * blocks);
  EXPECT_EQ(monitor.positive, 0);
  EXPECT_LE(monitor.growth, 0);
  for (int columns = 1; columns <= 17; ++columns) {
    const Matrix b = random.matrix(n * blocks, columns);
    Matrix x = b;
    kernels.solve(memory.data(), blocks, n, x.data(), columns);
    EXPECT_LE(dense::backward_error(dense::matrix(a), x, b), 4 * std::numeric_limits<double>::epsilon())
        << n << ' ' << blocks << ' ' << columns;
  }
}

TEST(Kernels, EveryLevelAgreesWithDense) {
  using Family = ChainKernels (*)(int);
  const Family small[] = EXTREMAL_AT_EACH_LEVEL(small_chain), large[] = EXTREMAL_AT_EACH_LEVEL(large_chain);
  for (std::size_t level = 0; level < std::size(small); ++level) {
    if (!available(static_cast<SimdLevel>(level))) continue;
    for (const Family family : {small[level], large[level]})
      for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 33})
        if (const ChainKernels kernels = family(n); kernels.factor)
          for (const int blocks : {1, 2, 3, 4, 9}) expect_kernel(kernels, blocks, n);
  }
}

}  // namespace
}  // namespace extremal
