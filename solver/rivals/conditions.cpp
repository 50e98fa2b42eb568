#include "rivals/conditions.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

EndConditions::EndConditions(const Problem& problem)
    : problem_(problem),
      n_(problem.coordinates()),
      rows_(problem.boundary.rows + problem.ends.free + (problem.duration.free ? 1 : 0)) {}

EndConditions::Values EndConditions::at(const EndStates& ends, const PhaseScales& scales) const {
  Values values;
  values.residual = values.magnitude = Eigen::VectorXd::Zero(rows_);
  values.size = values.residual;
  add_relation(ends, values);
  if (problem_.initial)
    add_initial(ends, values);
  else
    add_natural(ends, values);
  if (problem_.duration.free) add_closing(ends, values);
  for (const Triplet& e : values.derivatives)
    values.size[e.row] += std::abs(e.value) * ((e.column / n_) % 2 == 0 ? scales.q : scales.p);
  values.finite = values.residual.allFinite() && values.size.allFinite();
  return values;
}

void EndConditions::add_relation(const EndStates& ends, Values& values) const {
  const BoundaryRelation& relation = problem_.boundary;
  for (int r = 0; r < relation.rows; ++r) {
    values.residual[r] = -relation.value[r];
    values.magnitude[r] = std::abs(relation.value[r]);
  }
  for (const Triplet& e : relation.matrix) {
    const bool at_end = e.column >= n_;
    const int a = at_end ? e.column - n_ : e.column;
    const double term = e.value * (at_end ? ends.q_end : ends.q_start)[a];
    values.residual[e.row] += term;
    values.magnitude[e.row] += std::abs(term);
    values.derivatives.push_back({e.row, at_end ? 2 * n_ + a : a, e.value});
  }
  // What follows from one row, the end of its largest coefficient, is as exact in others as the terms there;
  // and what follows from those in turn.
  std::vector<double> largest(relation.rows, 0), unknown(2 * static_cast<std::size_t>(n_), 0);
  for (const Triplet& e : relation.matrix) largest[e.row] = std::max(largest[e.row], std::abs(e.value));
  for (int pass = 0; pass < relation.rows; ++pass) {
    for (const Triplet& e : relation.matrix)
      if (std::abs(e.value) == largest[e.row] && e.value != 0)
        unknown[e.column] = std::max(unknown[e.column], values.magnitude[e.row] / largest[e.row]);
    for (const Triplet& e : relation.matrix)
      values.magnitude[e.row] = std::max(values.magnitude[e.row], std::abs(e.value) * unknown[e.column]);
  }
}

/// δS = p(T)·δq(T) − p(0)·δq(0), less that of the momenta that are given, vanishes for every end that the
/// relation leaves free.
void EndConditions::add_natural(const EndStates& ends, Values& values) const {
  for (const Triplet& z : problem_.ends.z) {
    const int row = problem_.boundary.rows + z.column;
    const bool at_end = z.row >= n_;
    const int a = at_end ? z.row - n_ : z.row;
    const double coefficient = at_end ? z.value : -z.value;
    const double term = coefficient * (at_end ? ends.p_end : ends.p_start)[a];
    const std::vector<double>& momenta = problem_.boundary.momenta;
    const double given = momenta.empty() ? 0 : coefficient * momenta[z.row];
    values.residual[row] += term - given;
    values.magnitude[row] += std::abs(term) + std::abs(given);
    values.derivatives.push_back({row, at_end ? 3 * n_ + a : n_ + a, coefficient});
  }
}

/// p(0) is given, and nothing at the end.
void EndConditions::add_initial(const EndStates& ends, Values& values) const {
  for (int a = 0; a < n_; ++a) {
    const int row = problem_.boundary.rows + a;
    const double given = problem_.initial->p[a];
    values.residual[row] = ends.p_start[a] - given;
    values.magnitude[row] = std::abs(ends.p_start[a]) + std::abs(given);
    values.derivatives.push_back({row, n_ + a, 1});
  }
}

/// E = p·q' − L with ∂E/∂q = −∂L/∂q at fixed p, and ∂E/∂p = q'; or the scene's own function of the ends.
void EndConditions::add_closing(const EndStates& ends, Values& values) const {
  const int row = rows_ - 1;
  const auto n = static_cast<std::size_t>(n_);
  if (problem_.duration.energy) {
    Scratch scratch;
    const PointValues at = evaluate_at(*problem_.lagrangian, {ends.q_start.data(), n},
                                       {ends.v_start.data(), n}, 0, Order::gradient, scratch);
    const double kinetic = ends.p_start.dot(ends.v_start);
    values.residual[row] = kinetic - at.value - *problem_.duration.energy;
    values.magnitude[row] = std::abs(kinetic) + std::abs(at.value) + std::abs(*problem_.duration.energy);
    for (int a = 0; a < n_; ++a) {
      values.derivatives.push_back({row, a, -at.dq[a]});
      values.derivatives.push_back({row, n_ + a, ends.v_start[a]});
    }
    return;
  }
  if (!problem_.duration.where) return;  // a period that follows by itself: the condition is none
  std::vector<double> gradient(2 * n);
  values.residual[row] = problem_.duration.where({ends.q_start.data(), n}, {ends.q_end.data(), n}, gradient);
  for (int a = 0; a < n_; ++a) {
    values.derivatives.push_back({row, a, gradient[a]});
    values.derivatives.push_back({row, 2 * n_ + a, gradient[n + a]});
    values.magnitude[row] +=
        std::abs(gradient[a] * ends.q_start[a]) + std::abs(gradient[n + a] * ends.q_end[a]);
  }
}

}  // namespace extremal
