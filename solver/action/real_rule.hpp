#pragma once

#include <qd/dd_real.h>

#include <span>
#include <vector>

#include "action/scheme.hpp"

/// \file Quadrature rules and the polynomials of an element with 106 bits: equations with as many are solved
/// on them, and a path that rests is held in time by what is beyond the digits of a double.

namespace extremal {

using Real = dd_real;

/// A point of [0, 1] by its distance from either end, so that differences keep their digits at both ends.
struct Abscissa {
  Real left, right;
};
Real operator-(const Abscissa& a, const Abscissa& b);

/// P_n(x) and P_n − P_{n−1} at x = 1 − u, by the differences D_k = P_{k+1} − P_k:
///   (k+1) D_k = k D_{k−1} − (2k+1) u P_k,
/// which loses nothing for small u.
struct Legendre {
  Real value = 1, difference = 0;
  /// From n = k to n = k + 1.
  Legendre next(int k, Real u) const;
};
Legendre legendre(int n, Real u);

/// ∫₀¹ f ≈ Σ_i weights[i] f(nodes[i]); nodes ascending.
struct RealRule {
  std::vector<Abscissa> nodes;
  std::vector<Real> weights;
};
RealRule real_gauss(int points);
RealRule real_lobatto(int points);

/// The Lobatto nodes of an element of one degree, and 1 / Π_{m≠j} (τ_j − τ_m).
struct RealElement {
  RealRule rule;
  std::vector<Real> barycentric;
};
/// Kept for the whole run. Throws std::invalid_argument unless 1 <= degree <= max_degree.
const RealElement& real_element(int degree);

/// The node that a point is, or -1.
int node_at(const RealElement& element, Abscissa at);

/// φ_j(τ) and φ_j'(τ) of the Lagrange polynomials, s + 1 each, at a point or, where `node` is not negative,
/// at that node.
void values_at(const RealElement& element, Abscissa at, int node, std::span<Real> value);
void derivatives_at(const RealElement& element, Abscissa at, int node, std::span<const Real> value,
                    std::span<Real> derivative);

}  // namespace extremal
