#include "study/guess/closing_correction.hpp"

#include <algorithm>

#include "linear/dense.hpp"
#include "motion/dop853.hpp"
#include "motion/extended_flow.hpp"
#include "problem/closing.hpp"
#include "study/guess/limits.hpp"

namespace extremal {

using namespace limits::closing_correction;

namespace {

/// ∂(q, p)(end)/∂(q, p)(start) along a motion; empty where it cannot be followed.
Eigen::MatrixXd variations(const Problem& problem, const MotionPoints& motion, const Deadline& deadline) {
  const std::size_t size = 2 * problem.coordinates();
  ExtendedFlow<Extended> flow(*problem.lagrangian);
  if (!flow.has_variations()) return {};
  DormandPrince<Extended> method(
      [&flow](Extended t, std::span<const Extended> y, std::span<Extended> slope) {
        return flow.slope_with_variations(t, y, slope);
      },
      static_cast<int>(size * (size + 1)));
  std::vector<Extended> y(size * (size + 1), 0);
  for (std::size_t k = 0; k < size; ++k) y[size + k * size + k] = 1;
  IntegrationOptions options;
  options.tolerance = step_error;
  options.block = static_cast<int>(size / 2);
  options.controlled = static_cast<int>(size);
  options.deadline = deadline;
  for (std::size_t k = 0; k + 1 < motion.t.size(); ++k) {
    std::copy_n(motion.y.data() + k * size, size, y.begin());
    Extended t = motion.t[k];
    if (method.advance(t, y, motion.t[k + 1], options) != Integrated::done) return {};
  }
  Eigen::MatrixXd result(size, size);
  std::transform(y.begin() + static_cast<std::ptrdiff_t>(size), y.end(), result.data(),
                 [](Extended x) { return static_cast<double>(x); });
  return result;
}

/// By how much MᵀJM = J is missed, which holds for variations: what M errs by.
double error_of(const Eigen::MatrixXd& m) {
  const Eigen::Index n = m.rows() / 2;
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  j.topRightCorner(n, n).setIdentity();
  j.bottomLeftCorner(n, n) = -j.topRightCorner(n, n);
  return (m.transpose() * j * m - j).norm() / m.norm();
}

}  // namespace

ClosingCorrection::ClosingCorrection(const Problem& problem, const MotionPoints& onwards,
                                     const MotionPoints& back, const Deadline& deadline) {
  const auto size = static_cast<Eigen::Index>(2 * problem.coordinates()), n = size / 2;
  const ClosingMap map = closing_map(problem);
  // Momenta go as the inverse of the transpose.
  Eigen::MatrixXd closing = Eigen::MatrixXd::Zero(size, size);
  closing.topLeftCorner(n, n) = map.r;
  closing.bottomRightCorner(n, n) = inverse(map.r).transpose();
  const Eigen::MatrixXd first = variations(problem, onwards, deadline),
                        second = variations(problem, back, deadline);
  if (first.size() == 0 || second.size() == 0) return;
  PhasePoint start(size);
  std::transform(onwards.y.begin(), onwards.y.begin() + size, start.begin(),
                 [](Extended x) { return static_cast<double>(x); });
  unit_.resize(size);
  unit_.head(n).setConstant(start.head(n).lpNorm<Eigen::Infinity>());
  unit_.tail(n).setConstant(start.tail(n).lpNorm<Eigen::Infinity>());
  const double any = std::max(unit_.maxCoeff(), 0.0);
  for (double& u : unit_)
    if (!(u > 0)) u = any > 0 ? any : 1;
  // Positions have one unit and momenta one, so that the scaled variations are symplectic too.
  const auto scaled = [this](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return unit_.cwiseInverse().asDiagonal() * m * unit_.asDiagonal();
  };
  const Eigen::MatrixXd matrix = scaled(first - second * closing);
  const double error = error_of(scaled(first)) + error_of(scaled(second));
  if (!matrix.allFinite()) return;
  const SingularValues svd = singular_value_decomposition(matrix);
  const Eigen::Index rank = (svd.values.array() > certain * error).count();
  inverse_ = svd.v.leftCols(rank) * svd.values.head(rank).cwiseInverse().asDiagonal() *
             svd.u.leftCols(rank).transpose() * unit_.cwiseInverse().asDiagonal();
}

}  // namespace extremal
