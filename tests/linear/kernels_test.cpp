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
  std::vector<Family> families = {base::small_chain, base::large_chain};
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v3"))
    families.insert(families.end(), {v3::small_chain, v3::large_chain});
  if (__builtin_cpu_supports("x86-64-v4"))
    families.insert(families.end(), {v4::small_chain, v4::large_chain});
  for (Family family : families)
    for (int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 33})
      if (const ChainKernels kernels = family(n); kernels.factor)
        for (int blocks : {1, 2, 3, 4, 9}) expect_kernel(kernels, blocks, n);
}

}  // namespace
}  // namespace extremal
