#pragma once

/// \file The instruction sets that kernels are built for, and the one in use, chosen once at run time.
/// Kernels include this: nothing here defines a symbol.

/// Levels of this architecture, the most capable last. Each is a namespace that kernels are compiled in.
#if defined(__x86_64__)
#define EXTREMAL_FOR_EACH_LEVEL(use, ...) use(base, __VA_ARGS__) use(v3, __VA_ARGS__) use(v4, __VA_ARGS__)
#elif defined(__aarch64__)
#define EXTREMAL_FOR_EACH_LEVEL(use, ...) use(neon, __VA_ARGS__)
#else
#error "Kernels are built for x86-64 and 64-bit Arm"
#endif

#define EXTREMAL_DECLARE(level, ...) \
  namespace level {                  \
  __VA_ARGS__;                       \
  }
#define EXTREMAL_QUALIFY(level, entry) level::entry,
#define EXTREMAL_ENUMERATOR(level, ...) level,

/// Declares a function of kernels in the namespace of each level.
#define EXTREMAL_DECLARE_AT_EACH_LEVEL(...) EXTREMAL_FOR_EACH_LEVEL(EXTREMAL_DECLARE, __VA_ARGS__)
/// {base::entry, v3::entry, …}, for at_simd_level().
#define EXTREMAL_AT_EACH_LEVEL(entry) \
  { EXTREMAL_FOR_EACH_LEVEL(EXTREMAL_QUALIFY, entry) }

namespace extremal {

/// x86-64, x86-64-v3 (AVX2) and x86-64-v4 (AVX-512), or NEON.
enum class SimdLevel { EXTREMAL_FOR_EACH_LEVEL(EXTREMAL_ENUMERATOR) };

/// Doubles in a register of the widest level. Meshes have multiples of as many elements at every level, so
/// that the mesh, and with it the result, does not depend on the level but for roundoff.
inline constexpr int most_lanes = 8;

/// The best level of this processor, or the one that EXTREMAL_SIMD forces by name.
/// Throws std::runtime_error if that names no level that the processor has.
SimdLevel simd_level();

/// Doubles in a register of a level.
int lanes_of(SimdLevel level);

/// Doubles in a register of the level in use. Elements and points are evaluated in batches of as many, one in
/// each lane.
int simd_lanes();

/// Whether this processor has it.
bool available(SimdLevel level);

/// As EXTREMAL_SIMD names it.
const char* name(SimdLevel level);

/// The entry of the level in use.
template <class Entry, unsigned count>
Entry at_simd_level(const Entry (&entries)[count]) {
  return entries[static_cast<int>(simd_level())];
}

}  // namespace extremal
