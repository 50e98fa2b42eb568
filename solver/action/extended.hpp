#pragma once

#include <span>
#include <vector>

#include "action/path.hpp"
#include "action/real_rule.hpp"
#include "system/lagrangian.hpp"

/// \file The gradient of S_h in extended precision: where the solution of a linear system amplifies roundoff,
/// the factors may be rounded, the right-hand side may not (iterative refinement; Wilkinson 1963).

namespace extremal {

class ExtendedGradient {
 public:
  /// S_h and its gradient at a path, element by element. False where the Lagrangian or the quadrature (other
  /// than Lobatto's at the nodes, and Gauss's) cannot.
  bool evaluate(const Lagrangian& lagrangian, const ElementTables& tables, const Path& path);

  /// By the inner unknowns of element k, laid out as in element.hpp: (s − 1) n.
  std::span<const Real> inner(int k) const {
    return {inner_.data() + static_cast<std::size_t>(k) * width_, width_};
  }
  /// By the mesh nodes, (N + 1) × n: the difference of momenta, at the ends a momentum.
  std::span<const Real> nodes() const { return nodes_; }
  Real action() const { return action_; }
  Real slope_duration() const { return slope_duration_; }  ///< ∂S_h/∂T
  Real momentum_scale() const { return momentum_scale_; }  ///< largest end gradient of an element

 private:
  bool bind(const SchemeTables& scheme);
  void element(const Lagrangian& lagrangian, const Path& path, int k);
  void place(const Path& path, int k, int i, Real h);
  Real differentiate(const Structure& structure);

  Quadrature quadrature_ = Quadrature::lobatto;
  int degree_ = 0, points_ = 0, n_ = 0;
  RealRule rule_;
  std::vector<Real> value_, slope_;  ///< points × (s + 1): φ_j(c_i), φ_j'(c_i) of the Lagrange polynomials
  std::size_t width_ = 0;
  std::vector<Real> inner_, nodes_, ends_;
  std::vector<Real> q_, v_, rows_, force_, momentum_;  ///< at one point; L_q and L_q'
  Real t_ = 0, action_ = 0, slope_duration_ = 0, momentum_scale_ = 0;
  ExtendedScratch scratch_;
};

}  // namespace extremal
