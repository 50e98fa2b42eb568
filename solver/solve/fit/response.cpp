#include "solve/fit/response.hpp"

#include <algorithm>

namespace extremal {

namespace {

bool moves(const ProblemChange& change) {
  return change.duration != 0 || std::ranges::any_of(change.ends, [](double x) { return x != 0; });
}

bool active(std::span<const ProblemChange> changes, std::size_t parameter) {
  return std::ranges::any_of(changes, [&](const ProblemChange& c) { return c.parameters[parameter] != 0; });
}

}  // namespace

void add(Step& to, const Step& step, double factor) {
  for (std::size_t i = 0; i < to.nodes.size(); ++i) to.nodes[i] += factor * step.nodes[i];
  for (std::size_t i = 0; i < to.inner.size(); ++i) to.inner[i] += factor * step.inner[i];
  to.duration += factor * step.duration;
}

bool ExtremalResponse::factor(NewtonIteration& newton, const Problem& problem, const Path& path,
                              const ElementTables& tables, std::span<const ProblemChange> changes) {
  newton_ = &newton;
  problem_ = &problem;
  path_ = &path;
  tables_ = &tables;
  n_ = problem.coordinates();
  DiscreteAction& action = newton.action();
  if (!newton.factor_quickly(path)) return false;
  mixed_.resize(problem.lagrangian->structure().parameters);
  for (std::size_t p = 0; p < mixed_.size(); ++p)
    if (active(changes, p))
      action.parameter_slope(path, static_cast<int>(p), mixed_[p].load, mixed_[p].on_duration);
  columns_ = std::ranges::any_of(changes, moves);
  if (columns_) keep_columns();
  return true;
}

/// What moved ends and a moved duration need of the uncondensed Hessian.
void ExtremalResponse::keep_columns() {
  const int m = tables_->unknowns(), elements = path_->elements();
  const std::size_t batch = static_cast<std::size_t>(m) * lanes_;
  const ElementTables::Entries& entries = tables_->entries();
  plain_.reset(*problem_->lagrangian, *tables_, elements, true, Condense::nothing);
  by_duration_.assign(path_->batches() * batch, 0);
  corner_ = 0;
  const auto keep = [&](std::vector<double>& matrix, const BatchValues& values, int lane) {
    matrix.assign(static_cast<std::size_t>(m) * m, 0);
    for (std::size_t e = 0; e < entries.row.size(); ++e) {
      const double value = values.entries[e * lanes_ + lane];
      matrix[static_cast<std::size_t>(entries.row[e]) * m + entries.column[e]] = value;
      matrix[static_cast<std::size_t>(entries.column[e]) * m + entries.row[e]] = value;
    }
  };
  plain_.visit(*path_, true, [&](int b, const BatchValues& values) {
    std::copy_n(values.border, batch, by_duration_.begin() + static_cast<std::ptrdiff_t>(b * batch));
    const int first = b * lanes_, last = std::min(elements, first + lanes_);
    for (int k = first; k < last; ++k) corner_ += values.corner[k - first];
    if (b == 0) keep(first_, values, 0);
    if (last == elements) keep(last_, values, elements - 1 - first);
  });
}

void ExtremalResponse::add_parameters(const ProblemChange& change) {
  for (std::size_t p = 0; p < mixed_.size(); ++p) {
    const double by = change.parameters[p];
    if (by == 0) continue;
    for (std::size_t i = 0; i < load_.size(); ++i) load_[i] += by * mixed_[p].load[i];
    on_duration_ += by * mixed_[p].on_duration;
  }
}

/// The columns of the Hessian of the ends and of T; their own momenta.
void ExtremalResponse::add_ends(const ProblemChange& change) {
  const int m = tables_->unknowns(), inner = tables_->inner(), elements = path_->elements();
  const std::size_t batch = static_cast<std::size_t>(m) * lanes_;
  const auto element = [&](int k) { return load_.data() + (k / lanes_) * batch + k % lanes_; };
  const auto move = [&](int k, int local, double by, const std::vector<double>& matrix) {
    if (by == 0) return;
    double* const to = element(k);
    for (int u = 0; u < m; ++u) to[u * lanes_] += by * matrix[static_cast<std::size_t>(u) * m + local];
    on_duration_ += by * by_duration_[(k / lanes_) * batch + local * lanes_ + k % lanes_];
  };
  if (columns_)
    for (int a = 0; a < n_; ++a) {
      move(0, inner + a, change.ends[a], first_);
      move(elements - 1, inner + n_ + a, change.ends[n_ + a], last_);
    }
  if (change.duration != 0) {
    for (std::size_t i = 0; i < load_.size(); ++i) load_[i] += change.duration * by_duration_[i];
    on_duration_ += change.duration * corner_;
  }
  if (change.momenta.empty()) return;
  for (int a = 0; a < n_; ++a) {
    element(0)[(inner + a) * lanes_] += change.momenta[a];
    element(elements - 1)[(inner + n_ + a) * lanes_] -= change.momenta[n_ + a];
  }
}

double ExtremalResponse::closing_value(const ProblemChange& change, const ClosingEquation& closing) const {
  if (closing.row.empty()) return change.energy;
  const std::size_t n = n_;
  double value = change.where ? change.where({path_->node(0), n}, {path_->node(path_->elements()), n}) : 0;
  for (std::size_t e = 0; e < 2 * n; ++e) value += closing.row[e] * change.ends[e];
  return value;
}

/// The adjoint fields, which are their difference, are known to fewer digits than the path.
void ExtremalResponse::move_copies_alike(Step& step) const {
  const std::size_t n = n_ / 2, lanes = lanes_;
  const auto share = [](double& a, double& b) { a = b = (a + b) / 2; };
  for (std::size_t k = 0; k < step.nodes.size(); k += 2 * n)
    for (std::size_t a = k; a < k + n; ++a) share(step.nodes[a], step.nodes[a + n]);
  for (std::size_t k = 0; k < step.inner.size(); k += 2 * n * lanes)
    for (std::size_t a = k; a < k + n * lanes; ++a) share(step.inner[a], step.inner[a + n * lanes]);
}

void ExtremalResponse::to(const ProblemChange& change, Step& step) {
  const std::size_t batch = static_cast<std::size_t>(tables_->unknowns()) * lanes_;
  load_.assign(path_->batches() * batch, 0);
  on_duration_ = 0;
  add_parameters(change);
  add_ends(change);
  DiscreteAction& action = newton_->action();
  newton_->second_variation()->put_load(action, *path_, load_, on_duration_);
  const ClosingEquation* const closing = newton_->closing(*path_);
  ClosingEquation homogeneous;
  if (closing) homogeneous = {closing->row, closing_value(change, *closing)};
  newton_->model().solve(action, closing ? &homogeneous : nullptr, step);
  if (!closing) step.duration = change.duration;
  const std::size_t last = static_cast<std::size_t>(path_->elements()) * n_;
  for (int a = 0; a < n_; ++a) {
    step.nodes[a] += change.ends[a];
    step.nodes[last + a] += change.ends[n_ + a];
  }
  if (problem_->paired) move_copies_alike(step);
}

}  // namespace extremal
