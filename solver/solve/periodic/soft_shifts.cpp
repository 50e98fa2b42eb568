#include "solve/periodic/soft_shifts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "solve/periodic/limits.hpp"

namespace extremal {

using namespace limits::soft_shifts;

void add_soft_shifts(const Problem& problem, const Path& path, const SchemeTables& scheme,
                     PhaseConditions& phases) {
  if (!problem.lagrangian->structure().autonomous || problem.periodic || path.elements() < 2) return;
  const std::size_t n = path.coordinates(), last = path.elements();
  const std::span<const double> mesh = path.mesh();
  std::vector<double> shift(path.nodes().size(), 0), speed(last + 1, 0), direction;
  add_shift_of_time(path, scheme, shift.data());
  for (std::size_t k = 0; k <= last; ++k) {
    const double h = 0.5 * (mesh[std::min(k + 1, last)] - mesh[k > 0 ? k - 1 : 0]);
    for (std::size_t a = 0; a < n; ++a) speed[k] = std::hypot(speed[k], shift[k * n + a] / h);
  }
  const double slow = slowest * *std::max_element(speed.begin(), speed.end());
  if (!std::isfinite(slow)) return;
  // From the slowest node of a rest to that of the next.
  std::optional<std::size_t> from;
  for (std::size_t k = 0; k <= last; ++k) {
    if (speed[k] > slow) continue;
    std::size_t slowest = k;
    for (; k <= last && speed[k] <= slow; ++k)
      if (speed[k] < speed[slowest]) slowest = k;
    if (from) {
      direction.assign(shift.size(), 0);
      std::copy(shift.begin() + static_cast<std::ptrdiff_t>(*from * n),
                shift.begin() + static_cast<std::ptrdiff_t>((slowest + 1) * n),
                direction.begin() + static_cast<std::ptrdiff_t>(*from * n));
      phases.add(direction);
    }
    from = slowest;
  }
}

}  // namespace extremal
