#pragma once

#include <Eigen/Dense>

/// \file How the paths of a periodic problem close.

namespace extremal {

struct Problem;

/// q(T) = R q(0) + c.
struct ClosingMap {
  Eigen::MatrixXd r;  ///< n × n
  Eigen::VectorXd c;
  bool identity() const { return r.isIdentity(0) && c.isZero(0); }
};

/// Of a periodic problem.
ClosingMap closing_map(const Problem& problem);

}  // namespace extremal
