#include "solve/start.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace extremal {

namespace {

/// The point x of the affine set { offset + Z y } nearest to `target`; ends that no general row couples
/// are handled one by one, so that only the coupled ones are ever dense.
std::vector<double> nearest(const EndMap& ends, const std::vector<double>& target) {
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
  const Eigen::VectorXd y = matrix.completeOrthogonalDecomposition().solve(right);
  const Eigen::VectorXd moved = matrix * y;
  for (std::size_t e = 0; e < x.size(); ++e)
    if (right[e] != 0 || moved[e] != 0) x[e] = ends.offset[e] + moved[e];
  return x;
}

}  // namespace

std::vector<double> starting_ends(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  std::vector<double> target(2 * n, 0);
  if (problem.guess.given()) {
    problem.guess.at(0, {target.data(), n});
    problem.guess.at(1, {target.data() + n, n});
  } else {
    for (std::size_t a = 0; a < n; ++a) {
      const bool start = problem.ends.fixed[a], end = problem.ends.fixed[n + a];
      if (start && !end) target[n + a] = problem.ends.offset[a];
      if (end && !start) target[a] = problem.ends.offset[n + a];
    }
  }
  return nearest(problem.ends, target);
}

void start_path(const Problem& problem, const std::vector<double>& ends, const ElementTables& tables,
                double bend, Path& path) {
  const std::size_t n = problem.coordinates();
  const int degree = path.degree();
  std::vector<double> q((degree + 1) * n), guess_ends = ends;
  double length = 0;
  for (std::size_t a = 0; a < n; ++a) length += (ends[n + a] - ends[a]) * (ends[n + a] - ends[a]);
  length = length > 0 ? std::sqrt(length) : 1;
  if (problem.guess.given()) {
    problem.guess.at(0, {guess_ends.data(), n});
    problem.guess.at(1, {guess_ends.data() + n, n});
  }
  for (int k = 0; k < path.elements(); ++k) {
    for (int j = 0; j <= degree; ++j) {
      const double from = path.mesh()[k], to = path.mesh()[k + 1];
      const double tau = j == degree ? to : from + tables.scheme().lobatto[j] * (to - from);
      double* point = q.data() + j * n;
      if (problem.guess.given())
        problem.guess.at(tau, {point, n});
      else
        for (std::size_t a = 0; a < n; ++a) point[a] = ends[a] + tau * (ends[n + a] - ends[a]);
      for (std::size_t a = 0; a < n; ++a) {
        point[a] += (1 - tau) * (ends[a] - guess_ends[a]) + tau * (ends[n + a] - guess_ends[n + a]);
        // Directions that no symmetry of a system is likely to share.
        if (bend != 0)
          point[a] +=
              bend * length * std::sin(std::numbers::pi * tau) * std::cos(1.0 + 2.4 * static_cast<double>(a));
      }
    }
    path.set_element(k, q.data());
  }
  for (std::size_t a = 0; a < n; ++a) {
    path.set_node(0, static_cast<int>(a), ends[a]);
    path.set_node(path.elements(), static_cast<int>(a), ends[n + a]);
  }
  path.load_ends();
}

}  // namespace extremal
