#include "solve/external/displacement.hpp"

#include <cmath>

#include "solve/newton/iteration.hpp"

namespace extremal {

Displacement::Displacement(const Problem& problem, const ElementTables& tables, Path& path)
    : problem_(problem), path_(path), start_(path) {
  action_.reset(*problem.lagrangian, tables, path.elements(), problem.duration.free, Condense::nothing);
  action_.give_momenta(problem.boundary.momenta);
  action_.give_costs(problem.boundary.costs);
  equations_.reset(problem, tables, path.elements());
  equations_.list_entries();
  entries_.resize(equations_.rows().size());
  weights_.resize(equations_.unknowns());
  equations_.share_time(path, weights_);
  for (double& w : weights_) w = 1 / std::sqrt(w);
  values_.resize(size());
  derivatives_.resize(size(), size());
}

void Displacement::displace(std::span<const double> z) {
  equations_.expand(z.first(equations_.unknowns()), step_);
  path_.copy_values(start_);
  path_.add(step_.nodes, step_.inner, 1);
  path_.set_duration(start_.duration() + (problem_.duration.free ? z.back() : 0));
  path_.load_ends();
}

bool Displacement::evaluate(std::span<const double> z, bool derivatives) {
  displace(z);
  if (!(path_.duration() > 0)) return false;
  equations_.evaluate(action_, path_, derivatives ? std::span<double>(entries_) : std::span<double>());
  if (!action_.finite()) return false;
  const int count = equations_.unknowns();
  for (int u = 0; u < count; ++u) values_[u] = weights_[u] * equations_.gradient()[u];
  ClosingEquation equation;
  const ClosingEquation* const closing = closing_equation(problem_, path_, equation);
  if (closing) values_[count] = closing->value + (closing->row.empty() ? equations_.slope_duration() : 0);
  if (derivatives) assemble(closing);
  return values_.allFinite();
}

void Displacement::assemble(const ClosingEquation* closing) {
  const std::vector<int>&rows = equations_.rows(), &columns = equations_.columns();
  triplets_.clear();
  for (std::size_t e = 0; e < entries_.size(); ++e) {
    triplets_.emplace_back(rows[e], columns[e], weights_[rows[e]] * entries_[e]);
    if (rows[e] != columns[e])
      triplets_.emplace_back(columns[e], rows[e], weights_[columns[e]] * entries_[e]);
  }
  if (closing) {
    const std::vector<double>& by_duration = equations_.by_duration();
    const bool own_row = !closing->row.empty();
    if (own_row) equations_.express_row(closing->row, row_);
    const int count = equations_.unknowns();
    for (int u = 0; u < count; ++u) {
      triplets_.emplace_back(u, count, weights_[u] * by_duration[u]);
      triplets_.emplace_back(count, u, own_row ? row_[u] : by_duration[u]);
    }
    triplets_.emplace_back(count, count, own_row ? 0 : equations_.corner());
  }
  derivatives_.setFromTriplets(triplets_.begin(), triplets_.end());
}

}  // namespace extremal
