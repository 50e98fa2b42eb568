#include "study/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "machine/simd.hpp"

namespace extremal {
namespace {

/// The number in a file of the kernel; infinity where there is none ("max").
double limit_in(const char* path) {
  std::ifstream file(path);
  double value;
  return file >> value ? value : INFINITY;
}

}  // namespace

double solve_bytes(int coordinates, int elements, int degree) {
  const double n = coordinates, unknowns = (degree + 1) * n, batches = std::ceil(double(elements) / lanes);
  const double matrices = batches * lanes * unknowns * unknowns, chain = 4.0 * (elements + 1) * n * n;
  return sizeof(double) * (matrices + chain);
}

double available_bytes() {
  double bytes = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    bytes = std::min(bytes, double(limit.rlim_cur));
  bytes = std::min(bytes, limit_in("/sys/fs/cgroup/memory.max"));
  return std::min(bytes, limit_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
}

std::string byte_text(double bytes) {
  const char* const units[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
  std::size_t k = 0;
  for (; bytes >= 1000 && k + 1 < std::size(units); ++k) bytes /= 1000;
  return fmt::format("{:.3g} {}", bytes, units[k]);
}

}  // namespace extremal
