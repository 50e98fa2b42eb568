#pragma once

#include <cstddef>

#include "machine/simd.hpp"

/// \file What the kernels of the chain and chain.cpp agree on. Kernels are built once for each
/// instruction set, so nothing here is inline.

namespace extremal {

/// What a factorisation without pivoting tells about itself, gathered on the way.
struct ChainMonitor {
  double scale;         ///< Sum of the absolute entries: not finite if an entry is not
  double growth;        ///< Σ w²/|d| on the diagonal of a block less `mild` × its scale: largest excess
  double wild;          ///< The same less `wild` × its scale
  double cancellation;  ///< Largest (|a_ii| + Σ w²/|d|) / |d_i|: its inverse times roundoff is a sign lost
  int positive, negative;
};

/// Growth beyond which solutions are refined, and beyond which the pivots need choosing.
inline constexpr double mild_growth = 16, wild_growth = 1e3;

/// LDLᵀ without pivoting of a block-tridiagonal matrix and the solve with it. The layout of the factor is
/// the kernel's own: `stage` doubles for each block, then `work` more, from a multiple of 64 bytes on.
struct ChainKernels {
  void (*factor)(const double* diagonal, const double* lower, int blocks, int size, double* factor,
                 ChainMonitor* monitor);
  void (*solve)(const double* factor, int blocks, int size, double* x, int columns);
  std::size_t stage, work;
};

// small_chain: sizes that are worth a kernel of their own, null pointers for the others.
EXTREMAL_DECLARE_AT_EACH_LEVEL(ChainKernels small_chain(int size))
EXTREMAL_DECLARE_AT_EACH_LEVEL(ChainKernels large_chain(int size))

}  // namespace extremal
