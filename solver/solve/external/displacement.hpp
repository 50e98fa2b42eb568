#pragma once

#include <Eigen/Sparse>
#include <span>
#include <vector>

#include "solve/newton/equations.hpp"

namespace extremal {

/// F(z) = 0 for solvers of any kind: z is the displacement of the unknowns from a path, that of the duration
/// last where it is free. F is δS_h by the square root of the time of each unknown, so that |F|² is about
/// the integral of the squared force that an extremal would not need, and the equation that closes the
/// duration.
class Displacement {
 public:
  /// From `path`, which is kept by reference: it is at the displacement evaluated last.
  Displacement(const Problem& problem, const ElementTables& tables, Path& path);

  int size() const { return equations_.unknowns() + (problem_.duration.free ? 1 : 0); }

  /// F and, where asked for, F' at z. False if they are not finite or the duration is not positive.
  bool evaluate(std::span<const double> z, bool derivatives);
  const Eigen::VectorXd& values() const { return values_; }
  /// F'; its pattern is always the same.
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& derivatives() const { return derivatives_; }

 private:
  void displace(std::span<const double> z);
  void assemble(const ClosingEquation* closing);

  const Problem& problem_;
  Path& path_;
  Path start_;
  DiscreteAction action_;
  Equations equations_;
  Step step_;
  std::vector<double> entries_, row_, weights_;
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::VectorXd values_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> derivatives_;
};

}  // namespace extremal
