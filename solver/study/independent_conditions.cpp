#include "study/independent_conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "problem/nearby.hpp"
#include "study/limits.hpp"

namespace extremal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The first row, of those of length one, that is a sum of multiples of those before it where `onto` leaves
/// them; -1: there is none. What is zero is one.
int first_dependent(MatrixXd rows, const MatrixXd& onto) {
  rows.rowwise().normalize();
  rows *= onto;
  MatrixXd basis(rows.cols(), 0);
  for (Index k = 0; k < rows.rows(); ++k) {
    VectorXd row = rows.row(k);
    for (int pass = 0; pass < 2; ++pass) row -= basis * (basis.transpose() * row).eval();
    if (!(row.norm() > limits::conditions::dependence)) return static_cast<int>(k);
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = row.normalized();
  }
  return -1;
}

}  // namespace

void check_independent_integrals(const std::vector<Text>& texts, const Problem& problem,
                                 const std::vector<std::shared_ptr<const Lagrangian>>& integrands) {
  const Index count = std::ssize(integrands), wanted = count + limits::conditions::points;
  if (count < 2) return;
  MatrixXd values(count, wanted);
  NearbyPoints points(problem);
  Scratch scratch;
  std::vector<double> q, v;
  Index found = 0;
  for (Index tried = 0; tried < 4 * wanted && found < wanted; ++tried) {
    const double t = points.next(q, v);
    for (Index j = 0; j < count; ++j)
      values(j, found) = evaluate_at(*integrands[j], q, v, t, Order::gradient, scratch).value;
    found += values.col(found).allFinite();
  }
  if (found < wanted) return;
  const int k = first_dependent(values, MatrixXd::Identity(wanted, wanted));
  if (k <= 0) return;
  throw SceneError(
      position(texts[k], 0),
      fmt::format("the integrand of '{}' is made of those of the integrals before it, whose values "
                  "determine or contradict its own; leave it out",
                  texts[k].value));
}

void check_independent_conditions(const std::vector<Text>& texts, const Problem& problem,
                                  const Extension& extension) {
  const Index count = std::ssize(extension.conditions);
  if (count == 0) return;
  const int n = problem.coordinates(), all = n + extension.constants();
  MatrixXd z = MatrixXd::Zero(2 * n, problem.ends.free);
  for (const Triplet& entry : problem.ends.z) z(entry.row, entry.column) += entry.value;
  NearbyPoints points(problem);
  std::vector<double> start, end, v, gradient(2 * static_cast<std::size_t>(all));
  const auto put_constants = [&](std::vector<double>& q) {
    q.insert(q.end(), extension.guess.begin(), extension.guess.end());
    q.resize(all, 0.0);
  };
  int least = -1;
  for (int k = 0; k < limits::conditions::points; ++k) {
    points.next(start, v);
    points.next(end, v);
    put_constants(start);
    put_constants(end);
    MatrixXd slopes(count, 2 * n);
    for (Index j = 0; j < count; ++j) {
      extension.conditions[j].function(start, end, gradient, {});
      for (int a = 0; a < n; ++a) {
        slopes(j, a) = gradient[a];
        slopes(j, n + a) = gradient[all + a];
      }
    }
    if (!slopes.allFinite()) continue;
    const int dependent = first_dependent(slopes, z);
    if (dependent < 0) return;
    least = std::max(least, dependent);
  }
  if (least < 0) return;
  throw SceneError(
      position(texts[least], 0),
      fmt::format("the condition '{}' follows from what else is given at the ends, or contradicts it; "
                  "leave it out",
                  texts[least].value));
}

}  // namespace extremal
