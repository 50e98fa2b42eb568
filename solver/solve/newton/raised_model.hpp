#pragma once

#include <vector>

#include "solve/newton/sparse_model.hpp"

namespace extremal {

/// A model for elements of high degree from factors of low ones. Over the polynomials of low degree its
/// Hessian is that of elements of that degree on the same mesh; over the rest it is the kinetic energy's,
/// against which forces count little there: mode k of an element of length h feels a frequency ω by
/// (hω/2k)². The two are orthogonal in the kinetic energy. Steps from it contract by a few per cent (the
/// two levels of the p-version; Babuška, Craig, Mandel and Pitkäranta, SIAM J. Numer. Anal. 28 (1991) 624).
class RaisedModel final : public QuadraticModel {
 public:
  /// Whether the kinetic energy is ½ Σ m_a q_a'², m_a constant, and forces do not depend on velocities.
  static bool suits(const ElementTables& tables);

  /// Factors are kept in `low`, which was reset to elements of degree `low_tables`.
  RaisedModel(SparseModel& low, const ElementTables& low_tables) : low_(low), low_tables_(low_tables) {}

  const ElementTables& low_tables() const { return low_tables_; }

  void reset(const Problem& problem, const ElementTables& tables, int elements) override;
  bool evaluate(DiscreteAction& action, const Path& path, const ClosingEquation* closing) override;
  void evaluate_gradient(DiscreteAction& action, const Path& path) override;
  void solve(const DiscreteAction& action, const ClosingEquation* closing, Step& step) override;
  void add_at_ends(DiscreteAction&, std::span<const double> parts) override {
    low_.equations().add_at_ends(parts);
  }
  /// Of the model; the second variation itself may differ.
  Inertia inertia(double threshold, VariedBy by) override;

 private:
  void restrict_batch(const Path& path, int batch, const double* gradient);

  SparseModel& low_;
  const ElementTables& low_tables_;
  int n_ = 0, elements_ = 0, inner_ = 0, low_inner_ = 0;  ///< inner nodes of an element, of either degree
  std::vector<double> mass_;                              ///< 1/m_a
  std::vector<double> up_;    ///< low deviations to inner nodes: inner_ × low_inner_
  std::vector<double> down_;  ///< nodal values to the low nodes, (low degree + 1) × (degree + 1)
  std::vector<double> rest_;  ///< inverse of the stiffness beyond the low degree, inner_ × inner_
  DiscreteAction low_action_;
  Path low_path_;
  Step low_step_;
  AlignedDoubles low_gradient_, high_step_;
};

}  // namespace extremal
