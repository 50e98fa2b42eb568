#include "solve/adapt/scheme_equations.hpp"

#include <algorithm>
#include <cmath>

#include "action/rule.hpp"
#include "solve/adapt/limits.hpp"

namespace extremal {

using namespace limits::scheme_equations;

SchemeEquations::SchemeEquations(const Problem& problem, const ElementTables& tables, int elements,
                                 bool free_times)
    : problem_(problem), elements_(elements), times_(free_times ? elements - 1 + problem.duration.free : 0) {
  action_.reset(*problem.lagrangian, tables, elements, free_times, Condense::nothing);
  action_.give_momenta(problem.boundary.momenta);
  action_.give_costs(problem.boundary.costs);
  equations_.reset(problem, tables, elements);
  equations_.list_entries();
  entries_.resize(equations_.rows().size());
  left_.resize(unknowns());
}

/// ∂S_h/∂t_k less the energy given for t_N.
const SchemeEquations::Vector& SchemeEquations::evaluate(const Path& path) {
  equations_.evaluate(action_, path, entries_);
  std::copy(equations_.gradient().begin(), equations_.gradient().end(), left_.begin());
  if (times_ > 0) equations_.evaluate_lengths(action_, path, lengths_);
  const std::vector<double>& by_length = lengths_.slope;
  for (int k = 1; k <= times_; ++k)
    left_[equations_.unknowns() + k - 1] =
        by_length[k - 1] + (k < elements_ ? -by_length[k] : *problem_.duration.energy);
  if (!action_.finite()) left_.setConstant(NAN);
  return left_;
}

double SchemeEquations::size(const Vector& left, const Path& path) const {
  if (!left.allFinite()) return INFINITY;
  double velocity = 0;
  for (int k = 0; k < elements_; ++k)
    for (int a = 0; a < path.coordinates(); ++a) {
      const double way = path.node(k + 1)[a] - path.node(k)[a];
      velocity = std::max(velocity, std::abs(way) / (path.lengths()[k] * path.duration()));
    }
  const double force = left.head(equations_.unknowns()).lpNorm<Eigen::Infinity>(),
               unequal = left.tail(times_).lpNorm<Eigen::Infinity>(), momentum = action_.momentum_scale();
  return momentum > 0 && velocity > 0 ? std::max(force, unequal / velocity) / momentum : 0;
}

/// In the unknowns of the path, then in times.
SchemeEquations::Sparse SchemeEquations::hessian() const {
  const int first = equations_.unknowns(), size = first + times_;
  std::vector<Eigen::Triplet<double>> places;
  const auto add = [&](int row, int column, double value) {
    places.emplace_back(row, column, value);
    if (row != column) places.emplace_back(column, row, value);
  };
  const auto is_unknown = [&](int k) { return k > 0 && k <= times_; };
  for (std::size_t e = 0; e < entries_.size(); ++e)
    add(equations_.rows()[e], equations_.columns()[e], entries_[e]);
  // h_k = t_{k+1} − t_k.
  for (const Triplet& entry : lengths_.entries)
    for (const int end : {0, 1})
      if (const int k = entry.column + end; is_unknown(k))
        add(entry.row, first + k - 1, end ? entry.value : -entry.value);
  for (int k = 0; k < elements_ && times_ > 0; ++k) {
    const double value = lengths_.corner[k];
    for (const int end : {k, k + 1})
      if (is_unknown(end)) add(first + end - 1, first + end - 1, value);
    if (is_unknown(k) && is_unknown(k + 1)) add(first + k - 1, first + k, -value);
  }
  Sparse matrix(size, size);
  matrix.setFromTriplets(places.begin(), places.end());
  return matrix;
}

/// Steps of the unknowns by steps δx of values at nodes that move with the path, their moves σ_k, and δT:
/// δt_k = σ_k + (t_k/T) δT, δq_k = δx_k + q' σ_k. With c the place of an inner node in its element from a to
/// b, it moves by (1 − c) σ_a + c σ_b, and its deviation from the chord changes by (1 − c)(q' − q'_a) σ_a + c
/// (q' − q'_b) σ_b.
SchemeEquations::Sparse SchemeEquations::moving_with(const Path& path) const {
  const int n = path.coordinates(), s = path.degree(), first = equations_.unknowns();
  Sparse matrix(first + times_, first + times_);
  if (times_ == 0) {
    matrix.setIdentity();
    return matrix;
  }
  const Basis& basis = lobatto_nodal_basis(s);
  std::vector<double> all(static_cast<std::size_t>(elements_) * (s + 1) * n);
  const auto slopes = [&](int k, int j) {
    return all.data() + (static_cast<std::size_t>(k) * (s + 1) + j) * n;
  };
  for (int k = 0; k < elements_; ++k) path.element_slopes(k, basis.derivative, slopes(k, 0));
  const auto at_node = [&](int k, int a) { return 0.5 * (slopes(k - 1, s)[a] + slopes(k, 0)[a]); };
  std::vector<Eigen::Triplet<double>> places;
  for (int u = 0; u < first + times_; ++u) places.emplace_back(u, u, 1);
  for (int k = 1; k < times_ && times_ == elements_; ++k)
    places.emplace_back(first + k - 1, first + elements_ - 1, path.mesh()[k]);
  for (int k = 1; k < elements_; ++k)
    for (int a = 0; a < n; ++a)
      places.emplace_back(equations_.node_unknown(k, a), first + k - 1, at_node(k, a));
  for (int k = 0; k < elements_; ++k)
    for (int j = 1; j < s; ++j)
      for (int a = 0; a < n; ++a) {
        const double c = basis.points[j], v = slopes(k, j)[a];
        const int u = equations_.inner_unknown(k, (j - 1) * n + a);
        if (k > 0) places.emplace_back(u, first + k - 1, (1 - c) * (v - at_node(k, a)));
        if (k + 1 < elements_) places.emplace_back(u, first + k, c * (v - at_node(k + 1, a)));
      }
  matrix.setFromTriplets(places.begin(), places.end());
  return matrix;
}

bool SchemeEquations::factor(const Path& path) {
  if (!left_.allFinite()) return false;
  moving_ = moving_with(path);
  const Sparse matrix = moving_.transpose() * hessian() * moving_;
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int column = 0; column < matrix.cols(); ++column)
    for (Sparse::InnerIterator entry(matrix, column); entry; ++entry) {
      if (entry.row() < column) continue;
      rows.push_back(static_cast<int>(entry.row()));
      columns.push_back(column);
      values.push_back(entry.value());
    }
  matrix_.pattern(static_cast<int>(matrix.cols()), rows, columns);
  std::copy(values.begin(), values.end(), matrix_.values());
  return matrix_.factor();
}

