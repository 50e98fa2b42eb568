#include "solve/newton/extended_system.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "linear/equilibration.hpp"
#include "solve/newton/limits.hpp"

namespace extremal {

using namespace limits::extended_system;

namespace {

TwoDoubles scaled(TwoDoubles x, double by) { return extended_arithmetic().multiply(x, {by, 0}); }
TwoDoubles negative(TwoDoubles x) { return {-x.high, -x.low}; }

/// A power of two near x, by which products are exact; 1 for zero.
double power_near(double x) { return x > 0 && std::isfinite(x) ? std::exp2(-std::round(std::log2(x))) : 1; }

}  // namespace

void ExtendedSystem::reset(const EndMap& ends, int elements, int coordinates, bool free_duration) {
  ends_ = &ends;
  n_ = coordinates;
  elements_ = elements;
  free_ = ends.free;
  free_duration_ = free_duration;
}

/// Blocks by (q_a, q_b) from those by (q_a, Δ).
void ExtendedSystem::assemble_chain(const ExtendedVariation& variation) {
  const std::size_t n = n_;
  const ExtendedRows& s = variation.condensed();
  chain_.reset(elements_ - 1, n_);
  for (ExtendedRows* block : {&first_, &last_, &first_lower_, &last_lower_}) block->reset(n, n);
  const auto add = [n](ExtendedRows& to, std::size_t row, const ExtendedRows& from, std::size_t at,
                       std::size_t column, double sign) {
    to.add_scaled(n, {sign, 0}, from.high(at) + column, from.low(at) + column, row);
  };
  for (int k = 0; k < elements_; ++k) {
    const bool starts = k == 0, ends = k + 1 == elements_;
    ExtendedRows &left = starts ? first_ : chain_.diagonal(), &right = ends ? last_ : chain_.diagonal(),
                 &below = starts ? first_lower_
                          : ends ? last_lower_
                                 : chain_.lower();
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t q = 2 * n * k + a, delta = q + n;
      const std::size_t l = starts ? a : (k - 1) * n + a, r = ends ? a : k * n + a,
                        b = starts || ends ? a : (k - 1) * n + a;
      add(left, l, s, q, 0, 1);
      add(left, l, s, q, n, -1);
      add(left, l, s, delta, 0, -1);
      add(left, l, s, delta, n, 1);
      add(right, r, s, delta, n, 1);
      add(below, b, s, delta, 0, 1);
      add(below, b, s, delta, n, -1);
    }
  }
}

void ExtendedSystem::assemble_border(const NodeEquations& nodes, const PhaseConditions* phases) {
  const std::size_t n = n_, last = chain_.order() - n;
  columns_.reset(chain_.order(), border_);
  corner_.reset(border_, border_);
  for (const Triplet& z : ends_->z) {
    const bool starts = z.row < n_;
    const std::size_t e = starts ? z.row : z.row - n_;
    for (std::size_t i = 0; i < n; ++i)
      columns_.add(starts ? i : last + i, z.column,
                   scaled(starts ? first_lower_.at(i, e) : last_lower_.at(e, i), z.value));
    for (const Triplet& w : ends_->z) {
      if ((w.row < n_) != starts) continue;
      const ExtendedRows& block = starts ? first_ : last_;
      corner_.add(z.column, w.column, scaled(block.at(e, starts ? w.row : w.row - n_), z.value * w.value));
    }
  }
  const auto add_column = [&](std::size_t column, const double* along) {
    for (std::size_t k = 0; k < columns_.rows(); ++k) columns_.set(k, column, {along[n + k], 0});
    for (const Triplet& z : ends_->z) {
      const TwoDoubles part{z.value * along[end_index(z.row)], 0};
      corner_.add(z.column, column, part);
      corner_.add(column, z.column, part);
    }
  };
  if (free_duration_) {
    add_column(free_, nodes.border.data());
    corner_.set(free_, free_, {nodes.corner, 0});
  }
  for (int j = 0; phases && j < phases->count; ++j)
    add_column(free_ + free_duration_ + j, phases->direction(j).data());
}

/// D − R A⁻¹ C.
ExtendedRows ExtendedSystem::schur(const ExtendedRows& rows) const {
  ExtendedRows result = corner_;
  for (std::size_t k = 0; k < rows.rows(); ++k)
    for (int i = 0; i < border_; ++i)
      if (const TwoDoubles by = negative(rows.at(k, i)); by.high != 0)
        result.add_scaled(border_, by, solved_.high(k), solved_.low(k), i);
  return result;
}

