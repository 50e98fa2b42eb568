#include "solve/newton/equations.hpp"

#include <algorithm>

#include "machine/simd.hpp"

namespace extremal {

void Equations::reset(const Problem& problem, const ElementTables& tables, int elements) {
  tables_ = &tables;
  ends_ = &problem.ends;
  n_ = tables.coordinates();
  elements_ = elements;
  inner_ = tables.inner();
  unknowns_ = nodal() + elements * inner_;
  all_.resize(unknowns_);
  for (int u = 0; u < unknowns_; ++u) all_[u] = {u, 1};
  number_ends();
  costs_ = problem.boundary.costs;
  rows_.clear();
  columns_.clear();
  sources_.clear();
  source_start_.clear();
  gradient_.resize(unknowns_);
  by_duration_.resize(problem.duration.free ? unknowns_ : 0);
}

void Equations::number_ends() {
  end_start_.assign(2 * n_ + 1, 0);
  for (const Triplet& z : ends_->z) ++end_start_[z.row + 1];
  for (int e = 0; e < 2 * n_; ++e) end_start_[e + 1] += end_start_[e];
  end_shares_.resize(ends_->z.size());
  std::vector<int> next(end_start_.begin(), end_start_.end() - 1);
  for (const Triplet& z : ends_->z) end_shares_[next[z.row]++] = {(elements_ - 1) * n_ + z.column, z.value};
}

std::span<const Equations::Share> Equations::shares(int element, int local) const {
  if (local < inner_) return {all_.data() + nodal() + element * inner_ + local, 1};
  const int node = element + (local - inner_) / n_, a = (local - inner_) % n_;
  if (node > 0 && node < elements_) return {all_.data() + (node - 1) * n_ + a, 1};
  const int e = node == 0 ? a : n_ + a;
  return {end_shares_.data() + end_start_[e], static_cast<std::size_t>(end_start_[e + 1] - end_start_[e])};
}

bool Equations::list_entries(const Deadline& deadline) {
  if (!source_start_.empty()) return true;
  const std::size_t most = tables_->entries().row.size() * elements_;
  rows_.reserve(most + nodal());
  columns_.reserve(most + nodal());
  sources_.reserve(most);
  source_start_.assign(1, 0);
  for (int k = 0; k < elements_; ++k) {
    if (deadline.passed()) {
      rows_.clear();
      columns_.clear();
      sources_.clear();
      source_start_.clear();
      return false;
    }
    list_entries_of(k);
  }
  list_entries_of_costs(costs_);
  return true;
}

void Equations::list_entries_of(int element) {
  const ElementTables::Entries& entries = tables_->entries();
  for (std::size_t e = 0; e < entries.row.size(); ++e)
    for (const Share& r : shares(element, entries.row[e]))
      for (const Share& c : shares(element, entries.column[e])) {
        // xᵀHx holds an entry off the diagonal twice: both meet where two unknowns become one.
        const bool twice = entries.row[e] != entries.column[e] && r.unknown == c.unknown;
        rows_.push_back(r.unknown);
        columns_.push_back(c.unknown);
        sources_.push_back(
            {static_cast<int>(e) * lanes_ + element % lanes_, r.factor * c.factor * (twice ? 2 : 1)});
      }
  source_start_.push_back(static_cast<int>(sources_.size()));
}

/// Those of the costs of the ends, after those of the elements.
void Equations::list_entries_of_costs(std::span<const EndCost> costs) {
  end_entries_.clear();
  for (std::size_t end = 0; end < costs.size(); ++end)
    for (std::size_t e = 0; e < costs[end].stiffness.size(); ++e) {
      const int row = static_cast<int>(end) * n_ + static_cast<int>(e) / n_,
                column = static_cast<int>(end) * n_ + static_cast<int>(e) % n_;
      for (int r = end_start_[row]; r < end_start_[row + 1]; ++r)
        for (int c = end_start_[column]; c < end_start_[column + 1]; ++c) {
          if (end_shares_[r].unknown < end_shares_[c].unknown) continue;  // one triangle
          rows_.push_back(end_shares_[r].unknown);
          columns_.push_back(end_shares_[c].unknown);
          end_entries_.push_back(end_shares_[r].factor * end_shares_[c].factor * costs[end].stiffness[e]);
        }
    }
}

/// Adds a vector over local unknowns of elements first … last − 1 (one batch) to one over all unknowns.
void Equations::spread(std::vector<double>& to, int first, int last, const double* batch) const {
  for (int k = first; k < last; ++k)
    for (int u = 0; u < inner_ + 2 * n_; ++u)
      for (const Share& share : shares(k, u))
        to[share.unknown] += share.factor * batch[u * lanes_ + k - first];
}

void Equations::clear_gradient() { std::fill(gradient_.begin(), gradient_.end(), 0.0); }

void Equations::add_at_ends(std::span<const double> parts) {
  for (std::size_t e = 0; e < parts.size(); ++e)
    for (int s = end_start_[e]; s < end_start_[e + 1]; ++s)
      gradient_[end_shares_[s].unknown] += end_shares_[s].factor * parts[e];
}

void Equations::add_gradient(int batch, const double* gradient) {
  spread(gradient_, batch * lanes_, std::min(elements_, (batch + 1) * lanes_), gradient);
}

void Equations::load(std::span<const double> nodes) {
  clear_gradient();
  for (int k = 0; k < (elements_ - 1) * n_; ++k) gradient_[k] = -nodes[k + n_];
  slope_ = 0;
}

void Equations::evaluate(DiscreteAction& action, const Path& path, std::span<double> entries) {
  const bool hessian = !entries.empty();
  clear_gradient();
  if (hessian) {
    std::copy(end_entries_.begin(), end_entries_.end(), entries.begin() + source_start_.back());
    std::fill(by_duration_.begin(), by_duration_.end(), 0.0);
    corner_ = 0;
  }
  action.visit(path, hessian, [&](int batch, const BatchValues& values) {
    const int first = batch * lanes_, last = std::min(elements_, first + lanes_);
    add_gradient(batch, values.gradient);
    if (!hessian) return;
    for (int s = source_start_[first]; s < source_start_[last]; ++s)
      entries[s] = sources_[s].factor * values.entries[sources_[s].group];
    if (by_duration_.empty()) return;
    spread(by_duration_, first, last, values.border);
    for (int k = first; k < last; ++k) corner_ += values.corner[k - first];
  });
  add_at_ends(action.nodes.end_parts);
  slope_ = action.slope_duration();
}

void Equations::evaluate_lengths(DiscreteAction& action, const Path& path, LengthDerivatives& to) const {
  to.slope.resize(elements_);
  to.corner.resize(elements_);
  to.entries.clear();
  action.visit(path, true, [&](int batch, const BatchValues& values) {
    const int first = batch * lanes_, last = std::min(elements_, first + lanes_);
    for (int k = first; k < last; ++k) {
      const int lane = k - first;
      const double scale = path.duration() / path.h(batch)[lane];  // δh_k = (h_k/T) δT
      to.slope[k] = values.slope[lane];
      to.corner[k] = scale * scale * values.corner[lane];
      for (int u = 0; u < inner_ + 2 * n_; ++u)
        for (const Share& share : shares(k, u))
          to.entries.push_back({share.unknown, k, scale * share.factor * values.border[u * lanes_ + lane]});
    }
  });
}

void Equations::share_time(const Path& path, std::span<double> to) const {
  const std::span<const double> mesh = path.mesh();
  const double unit = path.duration() / path.degree();
  for (int k = 1; k < elements_; ++k)
    std::fill_n(to.begin() + (k - 1) * n_, n_, 0.5 * unit * (mesh[k + 1] - mesh[k - 1]));
  const double outer = 0.5 * unit * (mesh[1] + 1 - mesh[elements_ - 1]);
  std::fill_n(to.begin() + (elements_ - 1) * n_, ends_->free, outer);
  for (int k = 0; k < elements_; ++k)
    std::fill_n(to.begin() + nodal() + k * inner_, inner_, unit * (mesh[k + 1] - mesh[k]));
}

void Equations::express_row(std::span<const double> row, std::vector<double>& to) const {
  to.assign(unknowns_, 0);
  for (int e = 0; e < 2 * n_; ++e)
    for (int s = end_start_[e]; s < end_start_[e + 1]; ++s)
      to[end_shares_[s].unknown] += row[e] * end_shares_[s].factor;
}

void Equations::express_direction(std::span<const double> direction, std::span<double> to) const {
  const int inside = (elements_ - 1) * n_;
  std::copy_n(direction.begin() + n_, inside, to.begin());
  std::fill_n(to.begin() + inside, ends_->free, 0.0);
  for (const Triplet& z : ends_->z)
    to[inside + z.column] += z.value * direction[z.row < n_ ? z.row : inside + z.row];
}

void Equations::expand(std::span<const double> x, Step& step) const {
  const int m = inner_ + 2 * n_, batches = (elements_ + lanes_ - 1) / lanes_;
  step.nodes.assign(static_cast<std::size_t>(elements_ + 1) * n_, 0);
  step.inner.assign(static_cast<std::size_t>(batches) * m * lanes_, 0);
  for (int k = 0; k < elements_; ++k)
    for (int u = 0; u < m; ++u) {
      double value = 0;
      for (const Share& share : shares(k, u)) value += share.factor * x[share.unknown];
      step.inner[(static_cast<std::size_t>(k / lanes_) * m + u) * lanes_ + k % lanes_] = value;
      if (u >= inner_) step.nodes[static_cast<std::size_t>(k) * n_ + u - inner_] = value;
    }
}

}  // namespace extremal
