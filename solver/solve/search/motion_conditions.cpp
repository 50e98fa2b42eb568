#include "solve/search/motion_conditions.hpp"

#include <algorithm>
#include <numeric>

namespace extremal {

namespace {

using Eigen::MatrixXd;
using Vector = MotionConditions::Vector;
using PivotedLU = Eigen::FullPivLU<MatrixXd>;

/// Columns in the order of their pivots.
std::vector<int> order_of(const PivotedLU& elimination) {
  const auto& columns = elimination.permutationQ().indices();
  return {columns.data(), columns.data() + columns.size()};
}

}  // namespace

MotionConditions::MotionConditions(const Problem& problem) {
  const int n = problem.coordinates(), rows = problem.boundary.rows, all = 2 * n;
  MatrixXd start = MatrixXd::Zero(all, all), end = MatrixXd::Zero(all, all);
  Vector value = Vector::Zero(all);
  for (const Triplet& entry : problem.boundary.matrix)
    (entry.column < n ? start : end)(entry.row, entry.column % n) += entry.value;
  for (int row = 0; row < rows; ++row) value[row] = problem.boundary.value[row];
  // The variation of an end left free leaves −p(0) and p(T), less what is given, without work.
  const std::vector<double>& momenta = problem.boundary.momenta;
  for (const Triplet& entry : problem.ends.z) {
    const bool first = entry.row < n;
    const double coefficient = first ? -entry.value : entry.value;
    (first ? start : end)(rows + entry.column, n + entry.row % n) += coefficient;
    if (!momenta.empty()) value[rows + entry.column] += coefficient * momenta[entry.row];
  }

  const PivotedLU of_end(end.transpose());
  const std::vector<int> conditions = order_of(of_end);
  const auto count = static_cast<int>(of_end.rank());
  const std::vector<int> remaining(conditions.begin(), conditions.begin() + count);
  at_start_ = start(remaining, Eigen::all);
  at_end_ = end(remaining, Eigen::all);
  wanted_ = value(remaining);

  base_ = Vector::Zero(all);
  entries_.resize(all);
  std::iota(entries_.begin(), entries_.end(), 0);
  std::vector<int> determined;
  MatrixXd weights = MatrixXd::Zero(0, count);
  if (count < all) {
    const MatrixXd without_end = of_end.kernel().transpose();
    const MatrixXd relation = without_end * start;
    const PivotedLU of_start(relation);
    entries_ = order_of(of_start);
    determined.assign(entries_.begin(), entries_.end() - count);
    entries_.erase(entries_.begin(), entries_.end() - count);
    std::ranges::sort(entries_);
    const PivotedLU square(relation(Eigen::all, determined));
    weights = -square.solve(MatrixXd(relation(Eigen::all, entries_)));
    base_(determined) = square.solve(without_end * value);
  }
  free_ = MatrixXd::Zero(all, count);
  for (int k = 0; k < count; ++k) free_(entries_[k], k) = 1;
  for (std::size_t k = 0; k < determined.size(); ++k) free_.row(determined[k]) = weights.row(k);
}

Vector MotionConditions::unknown(const Vector& start) const { return start(entries_); }

}  // namespace extremal
