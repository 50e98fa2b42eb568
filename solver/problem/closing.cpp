#include "problem/closing.hpp"

#include "linear/dense.hpp"
#include "problem/problem.hpp"

namespace extremal {

ClosingMap closing_map(const Problem& problem) {
  const int n = problem.coordinates();
  Eigen::MatrixXd start = Eigen::MatrixXd::Zero(n, n), end = start;
  for (const Triplet& entry : problem.boundary.matrix)
    (entry.column < n ? start : end)(entry.row, entry.column % n) += entry.value;
  const Eigen::VectorXd value = Eigen::Map<const Eigen::VectorXd>(problem.boundary.value.data(), n);
  if (end.isIdentity(0)) return {-start, value};
  return {-solved(end, start), solved(end, value)};
}

}  // namespace extremal
