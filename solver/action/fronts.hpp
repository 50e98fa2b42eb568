#pragma once

#include <vector>

#include "action/element.hpp"
#include "action/elimination.hpp"

/// \file Where everything is while the inner unknowns of an element are eliminated.

namespace extremal {

/// The fronts of one scheme and structure. The matrix of an element, a number of groups of eight: the panels
/// of the fronts one after the other, then that of the ends, 2n columns row-major, of whose first 2n rows the
/// lower triangle is used and whose last two are for vectors.
class Fronts {
 public:
  Fronts() = default;
  explicit Fronts(const ElementShape& shape);
  Fronts(const Fronts&) = delete;
  Fronts(Fronts&&) = default;
  Fronts& operator=(Fronts&&) = default;

  int count() const { return static_cast<int>(views_.size()); }
  const FrontView* data() const { return views_.data(); }
  int groups() const { return ends_ + 2 * n_ * (2 * n_ + 2); }  ///< of the whole matrix
  int ends() const { return ends_; }                            ///< place of the matrix of the ends
  int most_pivots() const { return most_pivots_; }
  double work() const { return work_; }  ///< multiplications to eliminate all inner unknowns of an element

  /// Of the entry of two local unknowns that may differ from zero, in either order.
  int place(int i, int j) const;

 private:
  struct Front {
    std::vector<int> unknown, start, offsets;
    std::vector<FrontTarget> target;
  };
  int row_of(int front, int unknown) const;
  void lay_out(int front, const struct PivotGroup& group, int& next);
  void aim(int front);

  int n_ = 0, width_ = 0, ends_ = 0, most_pivots_ = 0;
  double work_ = 0;
  std::vector<Front> fronts_;
  std::vector<FrontView> views_;
  std::vector<int> front_of_;  // of each coordinate's inner unknowns
  std::vector<int> row_;  // fronts × 2n: first row of a coordinate's inner unknowns, row of its first end
};

}  // namespace extremal
