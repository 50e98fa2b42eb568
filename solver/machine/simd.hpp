#pragma once

/// \file The instruction set that the kernels run on, chosen once at run time.

namespace extremal {

/// x86-64 micro-architecture levels that kernels are built for.
enum class SimdLevel { base, v3, v4 };

/// Doubles in a batch, whatever the level: data is laid out the same everywhere, and a narrower
/// machine takes several instructions for one batch.
inline constexpr int lanes = 8;

/// The best level of this processor, or the one that EXTREMAL_SIMD (base, v3, v4) forces.
/// Throws std::runtime_error if that names no level or one that the processor lacks.
SimdLevel simd_level();

/// "base", "v3" or "v4".
const char* name(SimdLevel level);

}  // namespace extremal