SchemeEquations::Vector SchemeEquations::solve(const Vector& right) {
  Vector step = moving_.transpose() * right;
  matrix_.solve(step.data(), 1);
  return step;
}

bool SchemeEquations::apply(Path& path, const Vector& step, double factor) const {
  const int first = equations_.unknowns();
  const Vector part = factor * step;
  if (!part.allFinite()) return false;
  if (times_ > 0) {
    std::vector<double> moved(elements_ + 1);  // in τ
    for (int k = 1; k < elements_; ++k) moved[k] = part[first + k - 1] / path.duration();
    if (!path.slide(moved, most_stretch)) return false;
  }
  if (times_ == elements_) path.set_duration(path.duration() + part[first + times_ - 1]);
  Step nodes;
  equations_.expand({part.data(), static_cast<std::size_t>(first)}, nodes);
  path.add(nodes.nodes, nodes.inner, 1);
  path.load_ends();
  return path.duration() > 0;
}

double SchemeEquations::product(const Vector& a, const Vector& b, const Path& path, double extent) const {
  const Eigen::Index first = equations_.unknowns();
  const double length = path.duration() / elements_;
  const double of_values = a.head(first).dot(b.head(first)) / (extent * extent);
  const double of_times = a.segment(first, times_).dot(b.segment(first, times_)) / (length * length);
  return of_values / std::max<double>(1, static_cast<double>(first)) + of_times / std::max(1, times_);
}

}  // namespace extremal
