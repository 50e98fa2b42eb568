#pragma once

#include <vector>

#include "action/element.hpp"

/// \file In which order the inner unknowns of an element are eliminated, coordinate by coordinate, so that
/// few of them fill in. A chain, a lattice or a tree of particles couples each coordinate with few others;
/// where all are coupled there is nothing to choose, and all are eliminated together.

namespace extremal {

/// How the inner unknowns of two coordinates meet in the Hessian of an element.
enum class Coupling : char {
  none,
  nodes,  ///< those of the same node only: a potential, integrated by the rule of the nodes
  full,
};

/// n × n both.
struct CoordinateGraph {
  int n = 0;
  std::vector<Coupling> inner;  ///< symmetric, the diagonal unused
  std::vector<char> ends;       ///< whether inner unknowns of a (row) meet the ends of b (column)
};

CoordinateGraph coordinate_graph(const ElementShape& shape);

/// Coordinates whose inner unknowns are eliminated together, what those couple with then, and for each of
/// these the first of the pivots that it is coupled with.
struct PivotGroup {
  struct Coupled {
    int coordinate, first;
    Coupling coupling;
  };
  std::vector<int> pivots;
  std::vector<Coupled> inner, ends;  ///< inner: in the order of their elimination; ends: ascending
};

/// Least work first (Markowitz, Management Science 3 (1957) 255, with the work that a front of dense rows
/// costs); `width` inner unknowns a coordinate. Coordinates that cause no fill join the group before.
std::vector<PivotGroup> elimination_order(CoordinateGraph graph, int width);

}  // namespace extremal
