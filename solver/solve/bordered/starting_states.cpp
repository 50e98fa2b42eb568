#include "solve/bordered/starting_states.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/dense.hpp"
#include "solution/solution.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

StartingStates::StartingStates(const Problem& problem)
    : problem_(problem), extension_(*problem.extension), n_(problem.coordinates()) {
  for (const WaypointCondition& w : extension_.waypoints)
    times_.push_back(w.free ? w.time * problem.duration.value : w.time);
  times_.push_back(problem.duration.value);
}

void StartingStates::set_waypoints(BorderedState& state) const {
  for (std::size_t w = 0; w < extension_.waypoints.size(); ++w)
    for (const auto& [a, value] : extension_.waypoints[w].fixed)
      state.path.set_node(state.mesh.first[w + 1], a, value);
  state.path.load_ends();
}

/// By how much the ends of a bent start are moved, where nonlinear conditions hold between them: at those
/// of the guess their gradients may vanish.
std::vector<double> StartingStates::moved_ends(double size, const std::vector<double>& extent,
                                               Noise& noise) const {
  std::vector<double> moved(2 * static_cast<std::size_t>(n_));
  if (extension_.conditions.empty()) return moved;
  std::vector<double> free(problem_.ends.free);
  for (int f = 0; f < problem_.ends.free; ++f) free[f] = size * extent[problem_.ends.home[f] % n_] * noise();
  for (const Triplet& z : problem_.ends.z) moved[z.row] += z.value * free[z.column];
  return moved;
}

/// How far ends that are drawn are from those of the path: at random in a box of its extent or twice that,
/// then moved onto the conditions by the shortest steps.
std::vector<double> StartingStates::drawn_ends(const Start& start, const Path& path) const {
  const std::vector<double> extent = extents(path, negligible_extent[0]), from = ends_of(path);
  const int free = problem_.ends.free, rows = static_cast<int>(extension_.conditions.size());
  const std::size_t all = static_cast<std::size_t>(n_) + extension_.constants(), n = n_;
  Noise noise(static_cast<unsigned>(start.ends));
  Eigen::VectorXd y(free), residual(rows);
  for (int f = 0; f < free; ++f) y[f] = (1 + start.ends % 2) * extent[problem_.ends.home[f] % n_] * noise();
  std::vector<double> moved(2 * n), first(all, 0), last(all, 0), gradient(2 * all);
  for (std::vector<double>* end : {&first, &last}) std::ranges::copy(extension_.guess, end->begin() + n_);
  Eigen::MatrixXd slopes(rows, free);
  for (int step = 0;; ++step) {
    std::ranges::fill(moved, 0);
    for (const Triplet& z : problem_.ends.z) moved[z.row] += z.value * y[z.column];
    if (step == limits::bordered::most_end_steps) return moved;
    for (std::size_t a = 0; a < n; ++a) {
      first[a] = from[a] + moved[a];
      last[a] = from[n + a] + moved[n + a];
    }
    slopes.setZero();
    for (int r = 0; r < rows; ++r) {
      residual[r] = extension_.conditions[r].function(first, last, gradient, {});
      for (const Triplet& z : problem_.ends.z) {
        const std::size_t row = static_cast<std::size_t>(z.row);
        slopes(r, z.column) += z.value * gradient[row < n ? row : all + row - n];
      }
    }
    if (!slopes.allFinite() || !residual.allFinite()) return moved;
    y -= least_norm(slopes, residual);
  }
}

/// By a straight line between what both ends are moved by.
void StartingStates::move_ends(const std::vector<double>& moved, const ElementTables& tables,
                               Path& path) const {
  std::vector<double> ends = ends_of(path);
  for (std::size_t e = 0; e < ends.size(); ++e) ends[e] += moved[e];
  fill_path(ends, tables, path, [&](double tau, double* point) {
    for (int a = 0; a < n_; ++a) point[a] += (1 - tau) * moved[a] + tau * moved[n_ + a];
  });
}

/// Adds waves, and moves ends that are free; closed paths stay closed.
void StartingStates::bend(const Start& start, const ElementTables& tables, Path& path) const {
  if (start.size == 0) return;
  if (problem_.periodic) return bend_path(problem_, {start.size, start.seed, start.last}, tables, path);
  const std::vector<double> extent = extents(path, negligible_extent[start.seed % 2]);
  Noise noise(start.seed);
  std::vector<double> amplitude(static_cast<std::size_t>(start.last + 1) * n_);
  for (double& c : amplitude) c = start.size * noise();
  // One wave of one coordinate has the size that is asked for.
  if (start.first == start.last && n_ == 1) std::ranges::fill(amplitude, start.size);
  move_ends(moved_ends(start.size, extent, noise), tables, path);
  fill_path(ends_of(path), tables, path, [&](double tau, double* point) {
    for (int a = 0; a < n_; ++a)
      for (int m = start.first; m <= start.last; ++m)
        point[a] += extent[a] / m * amplitude[static_cast<std::size_t>(m) * n_ + a] *
                    std::sin(m * std::numbers::pi * tau);
  });
}

/// The path is moved through the waypoints: by as much as it misses them, in proportion between them.
void StartingStates::pass_waypoints(const ElementTables& tables, Path& path) const {
  if (extension_.waypoints.empty()) return;
  const Trajectory before = trajectory_of(path);
  std::vector<std::vector<double>> tau(n_, {0.0}), missed(n_, {0.0});
  std::vector<double> q(n_), v(n_);
  for (std::size_t w = 0; w < extension_.waypoints.size(); ++w) {
    before.at(times_[w], q, v);
    for (const auto& [a, value] : extension_.waypoints[w].fixed) {
      tau[a].push_back(times_[w] / times_.back());
      missed[a].push_back(value - q[a]);
    }
  }
  for (int a = 0; a < n_; ++a) {
    tau[a].push_back(1);
    missed[a].push_back(0);
  }
  fill_path(ends_of(path), tables, path, [&](double t, double* point) {
    for (int a = 0; a < n_; ++a) {
      const auto after = std::min(std::ranges::upper_bound(tau[a], t), tau[a].end() - 1);
      const auto k = static_cast<std::size_t>(after - tau[a].begin());
      const double part = (t - tau[a][k - 1]) / (tau[a][k] - tau[a][k - 1]);
      point[a] += missed[a][k - 1] + part * (missed[a][k] - missed[a][k - 1]);
    }
  });
}

BorderedState StartingStates::at(const LegMesh& mesh, const Elements& elements, const Start& start) const {
  BorderedState state{{}, mesh, times_, std::vector<double>(extension_.conditions.size())};
  const std::vector<double> lengths = element_lengths(mesh, times_);
  Path path;
  path.reset(*elements.own, mesh_nodes(lengths), times_.back(), lengths);
  start_path(problem_, starting_ends(problem_), *elements.own, path);
  if (start.ends >= 0) move_ends(drawn_ends(start, path), *elements.own, path);
  bend(start, *elements.own, path);
  pass_waypoints(*elements.own, path);
  if (problem_.paired) make_agree(path);
  std::vector<double> constants = extension_.guess;
  constants.resize(extension_.constants(), 0);
  with_constants(path, *elements.tables, constants, state.path);
  set_waypoints(state);
  return state;
}

}  // namespace extremal
