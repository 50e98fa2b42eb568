#include "action/elimination_order.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace extremal {

CoordinateGraph coordinate_graph(const ElementShape& shape) {
  const int n = shape.n;
  CoordinateGraph graph{n, {}, {}};
  graph.inner.resize(static_cast<std::size_t>(n) * n);
  graph.ends.resize(graph.inner.size());
  const auto couple = [&](int a, int b, Coupling coupling, bool ends) {
    for (int k : {a * n + b, b * n + a}) {
      graph.inner[k] = std::max(graph.inner[k], coupling);
      if (ends) graph.ends[k] = 1;
    }
  };
  // ∫ φ_j' = 0: the kinetic energy does not couple inner unknowns with the ends.
  for (int e = 0; e < shape.mass_count; ++e)
    couple(shape.mass[e].row, shape.mass[e].column, Coupling::full, false);
  for (int e = 0; e < shape.gyroscopic_count; ++e)
    couple(shape.gyroscopic[e].row, shape.gyroscopic[e].column, Coupling::full, true);
  for (int e = 0; e < shape.hessian_count; ++e) {
    const int row = shape.hessian[e].row, column = shape.hessian[e].column;
    couple(row % n, column % n, shape.nodal && row < n ? Coupling::nodes : Coupling::full, true);
  }
  return graph;
}

namespace {

class Ordering {
 public:
  Ordering(CoordinateGraph graph, int width);
  std::vector<PivotGroup> run();

 private:
  Coupling& inner(int a, int b) { return graph_.inner[static_cast<std::size_t>(a) * graph_.n + b]; }
  char& ends(int a, int b) { return graph_.ends[static_cast<std::size_t>(a) * graph_.n + b]; }
  int cheapest() const;
  bool within(int b, const std::vector<int>& neighbours, int pivot);
  PivotGroup group(int pivot);
  void fill(const PivotGroup& group);
  void count(int a);

  CoordinateGraph graph_;
  int width_;
  std::vector<int> left_;              // not eliminated yet
  std::vector<int> degree_, touched_;  // of each coordinate: others coupled, coordinates whose ends it meets
};

Ordering::Ordering(CoordinateGraph graph, int width) : graph_(std::move(graph)), width_(width) {
  degree_.resize(graph_.n);
  touched_.resize(graph_.n);
  for (int a = 0; a < graph_.n; ++a) {
    inner(a, a) = Coupling::none;
    left_.push_back(a);
  }
  for (int a = 0; a < graph_.n; ++a) count(a);
}

void Ordering::count(int a) {
  degree_[a] = touched_[a] = 0;
  for (int b : left_) degree_[a] += inner(a, b) != Coupling::none;
  for (int b = 0; b < graph_.n; ++b) touched_[a] += ends(a, b);
}

int Ordering::cheapest() const {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int a : left_) {
    const double rows = static_cast<double>(width_) * (1 + degree_[a]) + 2 * touched_[a];
    if (rows < least) {
      least = rows;
      best = a;
    }
  }
  return best;
}

/// Whether b is coupled with nothing that the pivot is not coupled with.
bool Ordering::within(int b, const std::vector<int>& neighbours, int pivot) {
  if (degree_[b] > degree_[pivot] || touched_[b] > touched_[pivot]) return false;
  int common = 0, common_ends = 0;
  for (int c : neighbours) common += inner(b, c) != Coupling::none;
  for (int c = 0; c < graph_.n; ++c) common_ends += ends(b, c) && ends(pivot, c);
  return common + 1 == degree_[b] && common_ends == touched_[b];
}

PivotGroup Ordering::group(int pivot) {
  PivotGroup result;
  std::vector<int> neighbours, rows;
  for (int b : left_)
    if (inner(pivot, b) != Coupling::none) neighbours.push_back(b);
  result.pivots.push_back(pivot);
  for (int b : neighbours) (within(b, neighbours, pivot) ? result.pivots : rows).push_back(b);
  const int count = static_cast<int>(result.pivots.size());
  for (int b : rows)
    for (int k = 0; k < count; ++k)
      if (const Coupling coupling = inner(result.pivots[k], b); coupling != Coupling::none) {
        result.inner.push_back({b, k, coupling});
        break;
      }
  for (int b = 0; b < graph_.n; ++b)
    for (int k = 0; k < count; ++k)
      if (ends(result.pivots[k], b)) {
        result.ends.push_back({b, k, Coupling::full});
        break;
      }
  return result;
}

/// What is left after a group couples fully with each other and with the ends that the group met.
void Ordering::fill(const PivotGroup& group) {
  for (int a : group.pivots) left_.erase(std::find(left_.begin(), left_.end(), a));
  for (const auto& a : group.inner) {
    for (const auto& b : group.inner)
      if (a.coordinate != b.coordinate) inner(a.coordinate, b.coordinate) = Coupling::full;
    for (const auto& e : group.ends) ends(a.coordinate, e.coordinate) = 1;
  }
  for (const auto& a : group.inner) count(a.coordinate);
}

std::vector<PivotGroup> Ordering::run() {
  std::vector<PivotGroup> groups;
  std::vector<int> place(graph_.n);
  int eliminated = 0;
  while (!left_.empty()) {
    groups.push_back(group(cheapest()));
    for (int a : groups.back().pivots) place[a] = eliminated++;
    fill(groups.back());
  }
  for (PivotGroup& g : groups)
    std::sort(g.inner.begin(), g.inner.end(),
              [&](const auto& a, const auto& b) { return place[a.coordinate] < place[b.coordinate]; });
  return groups;
}

}  // namespace

std::vector<PivotGroup> elimination_order(CoordinateGraph graph, int width) {
  if (width == 0) return {};
  return Ordering(std::move(graph), width).run();
}

}  // namespace extremal
