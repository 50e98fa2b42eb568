#include "solve/newton/ends.hpp"

#include <cmath>

#include "linear/dense.hpp"
#include "machine/long_sum.hpp"

namespace extremal {

namespace {

/// Where an end coordinate is among the nodes.
int node_of(int e, const Path& path) { return e < path.coordinates() ? 0 : path.elements(); }

}  // namespace

std::vector<double> ends_of(const Path& path) {
  const std::size_t n = path.coordinates();
  std::vector<double> ends(path.node(0), path.node(0) + n);
  ends.insert(ends.end(), path.node(path.elements()), path.node(path.elements()) + n);
  return ends;
}

/// Ends that no general row couples are handled one by one, so that only the coupled ones are ever dense.
std::vector<double> nearest_ends(const EndMap& ends, const std::vector<double>& target) {
  std::vector<double> x = ends.offset;
  std::vector<int> uses(ends.free, 0);
  for (const Triplet& z : ends.z) ++uses[z.column];
  std::vector<int> dense(ends.free, -1);
  int count = 0;
  for (const Triplet& z : ends.z)
    if (uses[z.column] == 1 && z.value == 1) {
      x[z.row] = target[z.row];
    } else if (dense[z.column] < 0) {
      dense[z.column] = count++;
    }
  if (count == 0) return x;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(x.size()), count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(x.size()));
  for (const Triplet& z : ends.z)
    if (dense[z.column] >= 0) {
      matrix(z.row, dense[z.column]) += z.value;
      right[z.row] = target[z.row] - ends.offset[z.row];
    }
  const Eigen::VectorXd y = least_norm(matrix, right);
  const Eigen::VectorXd moved = matrix * y;
  for (std::size_t e = 0; e < x.size(); ++e)
    if (right[e] != 0 || moved[e] != 0) x[e] = ends.offset[e] + moved[e];
  return x;
}

void meet_ends(const Problem& problem, Path& path) {
  const std::size_t n = problem.coordinates();
  const int last = path.elements();
  const std::vector<double> now = ends_of(path);
  const std::vector<double> ends = nearest_ends(problem.ends, now);
  for (std::size_t a = 0; a < n; ++a) {
    if (ends[a] != now[a]) path.set_node(0, static_cast<int>(a), ends[a]);
    if (ends[n + a] != now[n + a]) path.set_node(last, static_cast<int>(a), ends[n + a]);
  }
  path.load_ends();
}

void keep_ends(const EndMap& ends, Path& path) {
  const int n = path.coordinates();
  for (std::size_t i = 0; i < ends.z.size();) {
    const int e = ends.z[i].row;
    if (ends.home[ends.z[i].column] == e) {
      ++i;
      continue;
    }
    LongSum sum{ends.offset[e], 0};
    for (; i < ends.z.size() && ends.z[i].row == e; ++i) {
      const double factor = ends.z[i].value;
      const int free = ends.home[ends.z[i].column], k = node_of(free, path);
      const double y = path.node(k)[free % n], product = factor * y;
      sum.add_term(product);
      sum.low += std::fma(factor, y, -product) + factor * path.rest(k)[free % n];
    }
    path.set_node(node_of(e, path), e % n, sum.high, sum.low);
  }
}

}  // namespace extremal
