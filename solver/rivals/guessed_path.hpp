#pragma once

#include <Eigen/Dense>

#include "problem/problem.hpp"

/// \file The guess of a problem as a path that shooting can start from.

namespace extremal {

/// The guess, or a line or a constant where there is none, moved linearly so that its ends meet the relation.
class GuessedPath {
 public:
  /// `problem` must outlive it.
  explicit GuessedPath(const Problem& problem);

  Eigen::VectorXd at(double tau) const;     ///< q at t = tau T
  Eigen::VectorXd slope(double tau) const;  ///< dq/dtau

 private:
  const Problem& problem_;
  Eigen::Index n_;
  Eigen::VectorXd shift_;  ///< of q(0) and q(T)
};

}  // namespace extremal
