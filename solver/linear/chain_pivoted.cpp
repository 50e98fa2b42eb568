#include "linear/chain_pivoted.hpp"

#include <algorithm>
#include <cmath>

#include "linear/chain_scale.hpp"

namespace extremal {

namespace {

constexpr double threshold = 0.1;  // u
/// Rows delayed at a time, by rows of a block: where more are, the matrix is noise, and would take long.
constexpr int most_delayed = 8;
constexpr double satisfying = 0.5;  // a 1×1 pivot this good needs no comparison with 2×2 ones

}  // namespace

/// Brings block k of D into the front, behind the rows delayed so far, and the next block's rows behind it.
void PivotedChain::extend(const double* diagonal, const double* coupling, int k, int n) {
  const int kept = k == 0 ? 0 : order_ - n;  // rows delayed; block k is already there as "next" rows
  const int order = kept + n + (coupling ? n : 0);
  std::swap(front_, rest_);
  front_.assign(std::size_t(order) * order, 0.0);
  for (int i = 0; i < order_; ++i)
    std::copy_n(&rest_[std::size_t(i) * order_], order_, &front_[std::size_t(i) * order]);
  order_ = order;
  front_rows_.resize(order);
  const double* const s = &scale_[std::size_t(k) * n];
  for (int i = 0; i < n; ++i) {
    front_rows_[kept + i] = k * n + i;
    for (int j = 0; j < n; ++j) front(kept + i, kept + j) += diagonal[i * n + j] * s[i] * s[j];
    if (!coupling) continue;
    front_rows_[kept + n + i] = (k + 1) * n + i;
    for (int j = 0; j < n; ++j)
      front(kept + n + i, kept + j) = front(kept + j, kept + n + i) = coupling[i * n + j] * s[n + i] * s[j];
  }
  done_ = 0;
}

/// Largest |entry| of a row that is left, besides columns i and j.
double PivotedChain::largest(int row, int i, int j) const {
  const double* const f = &front_[std::size_t(row) * order_];
  double most = 0;
  const auto scan = [&](int from, int to) {
    for (int c = from; c < to; ++c) most = std::max(most, std::abs(f[c]));
  };
  scan(done_, std::min(i, j));
  scan(std::min(i, j) + 1, std::max(i, j));
  scan(std::max(i, j) + 1, order_);
  return most;
}

/// 1 / max |L| of the 2×2 pivot of rows i and j (Duff and Reid's bound).
double PivotedChain::quality(int i, int j) const {
  const double a = front(i, i), b = front(i, j), c = front(j, j);
  const double ci = largest(i, i, j), cj = largest(j, i, j);
  const double multiplier =
      std::max(std::abs(c) * ci + std::abs(b) * cj, std::abs(b) * ci + std::abs(a) * cj);
  const double det = std::abs(a * c - b * b);
  return multiplier > 0 ? det / multiplier : (det > 0 ? HUGE_VAL : 0.0);
}

/// The first 1×1 pivot that satisfies, or else the best of all. Deflates on the way.
PivotedChain::Choice PivotedChain::choose(int summed, double smallest) {
  Choice best;
  for (int i = done_; i < summed; ++i) {
    const double others = largest(i, i, i);
    if (others <= smallest && std::abs(front(i, i)) <= smallest) {
      const double s = scale_[front_rows_[i]];
      front(i, i) += 1;
      deflated_.push_back({front_rows_[i], 1 / (s * s)});
    }
    const double a = std::abs(front(i, i)), ratio = others > 0 ? a / others : (a > 0 ? HUGE_VAL : 0.0);
    if (ratio > best.quality) best = {i, i, ratio};
    if (ratio >= satisfying) return best;
  }
  for (int i = done_; i < summed; ++i) {
    int partner = i;
    double most = 0;
    for (int j = done_; j < summed; ++j)
      if (j != i && std::abs(front(i, j)) > most) most = std::abs(front(i, partner = j));
    if (partner == i) continue;
    if (const double both = quality(i, partner); both > best.quality) best = {i, partner, both};
  }
  return best;
}

void PivotedChain::swap_rows(int i, int j) {
  if (i == j) return;
  std::swap(front_rows_[i], front_rows_[j]);
  std::swap_ranges(&front(i, 0), &front(i, 0) + order_, &front(j, 0));
  for (int r = done_; r < order_; ++r) std::swap(front(r, i), front(r, j));
}

/// Eliminates `count` rows at `done_`; L takes the place of their columns.
void PivotedChain::take_pivot(int count) {
  const int p = done_, q = p + count - 1;
  const double a = front(p, p), c = front(q, q), b = count == 2 ? front(p, q) : 0.0;
  const double det = a * c - b * b;
  const auto count_sign = [&](bool positive) { ++(positive ? inertia_.positive : inertia_.negative); };
  smallest_pivot_ =
      std::min(smallest_pivot_,
               count == 1 ? std::abs(a) : std::abs(det) / std::max({std::abs(a), std::abs(b), std::abs(c)}));
  pivot_.push_back(a);
  coupling_.push_back(b);
  if (count == 2) {
    pivot_.push_back(c);
    coupling_.push_back(0);
    count_sign(det > 0 ? a > 0 : true);
    count_sign(det > 0 ? a > 0 : false);
  } else {
    count_sign(a > 0);
  }
  for (int i = q + 1; i < order_; ++i) {
    const double u = front(i, p), v = front(i, q);
    const double lp = count == 2 ? (c * u - b * v) / det : u / a;
    const double lq = count == 2 ? (a * v - b * u) / det : 0.0;
    double* const row = &front(i, 0);
    const double *const fp = &front(p, 0), *const fq = &front(q, 0);
    if (count == 2)
      for (int j = q + 1; j < order_; ++j) row[j] -= lp * fp[j] + lq * fq[j];
    else if (lp != 0)
      for (int j = q + 1; j < order_; ++j) row[j] -= lp * fp[j];
    row[p] = lp;
    if (count == 2) row[q] = lq;
  }
  if (count == 2) front(q, p) = 0;  // L is the unit matrix within the pivot
  done_ += count;
}

void PivotedChain::eliminate(int summed, double smallest) {
  while (done_ < summed) {
    const Choice best = choose(summed, smallest);
    if (best.i < 0 || (summed < order_ && best.quality < threshold)) return;
    const int partner = best.j == done_ ? best.i : best.j;  // where the first swap leaves it
    swap_rows(done_, best.i);
    if (best.i != best.j) swap_rows(done_ + 1, partner);
    take_pivot(best.i == best.j ? 1 : 2);
  }
}

/// Files the columns of L; what is not eliminated begins the next front.
void PivotedChain::keep_rest(const Stage& stage) {
  for (int p = 0; p < stage.pivots; ++p)
    for (int i = 0; i < order_; ++i) l_.push_back(front(i, p));
  rows_.insert(rows_.end(), front_rows_.begin(), front_rows_.end());
  const int left = order_ - done_;
  for (int i = 0; i < left; ++i) {
    front_rows_[i] = front_rows_[done_ + i];
    for (int j = 0; j < left; ++j) front_[std::size_t(i) * left + j] = front(done_ + i, done_ + j);
  }
  order_ = left;
}

bool PivotedChain::factor(const double* diagonal, const double* lower, int blocks, int n, double smallest) {
  const std::size_t nn = std::size_t(n) * n;
  const auto finite = [](double x) { return std::isfinite(x); };
  inertia_ = {};
  deflated_.clear();
  smallest_pivot_ = HUGE_VAL;
  if (!std::all_of(diagonal, diagonal + blocks * nn, finite) ||
      !std::all_of(lower, lower + (blocks - 1) * nn, finite))
    return false;
  equilibrate(diagonal, lower, blocks, n, scale_);
  stages_.clear(), rows_.clear(), l_.clear(), pivot_.clear(), coupling_.clear();
  order_ = 0;
  for (int k = 0; k < blocks; ++k) {
    extend(diagonal + k * nn, k + 1 < blocks ? lower + k * nn : nullptr, k, n);
    Stage stage = {int(rows_.size()), order_, int(pivot_.size()), 0, l_.size()};
    eliminate(k + 1 < blocks ? order_ - n : order_, smallest);
    stage.pivots = done_;
    keep_rest(stage);
    if (order_ > most_delayed * std::max(n, 8)) return false;
    stages_.push_back(stage);
  }
  inertia_.zero = int(deflated_.size());
  inertia_.positive -= inertia_.zero;  // the pivots that were made from them
  return order_ == 0;
}

void PivotedChain::solve(double* x, int columns) const {
  const auto row = [&](int i) { return x + std::size_t(i) * columns; };
  const auto subtract = [&](int to, double factor, int from) {
    for (int c = 0; c < columns; ++c) row(to)[c] -= factor * row(from)[c];
  };
  const auto scale = [&] {
    for (std::size_t i = 0; i < scale_.size(); ++i)
      for (int c = 0; c < columns; ++c) row(int(i))[c] *= scale_[i];
  };
  scale();
  for (const Stage& s : stages_)
    for (int p = 0; p < s.pivots; ++p)
      for (int i = p + 1; i < s.order; ++i)
        subtract(rows_[s.first_row + i], l_[s.first_entry + std::size_t(p) * s.order + i],
                 rows_[s.first_row + p]);
  for (const Stage& s : stages_)
    for (int p = 0; p < s.pivots; ++p) {
      const double a = pivot_[s.first_pivot + p], b = coupling_[s.first_pivot + p];
      double* const u = row(rows_[s.first_row + p]);
      if (b == 0) {
        for (int c = 0; c < columns; ++c) u[c] /= a;
        continue;
      }
      const double d = pivot_[s.first_pivot + ++p], det = a * d - b * b;
      double* const v = row(rows_[s.first_row + p]);
      for (int c = 0; c < columns; ++c) {
        const double first = (d * u[c] - b * v[c]) / det;
        v[c] = (a * v[c] - b * u[c]) / det;
        u[c] = first;
      }
    }
  for (auto s = stages_.rbegin(); s != stages_.rend(); ++s)
    for (int p = s->pivots - 1; p >= 0; --p)
      for (int i = p + 1; i < s->order; ++i)
        subtract(rows_[s->first_row + p], l_[s->first_entry + std::size_t(p) * s->order + i],
                 rows_[s->first_row + i]);
  scale();
}

}  // namespace extremal
