#include "solve/sparse_model.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

void SparseModel::reset(const Problem& problem, const ElementTables& tables, int elements) {
  tables_ = &tables;
  ends_ = &problem.ends;
  n_ = tables.coordinates();
  elements_ = elements;
  inner_ = tables.inner();
  free_duration_ = problem.duration.free;
  const int nodes = (elements - 1) * n_;
  unknowns_ = nodes + ends_->free + elements * inner_;
  all_.resize(unknowns_);
  for (int u = 0; u < unknowns_; ++u) all_[u] = {u, 1};
  end_start_.assign(2 * n_ + 1, 0);
  for (const Triplet& z : ends_->z) ++end_start_[z.row + 1];
  for (int e = 0; e < 2 * n_; ++e) end_start_[e + 1] += end_start_[e];
  end_shares_.resize(ends_->z.size());
  std::vector<int> next(end_start_.begin(), end_start_.end() - 1);
  for (const Triplet& z : ends_->z) end_shares_[next[z.row]++] = {nodes + z.column, z.value};
  build_pattern();
  gradient_.resize(unknowns_);
  by_duration_.resize(free_duration_ ? unknowns_ : 0);
  phases_ = nullptr;
}

std::span<const SparseModel::Share> SparseModel::shares(int element, int local) const {
  if (local < inner_) return {all_.data() + (elements_ - 1) * n_ + ends_->free + element * inner_ + local, 1};
  const int node = element + (local - inner_) / n_, a = (local - inner_) % n_;
  if (node > 0 && node < elements_) return {all_.data() + (node - 1) * n_ + a, 1};
  const int e = node == 0 ? a : n_ + a;
  return {end_shares_.data() + end_start_[e], static_cast<std::size_t>(end_start_[e + 1] - end_start_[e])};
}

void SparseModel::build_pattern() {
  const ElementTables::Entries& entries = tables_->entries();
  std::vector<int> rows, columns;
  sources_.clear();
  source_start_.assign(1, 0);
  for (int k = 0; k < elements_; ++k) {
    for (std::size_t e = 0; e < entries.row.size(); ++e)
      for (const Share& r : shares(k, entries.row[e]))
        for (const Share& c : shares(k, entries.column[e])) {
          // xᵀHx holds an entry off the diagonal twice: both meet where two unknowns become one.
          const bool twice = entries.row[e] != entries.column[e] && r.unknown == c.unknown;
          rows.push_back(r.unknown);
          columns.push_back(c.unknown);
          sources_.push_back(
              {static_cast<int>(e) * lanes + k % lanes, r.factor * c.factor * (twice ? 2 : 1)});
        }
    source_start_.push_back(static_cast<int>(sources_.size()));
  }
  // For the unit vectors of the border.
  for (int u = 0; u < (elements_ - 1) * n_ + ends_->free; ++u) {
    rows.push_back(u);
    columns.push_back(u);
  }
  matrix_.pattern(unknowns_, rows, columns);
}

/// Adds a vector over local unknowns of elements first … last − 1 (one batch) to one over all unknowns.
void SparseModel::spread(std::vector<double>& to, int first, int last, const double* batch) const {
  for (int k = first; k < last; ++k)
    for (int u = 0; u < inner_ + 2 * n_; ++u)
      for (const Share& share : shares(k, u))
        to[share.unknown] += share.factor * batch[u * lanes + k - first];
}

void SparseModel::clear_gradient() { std::fill(gradient_.begin(), gradient_.end(), 0.0); }

void SparseModel::add_gradient(int batch, const double* gradient) {
  spread(gradient_, batch * lanes, std::min(elements_, (batch + 1) * lanes), gradient);
}

