#include "solve/bordered/state.hpp"

#include <algorithm>
#include <cmath>

#include "solve/bordered/limits.hpp"

namespace extremal {

std::vector<double> BorderedState::constants(int n) const {
  return {path.node(0) + n, path.node(0) + path.coordinates()};
}

void BorderedState::set_constants(int n, const std::vector<double>& values) {
  for (int k = 0; k <= path.elements(); ++k)
    for (std::size_t j = 0; j < values.size(); ++j) path.set_node(k, n + static_cast<int>(j), values[j]);
  path.load_ends();
}

LegMesh equal_elements(const std::vector<double>& times, int elements) {
  LegMesh mesh;
  mesh.first.push_back(0);
  const int legs = static_cast<int>(times.size());
  for (int l = 0; l < legs; ++l) {
    const double share = (times[l] - (l > 0 ? times[l - 1] : 0)) / times.back();
    const int left = elements - mesh.first.back() - (legs - l - 1);
    const int count = l + 1 == legs
                          ? std::max(1, left)
                          : std::clamp(static_cast<int>(std::lround(share * elements)), 1, std::max(1, left));
    for (int k = 0; k < count; ++k) mesh.parts.push_back(1.0 / count);
    mesh.first.push_back(mesh.first.back() + count);
  }
  return mesh;
}

LegMesh halved(const LegMesh& mesh) {
  LegMesh result;
  for (const int first : mesh.first) result.first.push_back(2 * first);
  for (const double part : mesh.parts) result.parts.insert(result.parts.end(), 2, part / 2);
  return result;
}

PathSize path_size(const BorderedState& state, int n) {
  const Path& path = state.path;
  const int all = path.coordinates();
  std::vector<double> q(static_cast<std::size_t>(path.degree() + 1) * all);
  std::vector<double> low(path.node(0), path.node(0) + n), high = low;
  for (int k = 0; k < path.elements(); ++k) {
    path.element(k, q.data());
    for (int j = 0; j <= path.degree(); ++j)
      for (int a = 0; a < n; ++a) {
        const double x = q[static_cast<std::size_t>(j) * all + a];
        low[a] = std::min(low[a], x);
        high[a] = std::max(high[a], x);
      }
  }
  double range = 0, magnitude = state.size_of_start;
  for (int a = 0; a < n; ++a) {
    range = std::max(range, high[a] - low[a]);
    magnitude = std::max({magnitude, std::abs(low[a]), std::abs(high[a])});
  }
  if (range > limits::bordered::resting * magnitude) return {range, false};
  return {magnitude > 0 ? magnitude : 1, true};
}

std::vector<double> element_lengths(const LegMesh& mesh, const std::vector<double>& times) {
  std::vector<double> lengths(mesh.parts);
  for (int l = 0; l < mesh.legs(); ++l) {
    const double share = (times[l] - (l > 0 ? times[l - 1] : 0)) / times.back();
    for (int k = mesh.first[l]; k < mesh.first[l + 1]; ++k) lengths[k] *= share;
  }
  return lengths;
}

std::vector<double> mesh_nodes(const std::vector<double>& lengths) {
  std::vector<double> nodes{0};
  for (const double length : lengths) nodes.push_back(nodes.back() + length);
  nodes.back() = 1;
  return nodes;
}

void move_to(BorderedState& state, const ElementTables& tables, const std::vector<double>& times) {
  if (times == state.times) return;
  const std::vector<double> lengths = element_lengths(state.mesh, times);
  Path moved;
  moved.reset(tables, mesh_nodes(lengths), times.back(), lengths);
  moved.copy_values(state.path);
  moved.set_duration(times.back());
  state.path = std::move(moved);
  state.times = times;
}

namespace {

/// The first coordinates of one path into another on the same elements.
void copy_coordinates(const Path& path, int count, Path& to) {
  const int from_n = path.coordinates(), to_n = to.coordinates(), lanes = path.lanes();
  for (int k = 0; k <= path.elements(); ++k)
    for (int a = 0; a < count; ++a) to.set_node(k, a, path.node(k)[a], path.rest(k)[a]);
  for (int b = 0; b < path.batches(); ++b)
    for (int j = 0; j + 1 < path.degree(); ++j)
      for (int a = 0; a < count; ++a)
        std::copy_n(path.x(b) + static_cast<std::ptrdiff_t>(j * from_n + a) * lanes, lanes,
                    to.x(b) + static_cast<std::ptrdiff_t>(j * to_n + a) * lanes);
}

}  // namespace

void without_constants(const Path& path, const ElementTables& tables, Path& to) {
  to.reset(tables, path.mesh(), path.duration(), path.lengths());
  copy_coordinates(path, tables.coordinates(), to);
  to.load_ends();
}

void with_constants(const Path& path, const ElementTables& tables, const std::vector<double>& constants,
                    Path& to) {
  to.reset(tables, path.mesh(), path.duration(), path.lengths());
  const int n = path.coordinates();
  copy_coordinates(path, n, to);
  for (int k = 0; k <= path.elements(); ++k)
    for (std::size_t j = 0; j < constants.size(); ++j) to.set_node(k, n + static_cast<int>(j), constants[j]);
  to.load_ends();
}

}  // namespace extremal
