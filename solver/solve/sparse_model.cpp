#include "solve/sparse_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

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
  border_.resize(free_duration_ ? unknowns_ : 0);
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
    std::fill(border_.begin(), border_.end(), 0.0);
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
    spread(border_, first, last, values.border);
    for (int k = first; k < last; ++k) corner_ += values.corner[k - first];
  });
  slope_ = action.slope_duration();
}

bool SparseModel::evaluate(DiscreteAction& action, const Path& path, const ClosingEquation*) {
  gather(action, path, true);
  if (!action.finite() || !matrix_.factor()) return false;
  if (free_duration_) {
    solved_ = border_;
    matrix_.solve(solved_.data(), 1);
  }
  return true;
}

void SparseModel::evaluate_gradient(DiscreteAction& action, const Path& path) { gather(action, path, false); }

void SparseModel::solve(const DiscreteAction&, const ClosingEquation* closing, Step& step) {
  right_.resize(unknowns_);
  std::transform(gradient_.begin(), gradient_.end(), right_.begin(), [](double g) { return -g; });
  refining_ ? matrix_.solve(right_.data(), 1) : matrix_.solve_step(right_.data());
  step.duration = 0;
  if (free_duration_) {
    // Rows of the closing equation against the solved right-hand side and the solved border.
    double before = 0, along = 0, value = slope_ + closing->value, corner = corner_;
    if (closing->row.empty()) {
      for (int u = 0; u < unknowns_; ++u) {
        before += border_[u] * right_[u];
        along += border_[u] * solved_[u];
      }
    } else {
      value = closing->value;
      corner = 0;
      for (int e = 0; e < 2 * n_; ++e)
        for (int s = end_start_[e]; s < end_start_[e + 1]; ++s) {
          before += closing->row[e] * end_shares_[s].factor * right_[end_shares_[s].unknown];
          along += closing->row[e] * end_shares_[s].factor * solved_[end_shares_[s].unknown];
        }
    }
    step.duration = (-value - before) / (corner - along);
    for (int u = 0; u < unknowns_; ++u) right_[u] -= solved_[u] * step.duration;
  }
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

/// Across s the form has a negative square less unless sᵀH⁻¹s > 0.
Inertia SparseModel::inertia_beside(double, std::span<const double> null) {
  Inertia result = matrix_.inertia();
  if (null.empty()) return result;
  std::vector<double> load(unknowns_, 0);
  std::copy(null.begin() + n_, null.end() - n_, load.begin());
  std::vector<double> response = load;
  matrix_.solve(response.data(), 1);
  const bool positive = std::inner_product(load.begin(), load.end(), response.begin(), 0.0) > 0;
  --(positive ? result.positive : result.negative);
  ++result.zero;
  return result;
}

}  // namespace extremal
