#include "machine/simd.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace extremal {

namespace {

SimdLevel best_level() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4")) return SimdLevel::v4;
  if (__builtin_cpu_supports("x86-64-v3")) return SimdLevel::v3;
  return SimdLevel::base;
}

SimdLevel chosen_level() {
  const SimdLevel best = best_level();
  const char* forced = std::getenv("EXTREMAL_SIMD");
  if (!forced || !*forced) return best;
  for (SimdLevel level : {SimdLevel::base, SimdLevel::v3, SimdLevel::v4}) {
    if (std::string(forced) != name(level)) continue;
    if (level > best)
      throw std::runtime_error("EXTREMAL_SIMD=" + std::string(forced) + ": this processor has only " +
                               name(best));
    return level;
  }
  throw std::runtime_error("EXTREMAL_SIMD=" + std::string(forced) + ": use base, v3 or v4");
}

}  // namespace

SimdLevel simd_level() {
  static const SimdLevel level = chosen_level();
  return level;
}

const char* name(SimdLevel level) {
  switch (level) {
    case SimdLevel::base: return "base";
    case SimdLevel::v3: return "v3";
    default: return "v4";
  }
}

}  // namespace extremal