bool ExtendedSystem::factor(const ExtendedVariation& variation, const NodeEquations& nodes,
                            const ClosingEquation* closing, const PhaseConditions* phases) {
  border_ = free_ + free_duration_ + (phases ? phases->count : 0);
  own_row_ = closing && !closing->row.empty();
  assemble_chain(variation);
  if (!chain_.factor()) return false;
  if (border_ == 0) return true;
  assemble_border(nodes, phases);
  solved_ = columns_;
  chain_.solve(solved_);
  rows_ = columns_;
  ExtendedRows whole = corner_;
  if (own_row_) {
    for (std::size_t k = 0; k < rows_.rows(); ++k) rows_.set(k, free_, {});
    for (int j = 0; j < border_; ++j) whole.set(free_, j, {});
    for (const Triplet& z : ends_->z) whole.add(free_, z.column, {closing->row[z.row] * z.value, 0});
    whole.set(free_, free_, {closing->by_duration, 0});
    std::swap(whole, corner_);
  }
  lu_ = schur(rows_);
  if (own_row_) std::swap(whole, corner_);
  return factor_corner();
}

/// LU with complete pivoting of the scaled matrix, as far as pivots are not null: directions that depend on
/// each other may be held.
bool ExtendedSystem::factor_corner() {
  const std::size_t m = border_;
  row_units_.assign(m, 1);
  column_units_.assign(m, 1);
  row_at_.resize(m);
  column_at_.resize(m);
  const auto scale = [&](std::size_t i, std::size_t j, double by) {
    lu_.set(i, j, {lu_.high(i)[j] * by, lu_.low(i)[j] * by});
  };
  for (int pass = 0; pass < equilibrations; ++pass)
    for (std::size_t i = 0; i < m; ++i) {
      double row = 0, column = 0;
      for (std::size_t j = 0; j < m; ++j) row = std::max(row, std::abs(lu_.high(i)[j]));
      const double by_row = power_near(row);
      for (std::size_t j = 0; j < m; ++j) scale(i, j, by_row);
      for (std::size_t j = 0; j < m; ++j) column = std::max(column, std::abs(lu_.high(j)[i]));
      const double by_column = power_near(column);
      for (std::size_t j = 0; j < m; ++j) scale(j, i, by_column);
      row_units_[i] *= by_row;
      column_units_[i] *= by_column;
    }
  for (std::size_t i = 0; i < m; ++i) row_at_[i] = column_at_[i] = static_cast<int>(i);
  rank_ = 0;
  for (std::size_t p = 0; p < m; ++p) {
    std::size_t row = p, column = p;
    for (std::size_t i = p; i < m; ++i)
      for (std::size_t j = p; j < m; ++j)
        if (!(std::abs(lu_.high(i)[j]) <= std::abs(lu_.high(row)[column]))) row = i, column = j;
    lu_.swap(p, row);
    std::swap(row_at_[p], row_at_[row]);
    for (std::size_t i = 0; i < m && column != p; ++i) {
      std::swap(lu_.high(i)[p], lu_.high(i)[column]);
      std::swap(lu_.low(i)[p], lu_.low(i)[column]);
    }
    std::swap(column_at_[p], column_at_[column]);
    const TwoDoubles pivot = lu_.at(p, p);
    if (!std::isfinite(pivot.high)) return false;
    if (std::abs(pivot.high) <= null_pivot) return true;
    rank_ = static_cast<int>(p) + 1;
    for (std::size_t i = p + 1; i < m; ++i) {
      const TwoDoubles by = extended_arithmetic().divide(lu_.at(i, p), pivot);
      lu_.set(i, p, by);
      lu_.add_scaled(m - p - 1, negative(by), lu_.high(p) + p + 1, lu_.low(p) + p + 1, i, p + 1);
    }
  }
  return true;
}

