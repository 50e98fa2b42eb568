#include "solve/fit/fitted_extremal.hpp"

namespace extremal {

Scheme scheme_of(const Trajectory& trajectory, const SolveOptions& options) {
  return options.scheme ? *options.scheme : lobatto(trajectory.degree);
}

void put_trajectory(const Trajectory& trajectory, const ElementTables& tables, Path& path) {
  const std::size_t n = trajectory.coordinates, width = tables.coordinates();
  const int degree = tables.scheme().degree;
  std::vector<double> mesh;
  for (const double t : trajectory.times) mesh.push_back(t / trajectory.duration());
  mesh.back() = 1;
  path.reset(tables, mesh, trajectory.duration());
  std::vector<double> nodes((degree + 1) * width), q(n), v(n);
  const std::vector<double>& places = lobatto_barycentric(degree).nodes;
  for (int k = 0; k < path.elements(); ++k) {
    for (int j = 0; j <= degree; ++j) {
      trajectory.in_element(k, places[j], q, v);
      for (std::size_t a = 0; a < width; ++a) nodes[j * width + a] = q[a % n];
    }
    path.set_element(k, nodes.data());
  }
  path.load_ends();
}

Trajectory first_copy(Trajectory trajectory, int coordinates) {
  const std::size_t n = coordinates, width = trajectory.coordinates;
  if (n == width) return trajectory;
  for (std::vector<double>* rows : {&trajectory.nodes, &trajectory.slopes}) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < rows->size(); i += width)
      kept.insert(kept.end(), rows->begin() + i, rows->begin() + i + n);
    *rows = std::move(kept);
  }
  trajectory.coordinates = coordinates;
  return trajectory;
}

}  // namespace extremal
