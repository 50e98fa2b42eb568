#pragma once

#include <memory>

#include "solve/homotopy/homotopy.hpp"
#include "solve/homotopy/weakened_lagrangian.hpp"

/// \file Extremals by continuation in the strength of the nonlinear forces.

namespace extremal {

/// Extremals of L_λ = Q + λ (L − Q); the parameter is λ − 1. For λ = 0 the equations are linear. If they are
/// not resonant and L − Q has bounded forces, paths stay bounded, and by their degree the curve that begins
/// at λ = 0 comes to λ = 1.
class ForceHomotopy : public Homotopy {
 public:
  ForceHomotopy(const Problem& problem, Path& path, Workspace& workspace, std::function<bool()> count,
                std::shared_ptr<WeakenedLagrangian> lagrangian);

  /// Takes the path to the extremal of Q, and along the curve to nearly one of the problem.
  bool trace(const ElementTables& tables);

 private:
  bool solve_linearised(Move& correction, Move& direction) override;
  const Problem& problem() const override { return problem_; }
  double parameter() const override { return lagrangian_->part() - 1; }
  bool set_parameter(double value) override {
    lagrangian_->set_part(value == 0 ? 1 : 1 + value);
    return true;
  }
  double onward(const Move& direction) const override { return direction.parameter; }

  std::shared_ptr<WeakenedLagrangian> lagrangian_;
  Problem problem_;
};

}  // namespace extremal
