#include "solve/mesh/kink_nodes.hpp"

#include <algorithm>

#include "action/corners.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/mesh/mesh.hpp"

namespace extremal {

std::vector<double> kink_times(const ElementTables& tables, const Path& path, bool closed) {
  if (!tables.kinks()) return {};
  std::vector<double> times = crossings(*tables.kinks(), path);
  if (closed) {
    const double gap = 0.5 * tables.scheme().node[0];
    const double first = gap * path.lengths().front(), last = gap * path.lengths().back();
    std::erase_if(times, [&](double t) { return t < first || t > 1 - last; });
  }
  return times;
}

std::optional<std::vector<double>> mesh_to_kinks(const ElementTables& tables, const Path& path, bool closed,
                                                 double tolerance) {
  const std::vector<double> times = kink_times(tables, path, closed);
  const double most = std::max(tolerance, limits::kinks::least_misplacement);
  if (distance_to_nodes(path.mesh(), times) <= most) return std::nullopt;
  return with_nodes(path.mesh(), times);
}

}  // namespace extremal
