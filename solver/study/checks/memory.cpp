#include "study/checks/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "action/tables.hpp"
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

double solve_bytes(const Structure& structure, int elements, int degree) {
  const int lanes = simd_lanes();
  const double n = structure.coordinates, functions = degree + 1, unknowns = functions * n;
  const double batches = std::ceil(double(elements) / lanes);
  const double rows = (1.0 + structure.gradient.size() + structure.hessian.size()) * functions * lanes;
  if (unknowns <= most_dense_unknowns)
    return sizeof(double) * (batches * lanes * unknowns * unknowns + 4.0 * (elements + 1) * n * n + rows);
  // Sparse: each entry's place, value and source, and factors some times larger.
  const double entries = (structure.mass.size() + structure.hessian.size()) * functions * functions;
  return sizeof(double) * (16 * elements * entries + rows);
}

double march_bytes(int coordinates, int elements, int degree) {
  return 4.0 * sizeof(double) * elements * (degree + 1.0) * coordinates;
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
