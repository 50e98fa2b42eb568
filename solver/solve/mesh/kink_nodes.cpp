#include "solve/mesh/kink_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "action/corners.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/mesh/mesh.hpp"

namespace extremal {

namespace {

/// Crossings at which elements end, all in t/T. A closed path may cross inside an element before `first` and
/// after `last`: half as far from T as the first quadrature point, and no farther than `beside`. Elements
/// between T and that crossing do not count, nor does one that ends there: the crossing may pass T, and would
/// shorten them to nothing.
struct Crossed {
  std::vector<double> times;
  double first = 0, last = 1;
};

Crossed crossed_by(const ElementTables& tables, const Path& path, bool closed, double beside) {
  Crossed found{crossings(*tables.kinks(), path)};
  if (!closed || found.times.empty()) return found;
  const std::span<const double> mesh = path.mesh();
  const int end = path.elements();
  const auto at_node = [&](int k, double t) {
    const double shorter = std::min(mesh[k] - mesh[k - 1], mesh[k + 1] - mesh[k]);
    return std::abs(t - mesh[k]) < limits::kinks::at_node * shorter;
  };
  int after = 1, before = end - 1;
  while (after < before && (mesh[after] < found.times.front() || at_node(after, found.times.front())))
    ++after;
  while (before > after && (mesh[before] > found.times.back() || at_node(before, found.times.back())))
    --before;
  const double part = 0.5 * tables.scheme().node[0];
  found.first = std::min(part * mesh[after], beside);
  found.last = 1 - std::min(part * (1 - mesh[before]), beside);
  std::erase_if(found.times, [&](double t) { return t < found.first || t > found.last; });
  return found;
}

}  // namespace

std::vector<double> kink_times(const ElementTables& tables, const Path& path, bool closed, double beside) {
  if (!tables.kinks()) return {};
  return crossed_by(tables, path, closed, beside).times;
}

double least_beside_closing(int degree, double tolerance) {
  using namespace limits::kinks;
  return std::max({tolerance, least_misplacement, slope_roundoff * degree * degree / tolerance});
}

std::optional<std::vector<double>> mesh_to_kinks(const ElementTables& tables, const Path& path, bool closed,
                                                 double tolerance, double beside) {
  if (!tables.kinks()) return std::nullopt;
  const auto [times, first, last] = crossed_by(tables, path, closed, beside);
  std::vector<double> mesh;
  for (const double t : path.mesh())
    if (t == 0 || t == 1 || (t > first && t < last)) mesh.push_back(t);
  const double most = std::max(tolerance, limits::kinks::least_misplacement);
  const bool fewer = std::ssize(mesh) <= path.elements();
  if (!fewer && distance_to_nodes(mesh, times) <= most) return std::nullopt;
  return with_nodes(mesh, times);
}

}  // namespace extremal
