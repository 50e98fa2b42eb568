#include "action/extended_variation.hpp"

#include <algorithm>

namespace extremal {

namespace {

TwoDoubles parts(const DoubleDouble& x) { return {x.x[0], x.x[1]}; }

}  // namespace

bool ExtendedVariation::suits(const Lagrangian& lagrangian, const SchemeTables& scheme) {
  const bool known = scheme.scheme.quadrature == Quadrature::gauss || scheme.nodal;
  return known && dynamic_cast<const ExtendedHessian*>(&lagrangian) != nullptr;
}

/// Unknowns of element k, and X.
void ExtendedVariation::load(const Path& path, int k) {
  const int lanes = path.lanes();
  const std::size_t n = n_, first = k * n,
                    lane = static_cast<std::size_t>(k / lanes) * (degree_ + 1) * n * lanes + k % lanes;
  for (std::size_t a = 0; a < n; ++a) {
    const std::size_t left = first + a, right = left + n;
    start_[a] = dd_real(path.node(0)[left]) + path.rest(0)[left];
    chord_[a] = (dd_real(path.node(0)[right]) - path.node(0)[left]) +
                (dd_real(path.rest(0)[right]) - path.rest(0)[left]);
  }
  for (std::size_t u = 0; u < deviation_.size(); ++u) deviation_[u] = path.x(0)[lane + u * lanes];
  h_ = dd_real(path.lengths()[k]) * path.duration();
  double* const by_ends = by_ends_.data() + k * fields_.size();
  for (std::size_t u = 0; u < deviation_.size(); ++u)
    for (std::size_t a = 0; a < n; ++a) {
      const double* const field = fields_.data() + u * 2 * n;
      by_ends[u * 2 * n + a] = field[a] + field[n + a];
      by_ends[u * 2 * n + n + a] = field[n + a];
    }
}

/// q, q' and t at point i of element k.
void ExtendedVariation::place(const Path& path, int k, int i) {
  const std::size_t row = static_cast<std::size_t>(i) * (degree_ + 1);
  const DoubleDouble tau = basis_.node(i);
  for (int a = 0; a < n_; ++a) {
    DoubleDouble along = tau * chord_[a], rate = chord_[a];
    for (int j = 1; j < degree_; ++j) {
      const double by = deviation_[static_cast<std::size_t>(j - 1) * n_ + a];
      if (!basis_.nodal || j == i) along += basis_.value[row + j] * by;
      rate += basis_.slope[row + j] * by;
    }
    q_[a] = start_[a] + along;
    v_[a] = rate / h_;
  }
  t_ = path.mesh()[k] * dd_real(path.duration()) + tau * h_;
}

/// forces_ from state_ at point i: with w = h q', ∂(h L_q, L_q') = (h L_qq q + L_qv w, L_vq q + L_vv w/h).
void ExtendedVariation::linearise(const Structure& structure, int i) {
  const std::size_t n = n_, width = 2 * n;
  const DoubleDouble weight = basis_.weight(i);
  const DoubleDouble units[] = {weight * h_, weight, weight / h_};
  forces_.reset(width, width);
  const auto add = [&](std::size_t row, std::size_t column, const DoubleDouble& value) {
    const DoubleDouble& unit = units[(row >= n) + (column >= n)];
    forces_.add_scaled(width, parts(value * unit), state_.high(column), state_.low(column), row);
  };
  for (std::size_t e = 0; e < structure.hessian.size(); ++e) {
    const auto row = static_cast<std::size_t>(structure.hessian[e].row),
               column = static_cast<std::size_t>(structure.hessian[e].column);
    const DoubleDouble& value = rows_[1 + structure.gradient.size() + e];
    add(row, column, value);
    if (row != column) add(column, row, value);
  }
  for (const Triplet& m : structure.mass) add(n + m.row, n + m.column, m.value);
  for (const Triplet& c : structure.gyroscopic) {
    add(n + c.row, c.column, c.value);
    add(c.column, n + c.row, c.value);
  }
}

/// Adds point i to H [X; 1], whose rows by the ends begin at `first` of condensed_.
void ExtendedVariation::add_point(int i, std::size_t first) {
  const std::size_t n = n_, block = 2 * n * n, row = static_cast<std::size_t>(i) * (degree_ + 1);
  const double *const q_high = forces_.high(0), *const q_low = forces_.low(0),
                      *const v_high = forces_.high(n), *const v_low = forces_.low(n);
  condensed_.add_scaled(block, {1, 0}, q_high, q_low, first);
  condensed_.add_scaled(block, parts(basis_.node(i)), q_high, q_low, first + n);
  condensed_.add_scaled(block, {1, 0}, v_high, v_low, first + n);
  for (int j = 1; j < degree_; ++j) {
    const std::size_t to = static_cast<std::size_t>(j - 1) * n;
    if (!basis_.nodal || j == i) inside_.add_scaled(block, parts(basis_.value[row + j]), q_high, q_low, to);
    inside_.add_scaled(block, parts(basis_.slope[row + j]), v_high, v_low, to);
  }
}

void ExtendedVariation::evaluate(const Lagrangian& lagrangian, const ElementTables& tables, const Path& path,
                                 const DiscreteAction& eliminated) {
  const auto& hessian = dynamic_cast<const ExtendedHessian&>(lagrangian);
  const Structure& structure = lagrangian.structure();
  basis_.bind(tables.scheme());
  n_ = path.coordinates();
  degree_ = path.degree();
  elements_ = path.elements();
  const std::size_t n = n_, width = 2 * n, inner = static_cast<std::size_t>(degree_ - 1) * n;
  condensed_.reset(elements_ * width, width);
  by_ends_.resize(elements_ * inner * width);
  fields_.resize(inner * width);
  for (auto* list : {&start_, &chord_, &q_, &v_}) list->resize(n);
  deviation_.resize(inner);
  rows_.resize(lagrangian.rows(Order::hessian));
  for (int k = 0; k < elements_; ++k) {
    eliminated.inner_by_ends(k, fields_);
    load(path, k);
    const double* const by_ends = by_ends_.data() + k * fields_.size();
    const std::size_t first = k * width;
    inside_.reset(inner, width);
    for (int i = 0; i < basis_.points; ++i) {
      const std::size_t row = static_cast<std::size_t>(i) * (degree_ + 1);
      place(path, k, i);
      hessian.evaluate_hessian(q_.data(), v_.data(), t_, rows_.data(), scratch_);
      state_.reset(width, width);
      for (std::size_t a = 0; a < n; ++a) {
        state_.set(a, a, {1, 0});
        state_.set(a, n + a, parts(basis_.node(i)));
        state_.set(n + a, n + a, {1, 0});
      }
      for (int j = 1; j < degree_; ++j) {
        const double* const x = by_ends + static_cast<std::size_t>(j - 1) * n * width;
        if (!basis_.nodal || j == i) state_.add_doubles(n * width, parts(basis_.value[row + j]), x, 0);
        state_.add_doubles(n * width, parts(basis_.slope[row + j]), x, n);
      }
      linearise(structure, i);
      add_point(i, first);
    }
    for (std::size_t u = 0; u < inner; ++u)
      for (std::size_t e = 0; e < width; ++e)
        condensed_.add_scaled(width, {by_ends[u * width + e], 0}, inside_.high(u), inside_.low(u), first + e);
  }
}

void ExtendedVariation::reduce(const std::vector<DoubleDouble>& inner, ExtendedRows& to) const {
  const std::size_t width = 2 * static_cast<std::size_t>(n_),
                    count = static_cast<std::size_t>(degree_ - 1) * n_;
  to.reset(elements_, width);
  for (int k = 0; k < elements_; ++k)
    for (std::size_t u = 0; u < count; ++u)
      to.add_doubles(width, parts(inner[k * count + u]), by_ends_.data() + (k * count + u) * width, k);
}

}  // namespace extremal
