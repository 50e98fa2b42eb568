#pragma once

#include <vector>

#include "action/discrete_action.hpp"
#include "action/extended_basis.hpp"
#include "linear/extended_rows.hpp"
#include "system/extended_hessian.hpp"

/// \file The second variation of elements, condensed to their ends, with 106 bits. Beside an encounter at a
/// distance r elements are as short as r^{3/2}. What a double leaves of M/h is a force on all bodies, which
/// the path amplifies.

namespace extremal {

/// With the unknowns of an element u inside and e = (q_a, Δ), H its Hessian and X a matrix near ∂u/∂e,
///
///     S = [X; 1]ᵀ H [X; 1]
///
/// errs by the square of what X errs by. So X of double precision gives S with all digits.
class ExtendedVariation {
 public:
  /// Whether second derivatives of this Lagrangian, and this quadrature, are known.
  static bool suits(const Lagrangian& lagrangian, const SchemeTables& scheme);

  /// At a path whose inner unknowns `eliminated` has eliminated. The Lagrangian must suit.
  void evaluate(const Lagrangian& lagrangian, const ElementTables& tables, const Path& path,
                const DiscreteAction& eliminated);

  /// N 2n × 2n: rows 2n k … are S of element k, by (q_a, Δ).
  const ExtendedRows& condensed() const { return condensed_; }
  /// N × 2n: what the gradient inside the elements leaves on (q_a, Δ), Xᵀ ∂L_d/∂u.
  void reduce(const std::vector<DoubleDouble>& inner, ExtendedRows& to) const;

 private:
  void load(const Path& path, int k);
  void place(const Path& path, int k, int i);
  void linearise(const Structure& structure, int i);
  void add_point(int i, std::size_t first);

  ExtendedBasis basis_;
  int n_ = 0, degree_ = 0, elements_ = 0;
  ExtendedRows condensed_;
  std::vector<double> by_ends_, fields_;  ///< X of all elements by (q_a, Δ), and of one by (q_a, q_b)
  ExtendedRows state_, forces_, inside_;  ///< δ(q, h q'), b ∂(h L_q, L_q'), and H [X; 1] inside
  std::vector<double> deviation_;
  std::vector<DoubleDouble> start_, chord_, q_, v_, rows_;
  DoubleDouble t_ = 0.0, h_ = 0.0;
  PointScratch<DoubleDouble> scratch_;
};

}  // namespace extremal
