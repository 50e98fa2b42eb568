#include "solve/newton/sparse_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace extremal {

void SparseModel::reset(const Problem& problem, const ElementTables& tables, int elements) {
  equations_.reset(problem, tables, elements);
  phases_ = nullptr;
  ordered_ = false;
}

/// At the first factorisation: the entries may be too many to be listed before the deadline. False if it
/// passes.
bool SparseModel::set_pattern(const Deadline& deadline) {
  if (ordered_) return true;
  if (!equations_.list_entries(deadline)) return false;
  std::vector<int> rows = equations_.rows(), columns = equations_.columns();
  // For the unit vectors of the border.
  for (std::vector<int>* places : {&rows, &columns}) {
    places->resize(places->size() + equations_.nodal());
    std::iota(places->end() - equations_.nodal(), places->end(), 0);
  }
  return ordered_ = matrix_.pattern(equations_.unknowns(), rows, columns, deadline);
}

void SparseModel::hold_phases() {
  const int count = phases_ ? phases_->count : 0;
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(equations_.unknowns(), count);
  for (int j = 0; j < count; ++j)
    equations_.express_direction(phases_->direction(j), {held.col(j).data(), std::size_t(held.rows())});
  border_.hold(std::move(held));
}

bool SparseModel::evaluate(DiscreteAction& action, const Path& path, const ClosingEquation*) {
  if (!set_pattern(action.deadline())) {
    evaluate_gradient(action, path);
    return false;
  }
  const std::span<double> entries(matrix_.values(), equations_.rows().size());
  equations_.evaluate(action, path, entries);
  if (!action.finite()) return false;
  hold_phases();
  double largest = 0;
  for (const double value : entries) largest = std::max(largest, std::abs(value));
  double* const pins = matrix_.values() + entries.size();
  std::fill_n(pins, equations_.nodal(), 0.0);
  for (const int u : border_.pinned()) pins[u] += largest;
  if (!matrix_.factor(action.deadline())) return false;
  border_.factor(matrix_, largest, equations_.by_duration());
  return true;
}

void SparseModel::evaluate_gradient(DiscreteAction& action, const Path& path) {
  equations_.evaluate(action, path, {});
}

void SparseModel::solve(const DiscreteAction&, const ClosingEquation* closing, Step& step) {
  right_.resize(equations_.unknowns());
  std::transform(equations_.gradient().begin(), equations_.gradient().end(), right_.begin(),
                 [](double g) { return -g; });
  const bool own_row = closing && !closing->row.empty();
  if (own_row) equations_.express_row(closing->row, row_);
  const double value = !closing ? 0 : own_row ? closing->value : equations_.slope_duration() + closing->value;
  step.duration = border_.solve(matrix_, right_, own_row ? row_ : equations_.by_duration(),
                                own_row ? closing->by_duration : equations_.corner(), -value, refining_);
  equations_.expand(right_, step);
}

Inertia SparseModel::inertia(double, VariedBy by) {
  const bool with_duration = by == VariedBy::path_and_duration;
  return border_.inertia(matrix_, with_duration ? equations_.by_duration() : std::span<const double>(),
                         equations_.corner());
}

void SparseModel::respond(DiscreteAction& action, const ClosingEquation* closing,
                          std::span<const double> load, Step& step) {
  equations_.load(load);
  ClosingEquation homogeneous = closing ? *closing : ClosingEquation();
  homogeneous.value = 0;
  solve(action, closing ? &homogeneous : nullptr, step);
}

void SparseModel::put_load(DiscreteAction&, const Path& path, const AlignedDoubles& load,
                           double on_duration) {
  const std::size_t batch = load.size() / path.batches();
  equations_.clear_gradient();
  for (int b = 0; b < path.batches(); ++b) equations_.add_gradient(b, load.data() + b * batch);
  equations_.set_slope_duration(on_duration);
}

}  // namespace extremal
