#pragma once

#include <Eigen/Dense>

#include <vector>

#include "action/discrete_action.hpp"

/// \file Polynomials of degree s + 2 from an extremal on elements of degree s.

namespace extremal {

/// At the nodes between elements q and the momenta are known to order 2s, the slopes of the elements'
/// polynomials only to order s. In an element, with ξ = 2τ − 1, L_k Legendre's polynomials and B_k = ∫ L_k dξ
/// from −1 to ξ, these leave out of dq/dξ what is best left out in the mean, Σ d_k L_k over k >= s. But
/// d_{s−1} is missed by some m: Lobatto's rule takes ∫ L_s² for 2/s instead of 2/(2s + 1), which misplaces
/// (s + 1)/s d_{s+1} of what force makes; and what is left out moves in G = Cᵀ − C,
///   m = (s + 1)/s d_{s+1} − h/2 M⁻¹G d_s/(2s + 1).
/// Let e_0 and e_1 be by how much the velocities that momenta have exceed the slopes at the ends. They tell
///   d_s = h/4 (e_1 + (−1)^s e_0),    d_{s+1} + m = h/4 (e_1 − (−1)^s e_0),
/// and so q_h + d_s B_s + d_{s+1} B_{s+1} + m B_{s−1}. Where the mass is constant this leaves out L_{s+3} and
/// what follows, with gyroscopic forces a little of L_{s+2}; elsewhere parts of L_{s+2}. Of other rules m is
/// what G makes, and with s = 1 it is Hermite's cubic.
class Recovery {
 public:
  static constexpr int raised_by = 2;
  /// Coefficients that are known better than on the elements.
  static int gained(const Lagrangian& lagrangian) { return lagrangian.structure().quadratic ? 2 : 1; }
  static bool suits(const SchemeTables& scheme);

  /// Evaluates the gradient at a path. False where L_vv is singular at one of the nodes; the rest then tells
  /// nothing.
  bool measure(const Lagrangian& lagrangian, DiscreteAction& action, const Path& path);

  /// The polynomials on elements of `raised`, of degree s + 2; `matrix` is interpolation_matrix(s, Lobatto
  /// nodes of degree s + 2).
  void raise(const Path& path, const ElementTables& raised, std::span<const double> matrix, Path& to) const;

  /// m B_{s−1} at the inner nodes of the elements, laid out as Path::x: what another rule would add.
  void misplaced(const Path& path, AlignedDoubles& to) const;

 private:
  void find_slopes(const SchemeTables& scheme, const Path& path, int batch);
  void find_defects(const Lagrangian& lagrangian, const double* gradient);
  void find_velocities(const Lagrangian& lagrangian, const double* gradient);
  void divide(const Lagrangian& lagrangian);
  void solve_with_mass(AlignedDoubles& x);
  void solve_column(int k, AlignedDoubles& x);
  void keep(const Structure& structure, const SchemeTables& scheme, const Path& path, int batch);
  double* coefficients(int batch, int a) {
    return coefficients_.data() + (std::size_t(batch) * n_ + a) * 3 * lanes_;
  }
  const double* coefficients(int batch, int a) const {
    return coefficients_.data() + (std::size_t(batch) * n_ + a) * 3 * lanes_;
  }

  int lanes_ = simd_lanes(), both_ = 2 * lanes_;  ///< entries of a row for one end of the elements, for both
  int n_ = 0;
  bool diagonal_ = false, singular_ = false;  ///< the mass, if it is constant; at a node
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
  Eigen::MatrixXd mass_;
  Eigen::VectorXd column_;
  AlignedDoubles q_, v_, t_, rows_, defects_;  ///< of a batch: the first ends of its elements, then the last
  AlignedDoubles slopes_;                      ///< of the polynomials, where v_ is Newton's
  AlignedDoubles turned_;                      ///< M⁻¹G d_s, likewise
  AlignedDoubles coefficients_;                ///< d_s, d_{s+1}, m for each batch and coordinate
  Scratch scratch_;
};

}  // namespace extremal
