#pragma once

#include <memory>

#include "system/minimal_lagrangian.hpp"

/// \file Forces in minimal coordinates: system/copies.hpp.

namespace extremal {

/// With the forces Q, of two copies of u: Λ = (L̂_u + Q)·λ + L̂_u'·λ' at the mean of the copies, λ = u₁ − u₂.
/// That is Λ of system/copies.hpp but for what is of third order in λ. w is searched for once for both.
/// Second derivatives are those where the copies agree.
class MinimalCopies final : public Lagrangian {
 public:
  MinimalCopies(std::shared_ptr<const MinimalLagrangian> one, const MinimalExpressions& expressions);

  void evaluate(const Points& points, Order order, double* out, Scratch& scratch) const override;
  void sensitivity(const Points& points, int parameter, double* out, Scratch& scratch) const override;

 private:
  bool agree(const Points& points) const;
  void evaluate_agreeing(const Points& one, Order order, double* out, Scratch& scratch) const;
  void evaluate_apart(const Points& points, Order order, double* out, Scratch& scratch) const;

  std::shared_ptr<const MinimalLagrangian> one_;
  Tape motion_;   ///< L̂_u + Q, L̂_u'
  Tape hessian_;  ///< these, and the second derivatives
};

struct MinimalSystem {
  std::shared_ptr<const MinimalLagrangian> lagrangian;
  std::shared_ptr<const Lagrangian> copies;  ///< null: there are no forces
};

MinimalSystem minimal_system(const ConstrainedGraph& system, const Chart& chart);

}  // namespace extremal
