#pragma once

#include <span>
#include <vector>

#include "action/scheme.hpp"

/// \file Quadrature rules on [0, 1] and the polynomials of an element, which go through its s + 1
/// Gauss-Lobatto nodes. Everything is computed with 106 bits and rounded once.

namespace extremal {

/// ∫₀¹ f ≈ Σ_i weights[i] f(nodes[i]); nodes ascending, weights their own mirror image.
struct Rule {
  std::vector<double> nodes, weights;
};

inline constexpr int max_points = 64;

/// Gauss-Legendre, exact to degree 2·points − 1; 1 <= points <= max_points.
Rule gauss_rule(int points);
/// Gauss-Lobatto, exact to degree 2·points − 3; 2 <= points <= max_points.
Rule lobatto_rule(int points);
/// The quadrature of a scheme; where it is `exact`, Gauss with `exact_points` points.
Rule rule_of(const Scheme& scheme, int exact_points);

/// The Lagrange polynomials φ_0 … φ_s at the Lobatto nodes of an element, at given points:
/// value[i*(s+1) + j] = φ_j(points[i]), derivative likewise φ_j'(points[i]).
struct Basis {
  int degree = 0;
  std::vector<double> points;
  std::vector<double> value, derivative;

  /// At one of the points: s + 1 each.
  struct Row {
    const double *value, *derivative;
  };
  Row row(std::size_t i) const {
    return {value.data() + i * (degree + 1), derivative.data() + i * (degree + 1)};
  }
};

/// 1 <= degree <= max_degree. A point that equals a node as lobatto_rule returns it is that node: its values
/// are exactly 0 and 1.
Basis lobatto_basis(int degree, std::span<const double> points);
/// The same at one point, s + 1 numbers each, in doubles; without derivatives if there is no place for them.
void lobatto_basis_at(int degree, double point, double* value, double* derivative);
/// The same at the Lobatto nodes themselves, kept for the whole run.
const Basis& lobatto_nodal_basis(int degree);

/// Values alone: takes nodal values to values at the points, points × (s+1).
std::vector<double> interpolation_matrix(int degree, std::span<const double> points);

/// Takes nodal values to the coefficients of P_k(2τ − 1), k = 0 … s: (s+1) × (s+1).
std::vector<double> legendre_matrix(int degree);

/// Nodes and barycentric weights (largest magnitude 1) of an element, kept for the whole run.
struct Barycentric {
  std::vector<double> nodes, weights;
};
const Barycentric& lobatto_barycentric(int degree);

}  // namespace extremal
