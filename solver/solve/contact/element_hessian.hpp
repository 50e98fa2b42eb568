#pragma once

#include <Eigen/Core>

#include "system/lagrangian.hpp"

/// \file Second derivatives of elements of the midpoint rule.

namespace extremal {

/// The second derivatives of h L by the ends of an element: (a, a), (b, a) and (b, b).
struct ElementHessian {
  Eigen::MatrixXd aa, ba, bb;
};

/// `kinetic_only`: so much of the kinetic part is added.
inline ElementHessian element_hessian(const PointValues& l, double h, int n, double kinetic_only) {
  using Square = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  const Square qq(l.qq.data(), n, n), vq(l.vq.data(), n, n), vv(l.vv.data(), n, n);
  const Eigen::MatrixXd mass = (1 + kinetic_only) / h * vv, mixed = 0.5 * vq, rest = 0.25 * h * qq;
  return {rest - mixed - mixed.transpose() + mass, rest - mixed.transpose() + mixed - mass,
          rest + mixed + mixed.transpose() + mass};
}

/// Second derivatives of h L by the length h: twice, and by the ends of the element.
struct ElementStretch {
  double second = 0;
  Eigen::VectorXd by_start, by_end;
};

/// With q' = (q_b − q_a)/h: ∂(h L)/∂h = L − q'·∂L/∂q'.
inline ElementStretch element_stretch(const PointValues& l, const Eigen::VectorXd& v, double h) {
  using Square = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  const Eigen::Index n = v.size();
  const Square vq(l.vq.data(), n, n), vv(l.vv.data(), n, n);
  const Eigen::VectorXd across = vv * v / h,
                        along =
                            0.5 * (Eigen::Map<const Eigen::VectorXd>(l.dq.data(), n) - vq.transpose() * v);
  return {v.dot(across), along + across, along - across};
}

}  // namespace extremal
