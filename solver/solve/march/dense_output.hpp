#pragma once

#include <optional>
#include <span>
#include <vector>

#include "motion/flow.hpp"
#include "solve/march/element_solver.hpp"

/// \file The polynomial of an element at its nodes, as it is or with the velocities that the momenta give.
///
/// In an element q' of degree s − 1 lacks about γ P_s + δ P_{s+1}, Legendre polynomials of 2τ − 1, for it is
/// nearly the projection of the true one. At the ends p_k and p_{k+1}, which have order 2s, give the true
/// velocities, and these two numbers follow from what q' misses there: P_k(±1) = (±1)^k. Their integrals,
///   ∫ P_k dt = h/2 (P_{k+1} − P_{k−1})/(2k + 1),
/// vanish at the ends. Two orders are gained for a constant mass and forces without q', else one.

namespace extremal {

class DenseOutput {
 public:
  /// With `recovering`, of degree s + 2 where the momenta of L give velocities.
  DenseOutput(const StepTables& tables, bool recovering);

  int degree() const { return degree_; }
  /// Orders gained.
  int gain() const;

  /// Values and slopes of the element x over h from `state`, (degree + 1) n each, node by node, with the
  /// momenta at its end.
  void read(const MotionState& state, std::span<const double> x, const MotionState& end, double h, double* q,
            double* v);

 private:
  const StepTables& tables_;
  int degree_;
  std::optional<Flow> flow_;
  std::vector<double> node_, value_, slope_;   ///< of φ_J at the nodes: (degree + 1) × (s − 1)
  std::vector<double> term_[2], integral_[2];  ///< P_s and P_{s+1}, and their integrals over τ
  std::vector<double> first_, last_, position_, momentum_;
  bool known_ = false;  ///< first_ is the velocity at the start of the element
};

}  // namespace extremal
