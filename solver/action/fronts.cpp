#include "action/fronts.hpp"

#include <algorithm>

#include "action/elimination_order.hpp"

namespace extremal {

Fronts::Fronts(const ElementShape& shape) : n_(shape.n), width_(shape.functions - 2) {
  const std::vector<PivotGroup> groups = elimination_order(coordinate_graph(shape), width_);
  const int count = static_cast<int>(groups.size());
  fronts_.resize(count);
  views_.resize(count);
  front_of_.resize(n_);
  row_.assign(static_cast<std::size_t>(count) * 2 * n_, -1);
  int next = 0;
  for (int f = 0; f < count; ++f) lay_out(f, groups[f], next);
  ends_ = next;
  for (int f = 0; f < count; ++f) aim(f);
}

/// Numbers the rows of a front and finds a place for its panel.
void Fronts::lay_out(int f, const PivotGroup& group, int& next) {
  Front& front = fronts_[f];
  FrontView& view = views_[f];
  int* const row = row_.data() + static_cast<std::size_t>(f) * 2 * n_;
  std::vector<int> first_column;
  const auto add_inner = [&](int a, int first, Coupling coupling) {
    row[a] = static_cast<int>(front.unknown.size());
    for (int j = 0; j < width_; ++j) {
      front.unknown.push_back(j * n_ + a);
      first_column.push_back(first * width_ + (coupling == Coupling::nodes ? j : 0));
    }
  };
  for (int a : group.pivots) {
    add_inner(a, 0, Coupling::full);
    front_of_[a] = f;
  }
  view.pivots = static_cast<int>(front.unknown.size());
  for (const auto& c : group.inner) add_inner(c.coordinate, c.first, c.coupling);
  for (int side = 0; side < 2; ++side)
    for (const auto& c : group.ends) {
      if (side == 0) row[n_ + c.coordinate] = static_cast<int>(front.unknown.size());
      front.unknown.push_back((width_ + side) * n_ + c.coordinate);
      first_column.push_back(c.first * width_);
    }
  view.rows = static_cast<int>(front.unknown.size());
  first_column.resize(view.rows + 2, 0);
  front.start.resize(first_column.size());
  for (std::size_t i = 0; i < first_column.size(); ++i)
    front.start[i] = *std::min_element(first_column.begin() + i,
                                       first_column.begin() + std::min(i + 4, first_column.size()));
  view.panel = next;
  view.first = f == 0 ? 0 : views_[f - 1].first + views_[f - 1].pivots;
  view.unknown = front.unknown.data();
  view.start = front.start.data();
  next += (view.rows + 2) * view.pivots;
  most_pivots_ = std::max(most_pivots_, view.pivots);
  const double p = view.pivots, below = view.rows - view.pivots;
  work_ += p * (p * p / 6 + p * below / 2 + below * below / 2);
}

int Fronts::row_of(int front, int unknown) const {
  const int* const row = row_.data() + static_cast<std::size_t>(front) * 2 * n_;
  const int function = unknown / n_, a = unknown % n_;
  if (function < width_) return row[a] + function;
  if (function == width_) return row[n_ + a];
  // The ends of the coordinates stand twice, first at τ = 0, then at τ = 1, as the last rows.
  const int rows = views_[front].rows, first = row_of(front, fronts_[front].unknown[rows - 1] - n_);
  return row[n_ + a] + rows - 1 - first;
}

/// Splits the rows of a front by where their columns go.
void Fronts::aim(int f) {
  Front& front = fronts_[f];
  FrontView& view = views_[f];
  const int inner = width_ * n_;
  const auto target_of = [&](int i) {
    const int unknown = front.unknown[i];
    return unknown < inner ? front_of_[unknown % n_] : count();
  };
  // All offsets first, since they move while they are appended to.
  std::vector<int> at;
  for (int begin = view.pivots, end; begin < view.rows; begin = end) {
    const int g = target_of(begin);
    for (end = begin; end < view.rows && target_of(end) == g;) ++end;
    front.target.push_back({begin, end, nullptr, nullptr});
    at.push_back(static_cast<int>(front.offsets.size()));
    for (int i = begin; i < view.rows; ++i)
      front.offsets.push_back(g == count() ? (front.unknown[i] - inner) * 2 * n_
                                           : row_of(g, front.unknown[i]) * views_[g].pivots);
    for (int vector = 0; vector < 2; ++vector)
      front.offsets.push_back(g == count() ? (2 * n_ + vector) * 2 * n_
                                           : (views_[g].rows + vector) * views_[g].pivots);
    for (int i = begin; i < end; ++i)
      front.offsets.push_back(g == count() ? ends_ + front.unknown[i] - inner
                                           : views_[g].panel + row_of(g, front.unknown[i]));
  }
  for (std::size_t t = 0; t < at.size(); ++t) {
    front.target[t].row = front.offsets.data() + at[t];
    front.target[t].column = front.target[t].row + (view.rows + 2 - front.target[t].begin);
  }
  view.targets = static_cast<int>(front.target.size());
  view.target = front.target.data();
}

int Fronts::place(int i, int j) const {
  const int inner = width_ * n_;
  if (i >= inner && j >= inner) return ends_ + (std::max(i, j) - inner) * 2 * n_ + std::min(i, j) - inner;
  const int of_i = i < inner ? front_of_[i % n_] : count(), of_j = j < inner ? front_of_[j % n_] : count();
  const int f = std::min(of_i, of_j), row_i = row_of(f, i), row_j = row_of(f, j);
  return views_[f].panel + std::max(row_i, row_j) * views_[f].pivots + std::min(row_i, row_j);
}

}  // namespace extremal
