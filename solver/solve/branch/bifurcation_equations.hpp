#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

/// \file The bifurcation equations of a branch point (Lyapunov-Schmidt reduction), and directions of
/// branches.

namespace extremal {

/// A place beside a branch point: a along the known branch, b along the null directions.
struct Departure {
  double along = 0;
  Eigen::VectorXd across;
};

/// With all other equations solved, the forces along the null directions that are left at a and b are, to the
/// order that decides,
///
///     f(a, b) = a A b + B(b, b) + C(b, b, b),
///
/// for the known branch has b = 0, and at a branch point f has no part of first order.
class BifurcationEquations {
 public:
  /// Forces at a place; nothing where the other equations cannot be solved.
  using Forces = std::function<std::optional<Eigen::VectorXd>(const Departure&)>;

  /// By differences over this size; the coefficients err by its square, relative. Nothing where forces are
  /// not known.
  static std::optional<BifurcationEquations> measure(int count, double size, const Forces& forces);

  /// Solutions with |b| = `size`, as far as descents from a grid of directions lead. Where all directions
  /// are solutions, as under a continuous symmetry, some of them.
  std::vector<Departure> solutions() const;
  /// Of forces that have one, the action there less that of the known branch.
  double potential(const Departure& departure) const;

 private:
  Eigen::VectorXd curved(const Eigen::VectorXd& direction) const;
  Eigen::VectorXd missed(const Eigen::VectorXd& direction) const;
  double along(const Eigen::VectorXd& direction) const;
  Eigen::VectorXd descend(Eigen::VectorXd direction, double goal) const;

  double size_ = 0;
  Eigen::MatrixXd linear_;             ///< A
  Eigen::MatrixXd quadratic_, cubic_;  ///< of the monomials of b, a column each
};

}  // namespace extremal