void ExtendedSystem::solve_corner(ExtendedRows& x) const {
  const std::size_t m = border_, rank = rank_;
  ExtendedRows y;
  y.reset(m, 1);
  for (std::size_t i = 0; i < rank; ++i) {
    const double unit = row_units_[row_at_[i]];
    const TwoDoubles value = x.at(row_at_[i], 0);
    y.set(i, 0, {value.high * unit, value.low * unit});
  }
  for (std::size_t i = 0; i < rank; ++i)
    for (std::size_t j = 0; j < i; ++j) y.add_scaled(1, negative(lu_.at(i, j)), y.high(j), y.low(j), i);
  for (std::size_t i = rank; i-- > 0;) {
    for (std::size_t j = i + 1; j < rank; ++j)
      y.add_scaled(1, negative(lu_.at(i, j)), y.high(j), y.low(j), i);
    y.set(i, 0, extended_arithmetic().divide(y.at(i, 0), lu_.at(i, i)));
  }
  for (std::size_t i = 0; i < m; ++i) {
    const double unit = column_units_[column_at_[i]];
    x.set(column_at_[i], 0, {y.at(i, 0).high * unit, y.at(i, 0).low * unit});
  }
}

void ExtendedSystem::solve(const Load& load, const ClosingEquation* closing, Step& step) const {
  const std::size_t n = n_, inner = chain_.order(), last = static_cast<std::size_t>(elements_) * n;
  ExtendedRows x, small;
  x.reset(inner, 1);
  small.reset(border_, 1);
  for (std::size_t k = 0; k < inner; ++k) x.set(k, 0, negative(load.nodes.at(n + k, 0)));
  for (const Triplet& z : ends_->z)
    small.add(z.column, 0, scaled(load.nodes.at(end_index(z.row), 0), -z.value));
  if (free_duration_) {
    small.add(free_, 0, {-closing->value, 0});
    if (!own_row_) small.add(free_, 0, {-load.on_duration, 0});
  }
  chain_.solve(x);
  for (std::size_t k = 0; k < inner && border_ > 0; ++k)
    for (int i = 0; i < border_; ++i)
      if (const TwoDoubles by = negative(rows_.at(k, i)); by.high != 0)
        small.add_scaled(1, by, x.high(k), x.low(k), i);
  if (border_ > 0) solve_corner(small);
  for (std::size_t k = 0; k < inner; ++k)
    for (int i = 0; i < border_; ++i)
      x.add_scaled(1, negative(small.at(i, 0)), solved_.high(k) + i, solved_.low(k) + i, k);
  const std::size_t size = last + n;
  ExtendedRows whole;
  whole.reset(size, 1);
  for (std::size_t k = 0; k < inner; ++k) whole.set(n + k, 0, x.at(k, 0));
  for (const Triplet& z : ends_->z) whole.add(end_index(z.row), 0, scaled(small.at(z.column, 0), z.value));
  step.nodes.assign(whole.high(0), whole.high(0) + size);
  step.nodes_low.assign(whole.low(0), whole.low(0) + size);
  step.duration = free_duration_ ? small.high(free_)[0] : 0;
}

/// Sylvester's law: that of the chain and of its Schur complement. A border of r directions adds r negative
/// eigenvalues to those across them, and as many positive ones.
Inertia ExtendedSystem::inertia(double threshold, VariedBy by) const {
  Inertia result = chain_.inertia();
  const int held = border_ - free_ - free_duration_;
  std::vector<int> used;
  for (int i = 0; i < border_; ++i)
    if (by == VariedBy::path_and_duration || !(free_duration_ && i == free_)) used.push_back(i);
  if (used.empty()) return result;
  const ExtendedRows whole = schur(columns_);
  Eigen::MatrixXd s(std::ssize(used), std::ssize(used));
  for (std::size_t i = 0; i < used.size(); ++i)
    for (std::size_t j = 0; j < used.size(); ++j)
      s(i, j) = 0.5 * (whole.high(used[i])[used[j]] + whole.high(used[j])[used[i]]);
  const Eigen::VectorXd inverse = equilibration(s.cwiseAbs()).cwiseInverse();
  s = (inverse.asDiagonal() * s * inverse.asDiagonal()).eval();
  for (const double value : symmetric_eigenvalues(s))
    ++(value > threshold ? result.positive : value < -threshold ? result.negative : result.zero);
  const int negative = std::max(result.negative, held), positive = std::max(result.positive, held);
  result.zero -= negative - result.negative + positive - result.positive;
  result.negative = negative - held;
  result.positive = positive - held;
  result.zero += held;
  return result;
}

}  // namespace extremal
