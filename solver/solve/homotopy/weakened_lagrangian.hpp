#pragma once

#include <memory>
#include <vector>

#include "problem/problem.hpp"

/// \file A Lagrangian with weaker nonlinear forces.

namespace extremal {

/// L_λ = Q + λ (L − Q). Q is quadratic; its second and first derivatives are the means of those of L at
/// points spread widely about the guess. Forces that are bounded have no part in Q, linear ones are in it as
/// a whole; so L − Q is bounded, and for λ = 0 the extremal is the solution of a linear equation. M, C and a
/// of the structure are in Q.
class WeakenedLagrangian final : public Lagrangian {
 public:
  /// Points are spread by `spread` times the extent of the guess. Nothing where L is not finite at many.
  static std::shared_ptr<WeakenedLagrangian> about(const Problem& problem, double spread);

  void set_part(double part) { part_ = part; }  ///< λ
  double part() const { return part_; }

  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override {
    whole_->sensitivity(points, parameter, out, scratch);
  }

 private:
  explicit WeakenedLagrangian(std::shared_ptr<const Lagrangian> whole);
  int row_of(int z) const;  ///< of the gradient

  std::shared_ptr<const Lagrangian> whole_;
  std::vector<double> slopes_, curvatures_;  ///< of Q at zero, as the structure lists them
  double part_ = 1;
};

}  // namespace extremal
