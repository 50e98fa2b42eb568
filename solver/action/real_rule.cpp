#include "action/real_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "action/by_degree.hpp"
#include "machine/roundoff.hpp"

namespace extremal {

namespace {

/// Newton on u = 1 − x from `u`, with the step −f/f' that `step(u)` returns. A step squares the error.
template <class Step>
Real solve_node(Real u, Step step) {
  constexpr int most = 20;
  for (int i = 0; i < most; ++i) {
    const Real change = step(u);
    u += change;
    if (abs(change) <= machine_epsilon * u) break;
  }
  return u;
}

/// Sets node i and its mirror image; u = 1 − x = 2τ.
void set_pair(RealRule& rule, int i, Real u, Real weight) {
  const std::size_t mirror = rule.nodes.size() - 1 - i;
  rule.nodes[i] = {u / 2, 1 - u / 2};
  rule.nodes[mirror] = {1 - u / 2, u / 2};
  rule.weights[i] = rule.weights[mirror] = weight;
}

RealElement make_element(int degree) {
  RealElement element{real_lobatto(degree + 1), {}};
  const std::vector<Abscissa>& nodes = element.rule.nodes;
  for (const Abscissa& node : nodes) {
    Real product = 1;
    for (const Abscissa& other : nodes)
      if (&node != &other) product *= node - other;
    element.barycentric.push_back(1 / product);
  }
  return element;
}

}  // namespace

Real operator-(const Abscissa& a, const Abscissa& b) {
  return a.left + b.left < 1 ? a.left - b.left : b.right - a.right;
}

Legendre Legendre::next(int k, Real u) const {
  const Real change = (k * difference - (2 * k + 1) * u * value) / (k + 1);
  return {value + change, change};
}

Legendre legendre(int n, Real u) {
  Legendre p;
  for (int k = 0; k < n; ++k) p = p.next(k, u);
  return p;
}

/// Roots of P_n: (1−x²) P_n' = n (P_{n−1} − x P_n) = n (u P_n − D_{n−1}) and 1−x² = u (2−u);
/// weight on [0, 1] is 1 / ((1−x²) P_n'²).
RealRule real_gauss(int n) {
  RealRule rule{std::vector<Abscissa>(n), std::vector<Real>(n)};
  for (int i = 0; 2 * i < n; ++i) {
    const double half = std::sin(std::numbers::pi * (i + 0.75) / (2 * n + 1)), guess = 2 * half * half;
    const Real u = 2 * i + 1 == n ? Real(1) : solve_node(guess, [n](Real at) {
      const Legendre p = legendre(n, at);
      return p.value * at * (2 - at) / (n * (at * p.value - p.difference));
    });
    const Legendre p = legendre(n, u);
    const Real slope = n * (u * p.value - p.difference);
    set_pair(rule, i, u, u * (2 - u) / (slope * slope));
  }
  return rule;
}

/// Ends and roots of P_n', n = points − 1: ((1−x²) P_n')' = −n (n+1) P_n; weight on [0, 1] is
/// 1 / (n (n+1) P_n²).
RealRule real_lobatto(int points) {
  const int n = points - 1;
  RealRule rule{std::vector<Abscissa>(points), std::vector<Real>(points)};
  set_pair(rule, 0, 0, 1 / Real(n * points));
  for (int i = 1; 2 * i <= n; ++i) {
    const double half = std::sin(std::numbers::pi * i / (2 * n)), guess = 2 * half * half;
    const Real u = 2 * i == n ? Real(1) : solve_node(guess, [n](Real at) {
      const Legendre p = legendre(n, at);
      return -(at * p.value - p.difference) / ((n + 1) * p.value);
    });
    const Real value = legendre(n, u).value;
    set_pair(rule, i, u, 1 / (n * points * value * value));
  }
  return rule;
}

const RealElement& real_element(int degree) {
  static ByDegree<RealElement> elements(make_element);
  return elements.at(degree);
}

int node_at(const RealElement& element, Abscissa at) {
  const std::vector<Abscissa>& nodes = element.rule.nodes;
  const auto found = std::find_if(nodes.begin(), nodes.end(), [&](Abscissa node) { return at - node == 0; });
  return found != nodes.end() ? static_cast<int>(found - nodes.begin()) : -1;
}

/// φ_j(τ) = (w_j / (τ − τ_j)) / Σ_m w_m / (τ − τ_m).
void values_at(const RealElement& element, Abscissa at, int node, std::span<Real> value) {
  Real sum = 0;
  for (std::size_t j = 0; j < value.size(); ++j) {
    value[j] = node < 0 ? element.barycentric[j] / (at - element.rule.nodes[j]) : Real(int(j) == node);
    sum += value[j];
  }
  for (Real& x : value) x /= sum;
}

/// φ_j'(τ) = φ_j(τ) Σ_{m≠j} 1/(τ − τ_m), and at a node i ≠ j: φ_j'(τ_i) = (w_j/w_i) / (τ_i − τ_j).
void derivatives_at(const RealElement& element, Abscissa at, int node, std::span<const Real> value,
                    std::span<Real> derivative) {
  const std::vector<Abscissa>& nodes = element.rule.nodes;
  const int size = static_cast<int>(nodes.size());
  std::array<Real, max_degree + 1> inverse;
  for (int m = 0; m < size; ++m)
    if (m != node) inverse[m] = 1 / ((node < 0 ? at : nodes[node]) - nodes[m]);
  for (int j = 0; j < size; ++j) {
    if (node >= 0 && j != node) {
      derivative[j] = element.barycentric[j] / element.barycentric[node] / (nodes[node] - nodes[j]);
      continue;
    }
    Real sum = 0;
    for (int m = 0; m < size; ++m)
      if (m != j) sum += inverse[m];
    derivative[j] = value[j] * sum;
  }
}

}  // namespace extremal
