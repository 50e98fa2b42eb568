#include "solve/periodic/later_orbit.hpp"

namespace extremal {

void begin_at(const ClosingMap& map, const Path& path, const ElementTables& tables, int node, Path& later) {
  const int n = path.coordinates(), count = path.elements();
  const double start = path.mesh()[node];
  std::vector<double> mesh, lengths;
  for (int k = node; k < count; ++k) mesh.push_back(path.mesh()[k] - start);
  for (int k = 0; k < node; ++k) mesh.push_back(1 - start + path.mesh()[k]);
  mesh.push_back(1);
  for (int k = 0; k < count; ++k) lengths.push_back(path.lengths()[(node + k) % count]);
  later.reset(tables, mesh, path.duration(), lengths);
  Eigen::MatrixXd values(n, path.degree() + 1);
  for (int k = 0; k < count; ++k) {
    path.element((node + k) % count, values.data());
    if (node + k >= count) values = ((map.r * values).colwise() + map.c).eval();
    later.set_element(k, values.data());
  }
  later.load_ends();
}

}  // namespace extremal