void SparseModel::gather(DiscreteAction& action, const Path& path, bool hessian) {
  clear_gradient();
  if (hessian) {
    std::fill(by_duration_.begin(), by_duration_.end(), 0.0);
    corner_ = 0;
  }
  action.visit(path, hessian, [&](int batch, const BatchValues& values) {
    const int first = batch * lanes, last = std::min(elements_, first + lanes);
    add_gradient(batch, values.gradient);
    if (!hessian) return;
    for (int k = first; k < last; ++k)
      for (int s = source_start_[k]; s < source_start_[k + 1]; ++s)
        matrix_.values()[s] = sources_[s].factor * values.entries[sources_[s].group];
    if (!free_duration_) return;
    spread(by_duration_, first, last, values.border);
    for (int k = first; k < last; ++k) corner_ += values.corner[k - first];
  });
  slope_ = action.slope_duration();
}

/// Phases in the unknowns: nodes, and what is free of the ends.
void SparseModel::hold_phases() {
  const int count = phases_ ? phases_->count : 0, nodes = (elements_ - 1) * n_;
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(unknowns_, count);
  for (int j = 0; j < count; ++j) {
    const std::span<const double> direction = phases_->direction(j);
    for (int k = 0; k < nodes; ++k) held(k, j) = direction[n_ + k];
    for (const Triplet& z : ends_->z)
      held(nodes + z.column, j) += z.value * direction[z.row < n_ ? z.row : nodes + z.row];
  }
  border_.hold(std::move(held));
}

bool SparseModel::evaluate(DiscreteAction& action, const Path& path, const ClosingEquation*) {
  gather(action, path, true);
  if (!action.finite()) return false;
  hold_phases();
  const std::span<double> entries(matrix_.values(), sources_.size());
  double largest = 0;
  for (const double value : entries) largest = std::max(largest, std::abs(value));
  std::fill_n(matrix_.values() + sources_.size(), (elements_ - 1) * n_ + ends_->free, 0.0);
  for (const int u : border_.pinned()) matrix_.values()[sources_.size() + u] += largest;
  if (!matrix_.factor()) return false;
  border_.factor(matrix_, largest, by_duration_);
  return true;
}

void SparseModel::evaluate_gradient(DiscreteAction& action, const Path& path) { gather(action, path, false); }

void SparseModel::solve(const DiscreteAction&, const ClosingEquation* closing, Step& step) {
  right_.resize(unknowns_);
  std::transform(gradient_.begin(), gradient_.end(), right_.begin(), [](double g) { return -g; });
  const bool own_row = closing && !closing->row.empty();
  if (own_row) {
    row_.assign(unknowns_, 0);
    for (int e = 0; e < 2 * n_; ++e)
      for (int s = end_start_[e]; s < end_start_[e + 1]; ++s)
        row_[end_shares_[s].unknown] += closing->row[e] * end_shares_[s].factor;
  }
  const double value = !closing ? 0 : own_row ? closing->value : slope_ + closing->value;
  step.duration =
      border_.solve(matrix_, right_, own_row ? row_ : by_duration_, own_row ? 0 : corner_, -value, refining_);
  const int m = inner_ + 2 * n_, batches = (elements_ + lanes - 1) / lanes;
  step.nodes.assign(static_cast<std::size_t>(elements_ + 1) * n_, 0);
  step.inner.assign(static_cast<std::size_t>(batches) * m * lanes, 0);
  for (int k = 0; k < elements_; ++k)
    for (int u = 0; u < m; ++u) {
      double value = 0;
      for (const Share& share : shares(k, u)) value += share.factor * right_[share.unknown];
      step.inner[(static_cast<std::size_t>(k / lanes) * m + u) * lanes + k % lanes] = value;
      if (u >= inner_) step.nodes[static_cast<std::size_t>(k) * n_ + u - inner_] = value;
    }
}

void SparseModel::respond(DiscreteAction& action, const ClosingEquation* closing,
                          std::span<const double> load, Step& step) {
  clear_gradient();
  const std::size_t nodes = static_cast<std::size_t>(elements_ - 1) * n_;
  for (std::size_t k = 0; k < nodes; ++k) gradient_[k] = -load[k + n_];
  slope_ = 0;
  const ClosingEquation homogeneous{closing ? closing->row : std::vector<double>{}, 0};
  solve(action, closing ? &homogeneous : nullptr, step);
}

}  // namespace extremal
