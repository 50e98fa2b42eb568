#include "machine/simd.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace extremal {

namespace {

#define EXTREMAL_LISTED(level, ...) SimdLevel::level,
#define EXTREMAL_NAMED(level, ...) #level,
constexpr SimdLevel levels[] = {EXTREMAL_FOR_EACH_LEVEL(EXTREMAL_LISTED)};
constexpr const char* names[] = {EXTREMAL_FOR_EACH_LEVEL(EXTREMAL_NAMED)};

SimdLevel chosen_level() {
  const char* forced = std::getenv("EXTREMAL_SIMD");
  const bool free = !forced || !*forced;
  SimdLevel best = levels[0];
  std::string choice;
  for (const SimdLevel level : levels) {
    if (!available(level)) continue;
    if (!free && std::string(forced) == name(level)) return level;
    choice += (choice.empty() ? "" : ", ") + std::string(name(level));
    best = level;
  }
  if (free) return best;
  throw std::runtime_error("EXTREMAL_SIMD=" + std::string(forced) + ": this processor has " + choice);
}

}  // namespace

bool available(SimdLevel level) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl");
  return level == SimdLevel::v4 ? v4 : level == SimdLevel::v3 ? v3 : true;
#else
  return level == SimdLevel::neon;  // part of every 64-bit Arm
#endif
}

int lanes_of(SimdLevel level) {
#if defined(__x86_64__)
  return level == SimdLevel::v4 ? 8 : level == SimdLevel::v3 ? 4 : 2;
#else
  return level == SimdLevel::neon ? 2 : 1;
#endif
}

int simd_lanes() {
  static const int lanes = lanes_of(simd_level());
  return lanes;
}

SimdLevel simd_level() {
  static const SimdLevel level = chosen_level();
  return level;
}

const char* name(SimdLevel level) { return names[static_cast<int>(level)]; }

}  // namespace extremal
