#include "solve/search/descent.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::descent;

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Block = Eigen::Map<const Matrix>;

}  // namespace

Descent::Descent(Path& path, Workspace& workspace, std::function<bool()> count)
    : path_(path), w_(workspace), count_(std::move(count)) {}

/// Cholesky along the nodes; one whose pivot block is not positive definite ends a window.
bool Descent::find_windows() {
  const NodeEquations& nodes = w_.iteration.action().nodes;
  if (nodes.negative > 0) return false;
  const int n = nodes.chain.size(), blocks = nodes.chain.blocks();
  factors_.resize(blocks);
  held_.assign(blocks, false);
  Matrix pivot(n, n);
  for (int k = 0; k < blocks; ++k) {
    pivot = Block(nodes.chain.diagonal(k), n, n);
    if (k > 0 && !held_[k - 1]) {
      const Block lower(nodes.chain.lower(k - 1), n, n);
      pivot -= lower * factors_[k - 1].solve(lower.transpose());
    }
    factors_[k].compute(pivot);
    held_[k] = factors_[k].info() != Eigen::Success;
  }
  return true;
}

/// Newton's step of the nodes that are not held.
void Descent::solve_windows() {
  DiscreteAction& action = w_.iteration.action();
  const NodeEquations& nodes = action.nodes;
  const int n = nodes.chain.size(), blocks = nodes.chain.blocks();
  step_.nodes.assign(static_cast<std::size_t>(blocks + 2) * n, 0);
  step_.duration = 0;
  const auto part = [&](int k) { return Eigen::Map<Eigen::VectorXd>(step_.nodes.data() + (k + 1) * n, n); };
  for (int k = 0; k < blocks; ++k) {
    if (held_[k]) continue;
    Eigen::VectorXd right = -Eigen::Map<const Eigen::VectorXd>(nodes.gradient.data() + (k + 1) * n, n);
    if (k > 0 && !held_[k - 1]) right -= Block(nodes.chain.lower(k - 1), n, n) * part(k - 1);
    part(k) = factors_[k].solve(right);
  }
  for (int k = blocks - 2; k >= 0; --k)
    if (!held_[k] && !held_[k + 1])
      part(k) -= factors_[k].solve(Block(nodes.chain.lower(k), n, n).transpose() * part(k + 1));
  action.expand_step(step_.nodes, 0, step_.inner);
}

/// Of the action along the step.
double Descent::slope() {
  DiscreteAction& action = w_.iteration.action();
  const int n = path_.coordinates(), inner = (path_.degree() - 1) * n, m = inner + 2 * n,
            lanes = path_.lanes();
  double sum = 0;
  action.visit(path_, false, [&](int b, const BatchValues& values) {
    const double* const inner_step = step_.inner.data() + static_cast<std::size_t>(b) * m * lanes;
    for (int lane = 0; lane < std::min(lanes, path_.elements() - b * lanes); ++lane) {
      const double* const ends = step_.nodes.data() + static_cast<std::size_t>(b * lanes + lane) * n;
      for (int u = 0; u < m; ++u)
        sum +=
            values.gradient[u * lanes + lane] * (u < inner ? inner_step[u * lanes + lane] : ends[u - inner]);
    }
  });
  return sum;
}

/// The step, or a part of it with which the action falls enough. False if there is none.
bool Descent::shorten(double slope, double before, double longest) {
  for (double factor = std::min(1.0, longest); factor > shortest; factor /= 2) {
    saved_.copy_values(path_);
    path_.add(step_.nodes, step_.inner, factor);
    path_.load_ends();
    DiscreteAction& action = w_.iteration.action();
    action.evaluate_plain(path_);
    if (action.finite() && action.action() <= before + sufficient * factor * slope) return true;
    path_.copy_values(saved_);
    path_.load_ends();
  }
  return false;
}

Descent::Result Descent::descend(const ElementTables& tables, double close) {
  DiscreteAction& action = w_.iteration.action();
  action.evaluate(path_);
  if (!count_() || !action.finite() || !find_windows()) return Result::failed;
  solve_windows();
  double size = 0;
  for (double x : step_.nodes) size = std::max(size, std::abs(x));
  for (double x : step_.inner) size = std::max(size, std::abs(x));
  const double range = scales(path_, tables).q;
  if (!std::isfinite(size)) return Result::failed;
  const bool one_window = std::find(held_.begin(), held_.end(), true) == held_.end();
  if (size <= (one_window ? close : nearly_minimal) * range) return Result::minimal;
  const double before = action.action();
  return shorten(slope(), before, range > 0 ? longest_step * range / size : 1) ? Result::moved
                                                                               : Result::failed;
}

bool Descent::run(const ElementTables& tables, double close) {
  saved_ = path_;
  for (;;) {
    const Result result = descend(tables, close);
    if (result == Result::failed) return false;
    if (result == Result::moved) continue;
    w_.iteration.set_scale(scales(path_, tables).q);
    if (!count_() || w_.iteration.full_step(path_, 0) != StepResult::ok) return false;
    if (w_.iteration.damping() == 1 && w_.iteration.remaining() < close) return true;
  }
  return false;
}

}  // namespace extremal
