#pragma once

#include <Eigen/Dense>
#include <span>

#include "problem/closing.hpp"
#include "problem/problem.hpp"

/// \file Guesses of closed paths beyond one period.

namespace extremal {

/// q at all t/T: one period later it is R q + c, moved so that q is continuous where the guess does not
/// close.
class ClosedGuess {
 public:
  explicit ClosedGuess(const Problem& problem);
  void at(double tau, std::span<double> q) const;
  /// The guess that begins at this t/T.
  Guess from(double tau) const;

 private:
  int n_;
  Guess guess_;
  ClosingMap map_;
  Eigen::VectorXd start_, end_;
};

}  // namespace extremal
