#include "solve/guess/first_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/dense.hpp"
#include "solve/guess/limits.hpp"
#include "solve/guess/loop.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

using namespace limits::first_path;

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

bool ran_away(const Problem& problem, double first, double magnitude) {
  return problem.ends.free > 0 && first > 0 && magnitude > runaway * first;
}

void start_path(const Problem& problem, const std::vector<double>& ends, const ElementTables& tables,
                Path& path) {
  const std::size_t n = problem.coordinates();
  std::vector<double> guess_ends = ends;
  if (problem.guess.given()) {
    problem.guess.at(0, {guess_ends.data(), n});
    problem.guess.at(1, {guess_ends.data() + n, n});
  }
  fill_path(ends, tables, path, [&](double tau, double* point) {
    if (problem.guess.given())
      problem.guess.at(tau, {point, n});
    else
      for (std::size_t a = 0; a < n; ++a) point[a] = ends[a] + tau * (ends[n + a] - ends[a]);
    for (std::size_t a = 0; a < n; ++a)
      point[a] += (1 - tau) * (ends[a] - guess_ends[a]) + tau * (ends[n + a] - guess_ends[n + a]);
  });
}

std::vector<double> arc_path(const Arc& arc, const std::vector<double>& ends, const ElementTables& tables,
                             Path& path) {
  using Eigen::VectorXd;
  const auto n = static_cast<Eigen::Index>(path.coordinates());
  const VectorXd centre = Eigen::Map<const VectorXd>(arc.centre.data(), n);
  const VectorXd start = Eigen::Map<const VectorXd>(ends.data(), n) - centre;
  const VectorXd end = Eigen::Map<const VectorXd>(ends.data() + n, n) - centre;
  const VectorXd along = start.norm() > 0 ? VectorXd(start.normalized()) : VectorXd::Unit(n, 0);
  VectorXd across = end - end.dot(along) * along;
  const double angle = std::atan2(across.norm(), end.dot(along)) + 2 * std::numbers::pi * arc.turns;
  if (!(across.norm() > 1e-6 * end.norm())) {
    // Ends in line with the centre leave the plane open: any will do.
    Eigen::Index least;
    along.cwiseAbs().minCoeff(&least);
    across = VectorXd::Unit(n, least) - along[least] * along;
  }
  across.normalize();
  const double radius = (1 + arc.excess) * (start.norm() + end.norm()) / 2;
  const auto at = [&](double tau, double* point) {
    Eigen::Map<VectorXd>(point, n) =
        centre + radius * (std::cos(angle * tau) * along + std::sin(angle * tau) * across);
  };
  std::vector<double> displacement(2 * static_cast<std::size_t>(n));
  at(0, displacement.data());
  at(1, displacement.data() + n);
  fill_path(displacement, tables, path, at);
  for (std::size_t e = 0; e < displacement.size(); ++e) displacement[e] -= ends[e];
  return displacement;
}

void make_agree(Path& path) {
  const std::size_t n = path.coordinates();
  std::vector<double> values((path.degree() + 1) * n);
  for (int k = 0; k < path.elements(); ++k) {
    path.element(k, values.data());
    for (auto row = values.begin(); row != values.end(); row += static_cast<std::ptrdiff_t>(n))
      std::copy_n(row, n / 2, row + static_cast<std::ptrdiff_t>(n / 2));
    path.set_element(k, values.data());
  }
  path.load_ends();
}

namespace {

void add_noise(const Problem& problem, const Bend& bend, const ElementTables& tables, Path& path) {
  if (bend_closed(problem, bend, tables, path)) return;
  const std::size_t n = path.coordinates();
  const std::vector<double> extent = extents(path, negligible_extent[bend.seed % 2]);
  Noise noise(bend.seed);
  std::vector<double> amplitude(bend.modes * n);
  for (double& c : amplitude) c = noise();
  fill_path(ends_of(path), tables, path, [&](double tau, double* point) {
    for (int m = 1; m <= bend.modes; ++m)
      for (std::size_t a = 0; a < n; ++a)
        point[a] +=
            bend.size * extent[a] / m * amplitude[(m - 1) * n + a] * std::sin(m * std::numbers::pi * tau);
  });
}

}  // namespace

void bend_path(const Problem& problem, const Bend& bend, const ElementTables& tables, Path& path) {
  if (bend.size == 0) return;
  add_noise(problem, bend, tables, path);
  if (problem.paired) make_agree(path);
}

}  // namespace extremal
