#include "solve/periodic/doubled_orbit.hpp"

#include <utility>

#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A function of q(0) and q(T), given q(2T).
EndFunction halfway(EndFunction where, const ClosingMap& map) {
  const MatrixXd inverse = solved(map.r, MatrixXd::Identity(map.r.rows(), map.r.cols()));
  return [where = std::move(where), inverse, c = map.c](
             std::span<const double> start, std::span<const double> end, std::span<double> gradient) {
    const auto n = static_cast<Eigen::Index>(start.size());
    const VectorXd middle = inverse * (Map<const VectorXd>(end.data(), n) - c);
    const double value = where(start, {middle.data(), start.size()}, gradient);
    Map<VectorXd> by_end(gradient.data() + n, n);
    by_end = (inverse.transpose() * by_end).eval();
    return value;
  };
}

/// q, and after it R q + c.
Guess doubled(const Guess& guess, const ClosingMap& map) {
  const Eigen::Index n = map.c.size();
  Guess twice = guess;
  for (double& tau : twice.tau) tau /= 2;
  // The last sample of the first half is the first of the second.
  for (std::size_t k = 1; k < guess.tau.size(); ++k) {
    const VectorXd q = map.r * Map<const VectorXd>(guess.q.data() + k * n, n) + map.c;
    twice.tau.push_back(0.5 + guess.tau[k] / 2);
    twice.q.insert(twice.q.end(), q.begin(), q.end());
  }
  return twice;
}

}  // namespace

Problem doubled(const Problem& problem) {
  const ClosingMap map = closing_map(problem);
  const int n = problem.coordinates();
  const MatrixXd r = map.r * map.r;
  const VectorXd c = map.r * map.c + map.c;
  Problem twice = problem;
  twice.boundary = {.coordinates = n, .rows = 0, .matrix = {}, .value = {}, .momenta = {}, .costs = {}};
  for (int i = 0; i < n; ++i) {
    const int row = twice.boundary.add_row(c[i]);
    twice.boundary.add(row, n + i, 1);
    for (int j = 0; j < n; ++j)
      if (r(i, j) != 0) twice.boundary.add(row, j, -r(i, j));
  }
  twice.duration.value *= 2;
  if (twice.duration.where) twice.duration.where = halfway(std::move(twice.duration.where), map);
  twice.guess = doubled(problem.guess, map);
  twice.ends = solve_relation(twice.boundary);
  twice.reduction = nullptr;
  return twice;
}

void double_path(const Problem& problem, const Path& path, const ElementTables& tables, Path& twice) {
  const ClosingMap map = closing_map(problem);
  const int n = path.coordinates(), count = path.elements();
  std::vector<double> mesh, lengths;
  for (const double tau : path.mesh()) mesh.push_back(tau / 2);
  for (int k = 1; k <= count; ++k) mesh.push_back(0.5 + path.mesh()[k] / 2);
  for (int k = 0; k < 2 * count; ++k) lengths.push_back(path.lengths()[k % count] / 2);
  twice.reset(tables, mesh, 2 * path.duration(), lengths);
  MatrixXd values(n, path.degree() + 1);
  for (int k = 0; k < count; ++k) {
    path.element(k, values.data());
    twice.set_element(k, values.data());
    values = ((map.r * values).colwise() + map.c).eval();
    twice.set_element(count + k, values.data());
  }
  twice.load_ends();
}

}  // namespace extremal
