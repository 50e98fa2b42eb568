#include "solve/start.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace extremal {

namespace {

/// Of the largest extent. Every other seed takes coordinates to be of one kind: a line has no extent across.
constexpr double negligible_extent[] = {0.01, 0.5};

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

/// Of each coordinate: its range, or its largest absolute value if that is more; where that is next to
/// nothing, that of the coordinate which has most.
std::vector<double> extents(const Path& path, double negligible) {
  const std::size_t n = path.coordinates();
  std::vector<double> low(path.node(0), path.node(0) + n), high = low, extent(n);
  for (std::size_t k = 0; k < path.nodes().size(); ++k) {
    low[k % n] = std::min(low[k % n], path.nodes()[k]);
    high[k % n] = std::max(high[k % n], path.nodes()[k]);
  }
  for (std::size_t a = 0; a < n; ++a)
    extent[a] = std::max({high[a] - low[a], std::abs(low[a]), std::abs(high[a])});
  const double most = *std::max_element(extent.begin(), extent.end());
  for (double& x : extent)
    if (x < negligible * most || most == 0) x = most > 0 ? most : 1;
  return extent;
}

}  // namespace

std::vector<double> starting_ends(const Problem& problem) {
  if (problem.ends.free == 0) return problem.ends.offset;
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
                Path& path) {
  const std::size_t n = problem.coordinates();
  const int degree = path.degree();
  std::vector<double> q((degree + 1) * n), guess_ends = ends;
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
      for (std::size_t a = 0; a < n; ++a)
        point[a] += (1 - tau) * (ends[a] - guess_ends[a]) + tau * (ends[n + a] - guess_ends[n + a]);
    }
    path.set_element(k, q.data());
  }
  for (std::size_t a = 0; a < n; ++a) {
    path.set_node(0, static_cast<int>(a), ends[a]);
    path.set_node(path.elements(), static_cast<int>(a), ends[n + a]);
  }
  path.load_ends();
}

void bend_path(const Bend& bend, const ElementTables& tables, Path& path) {
  if (bend.size == 0) return;
  const int n = path.coordinates(), degree = path.degree(), elements = path.elements();
  const std::vector<double> extent = extents(path, negligible_extent[bend.seed % 2]);
  std::minstd_rand random(bend.seed + 1);
  random.discard(3);
  std::vector<double> amplitude(3 * static_cast<std::size_t>(n));
  for (double& c : amplitude) c = 2.0 * random() / std::minstd_rand::max() - 1;
  std::vector<double> q((degree + 1) * static_cast<std::size_t>(n)), ends(2 * static_cast<std::size_t>(n));
  std::copy_n(path.node(0), n, ends.begin());
  std::copy_n(path.node(elements), n, ends.begin() + n);
  for (int k = 0; k < elements; ++k) {
    path.element(k, q.data());
    for (int j = 0; j <= degree; ++j) {
      // The first node of an element is already where the one before left it.
      if (j == 0 && k > 0) continue;
      const double tau = path.mesh()[k] + tables.scheme().lobatto[j] * (path.mesh()[k + 1] - path.mesh()[k]);
      for (int m = 1; m <= 3; ++m)
        for (int a = 0; a < n; ++a)
          q[j * n + a] +=
              bend.size * extent[a] / m * amplitude[(m - 1) * n + a] * std::sin(m * std::numbers::pi * tau);
    }
    path.set_element(k, q.data());
  }
  for (int a = 0; a < n; ++a) {
    path.set_node(0, a, ends[a]);
    path.set_node(elements, a, ends[n + a]);
  }
  path.load_ends();
}

}  // namespace extremal
