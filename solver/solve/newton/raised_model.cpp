#include "solve/newton/raised_model.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "action/rule.hpp"
#include "linear/dense.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Inverse of ∫ φ_i'φ_j' over the inner functions of an element.
Matrix inverse_stiffness(const SchemeTables& scheme) {
  const int inner = scheme.degree - 1;
  const Matrix all = Eigen::Map<const Matrix>(scheme.stiffness.data(), scheme.functions, scheme.functions);
  return extremal::inverse(all.topLeftCorner(inner, inner));
}

/// to[k] += factor · from[k], k < count.
void add(double* to, double factor, const double* from, int count) {
  for (int k = 0; k < count; ++k) to[k] += factor * from[k];
}

}  // namespace

bool RaisedModel::suits(const ElementTables& tables) {
  const ElementShape& shape = tables.shape();
  if (!shape.velocity_free || shape.mass_count != shape.n) return false;
  return std::all_of(shape.mass, shape.mass + shape.mass_count,
                     [](const EntryView& m) { return m.row == m.column && m.value != 0; });
}

void RaisedModel::reset(const Problem& problem, const ElementTables& tables, int elements) {
  const int lanes = simd_lanes();
  n_ = tables.coordinates();
  elements_ = elements;
  const SchemeTables &scheme = tables.scheme(), &low_scheme = low_tables_.scheme();
  inner_ = scheme.degree - 1;
  low_inner_ = low_scheme.degree - 1;
  mass_.resize(n_);
  const ElementShape& shape = tables.shape();
  for (int e = 0; e < shape.mass_count; ++e) mass_[shape.mass[e].row] = 1 / shape.mass[e].value;
  down_ = interpolation_matrix(scheme.degree, low_scheme.lobatto);
  const std::vector<double> nodal = interpolation_matrix(low_scheme.degree, scheme.lobatto);
  const Matrix up =
      Eigen::Map<const Matrix>(nodal.data(), inner_ + 2, low_inner_ + 2).block(1, 1, inner_, low_inner_);
  const Matrix rest = inverse_stiffness(scheme) - up * inverse_stiffness(low_scheme) * up.transpose();
  up_.assign(up.data(), up.data() + up.size());
  rest_.assign(rest.data(), rest.data() + rest.size());
  low_action_.reset(*problem.lagrangian, low_tables_, elements, problem.duration.free, Condense::nothing);
  low_gradient_.resize(static_cast<std::size_t>(low_tables_.unknowns()) * lanes);
  const std::size_t batches = (elements + lanes - 1) / lanes;
  high_step_.resize(batches * inner_ * n_ * lanes);
}

bool RaisedModel::evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) {
  low_.set_phases(phases_);
  low_path_.interpolate_from(path, low_tables_, down_);
  low_action_.end_at(action.deadline());
  const bool factored = low_.evaluate(low_action_, low_path_, closing);
  evaluate_gradient(action, path);
  return factored && action.finite();
}

void RaisedModel::evaluate_gradient(DiscreteAction& action, const Path& path) {
  low_.equations().clear_gradient();
  action.visit(path, false,
               [&](int batch, const BatchValues& values) { restrict_batch(path, batch, values.gradient); });
  low_.equations().add_at_ends(action.nodes.end_parts);
  low_.equations().set_slope_duration(action.slope_duration());
}

/// The gradient by polynomials of low degree, and the step of the rest.
void RaisedModel::restrict_batch(const Path& path, int batch, const double* gradient) {
  const int lanes = path.lanes(), group = n_ * lanes;  // from one node to the next
  double* const low = low_gradient_.data();
  double* const high = high_step_.data() + static_cast<std::size_t>(batch) * inner_ * group;
  std::fill_n(low, low_inner_ * group, 0.0);
  std::fill_n(high, inner_ * group, 0.0);
  std::copy_n(gradient + inner_ * group, 2 * group, low + low_inner_ * group);
  const double* const h = path.h(batch);
  for (int j = 0; j < inner_; ++j) {
    const double* const from = gradient + j * group;
    for (int i = 0; i < low_inner_; ++i) add(low + i * group, up_[j * low_inner_ + i], from, group);
    for (int i = 0; i < inner_; ++i)
      for (int a = 0; a < n_; ++a)
        add(high + i * group + a * lanes, -rest_[i * inner_ + j] * mass_[a], from + a * lanes, lanes);
  }
  for (int k = 0; k < inner_ * n_; ++k)
    for (int lane = 0; lane < lanes; ++lane) high[k * lanes + lane] *= h[lane];
  low_.equations().add_gradient(batch, low);
}

void RaisedModel::solve(const DiscreteAction&, const ClosingEquation* closing, Step& step) {
  low_.set_refining(refining_);
  low_.solve(low_action_, closing, low_step_);
  step.nodes = low_step_.nodes;
  step.duration = low_step_.duration;
  const int lanes = simd_lanes(), group = n_ * lanes, batches = (elements_ + lanes - 1) / lanes;
  step.inner.resize(static_cast<std::size_t>(batches) * (inner_ + 2) * group);
  for (int b = 0; b < batches; ++b) {
    const double* const low = low_step_.inner.data() + static_cast<std::size_t>(b) * (low_inner_ + 2) * group;
    double* const to = step.inner.data() + static_cast<std::size_t>(b) * (inner_ + 2) * group;
    std::copy_n(high_step_.data() + static_cast<std::size_t>(b) * inner_ * group, inner_ * group, to);
    for (int j = 0; j < inner_; ++j)
      for (int i = 0; i < low_inner_; ++i)
        add(to + j * group, up_[j * low_inner_ + i], low + i * group, group);
    std::copy_n(low + low_inner_ * group, 2 * group, to + inner_ * group);
  }
}

Inertia RaisedModel::inertia(double threshold, VariedBy by) {
  Inertia result = low_.inertia(threshold, by);
  const int per_sign = elements_ * (inner_ - low_inner_);
  for (double m : mass_) (m > 0 ? result.positive : result.negative) += per_sign;
  return result;
}

}  // namespace extremal
