#pragma once

#include <vector>

#include "action/path.hpp"
#include "problem/extension.hpp"
#include "problem/problem.hpp"

/// \file The unknowns of a problem with an extension as numbers.

namespace extremal {

/// Where elements are: each leg, from one waypoint to the next, has elements of its own, as parts of it.
struct LegMesh {
  std::vector<int> first;     ///< first element of each leg, then the number of elements
  std::vector<double> parts;  ///< length of each element by that of its leg

  int legs() const { return static_cast<int>(first.size()) - 1; }
  int elements() const { return first.back(); }
};

/// So many elements in all, those of a leg equal, in proportion to its duration.
LegMesh equal_elements(const std::vector<double>& times, int elements);
/// Each element cut into two.
LegMesh halved(const LegMesh& mesh);

/// A path of the n + u + m coordinates q, k, ν, of which k and ν are the same at all nodes; the multipliers
/// η; the times of the waypoints, then T.
struct BorderedState {
  Path path;
  LegMesh mesh;
  std::vector<double> times;
  std::vector<double> multipliers;
  double size_of_start = 0;  ///< of the path that it started from

  double leg(int l) const { return times[l] - (l > 0 ? times[l - 1] : 0); }
  /// k and ν.
  std::vector<double> constants(int n) const;
  void set_constants(int n, const std::vector<double>& values);
};

/// The lengths of the elements by T, at these times.
std::vector<double> element_lengths(const LegMesh& mesh, const std::vector<double>& times);
/// The nodes t/T, from those lengths.
std::vector<double> mesh_nodes(const std::vector<double>& lengths);

/// The largest range of one of the n coordinates. Where that is negligible beside magnitudes, or beside the
/// path that the state started from, the path rests, and its size is the largest of those.
struct PathSize {
  double value;
  bool rests;
};
PathSize path_size(const BorderedState& state, int n);

/// The elements move to other times, with the values that they have.
void move_to(BorderedState& state, const ElementTables& tables, const std::vector<double>& times);

/// The path of the n coordinates q alone, and the other way round.
void without_constants(const Path& path, const ElementTables& tables, Path& to);
void with_constants(const Path& path, const ElementTables& tables, const std::vector<double>& constants,
                    Path& to);

}  // namespace extremal
