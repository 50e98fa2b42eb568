#include "action/rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace extremal {

namespace {

using Real = long double;

/// A point of [0, 1] by its distance from either end, so that differences keep their digits at both ends.
struct Abscissa {
  Real left, right;
};

Real operator-(const Abscissa& a, const Abscissa& b) {
  return a.left + b.left < 1 ? a.left - b.left : b.right - a.right;
}

/// P_n(x) and P_n − P_{n−1} at x = 1 − u, by the differences D_k = P_{k+1} − P_k:
///   (k+1) D_k = k D_{k−1} − (2k+1) u P_k,
/// which loses nothing for small u.
struct Legendre {
  Real value, difference;
};

Legendre legendre(int n, Real u) {
  Real value = 1, difference = 0;
  for (int k = 0; k < n; ++k) {
    difference = (k * difference - (2 * k + 1) * u * value) / (k + 1);
    value += difference;
  }
  return {value, difference};
}

struct RealRule {
  std::vector<Abscissa> nodes;
  std::vector<Real> weights;
};

/// Newton on u = 1 − x from `u`, with the step −f/f' that `step(u)` returns.
template <class Step>
Real solve_node(Real u, Step step) {
  constexpr int most = 20;
  for (int i = 0; i < most; ++i) {
    const Real change = step(u);
    u += change;
    if (std::abs(change) <= 2 * std::numeric_limits<Real>::epsilon() * u) break;
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

/// Roots of P_n: (1−x²) P_n' = n (P_{n−1} − x P_n) = n (u P_n − D_{n−1}) and 1−x² = u (2−u);
/// weight on [0, 1] is 1 / ((1−x²) P_n'²).
RealRule real_gauss(int n) {
  RealRule rule{std::vector<Abscissa>(n), std::vector<Real>(n)};
  for (int i = 0; 2 * i < n; ++i) {
    const Real angle = std::numbers::pi_v<Real> * (i + 0.75L) / (n + 0.5L);
    const Real guess = 2 * std::pow(std::sin(angle / 2), 2.0L);
    const Real u = 2 * i + 1 == n ? 1 : solve_node(guess, [n](Real at) {
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
    const Real guess = 2 * std::pow(std::sin(std::numbers::pi_v<Real> * i / (2 * n)), 2.0L);
    const Real u = 2 * i == n ? 1 : solve_node(guess, [n](Real at) {
      const Legendre p = legendre(n, at);
      return -(at * p.value - p.difference) / ((n + 1) * p.value);
    });
    const Real value = legendre(n, u).value;
    set_pair(rule, i, u, 1 / (n * points * value * value));
  }
  return rule;
}

/// The upper nodes are one minus the lower ones to the last bit.
Rule rounded(const RealRule& rule) {
  Rule result;
  for (const Abscissa& node : rule.nodes) {
    const double distance = static_cast<double>(std::min(node.left, node.right));
    result.nodes.push_back(node.left <= node.right ? distance : 1 - distance);
  }
  for (const Real weight : rule.weights) result.weights.push_back(static_cast<double>(weight));
  return result;
}

/// An element of one degree in extended precision.
struct Element {
  RealRule rule;
  std::vector<Real> barycentric;  ///< 1 / Π_{m≠j} (τ_j − τ_m)
  Barycentric rounded;
};

Element make_element(int degree) {
  Element element{real_lobatto(degree + 1), {}, {}};
  const std::vector<Abscissa>& nodes = element.rule.nodes;
  for (const Abscissa& node : nodes) {
    Real product = 1;
    for (const Abscissa& other : nodes)
      if (&node != &other) product *= node - other;
    element.barycentric.push_back(1 / product);
  }
  Real largest = 0;
  for (const Real w : element.barycentric) largest = std::max(largest, std::abs(w));
  element.rounded.nodes = rounded(element.rule).nodes;
  for (const Real w : element.barycentric)
    element.rounded.weights.push_back(static_cast<double>(w / largest));
  return element;
}

const Element& element_of(int degree) {
  static const std::vector<Element> elements = [] {
    std::vector<Element> all(1);
    for (int s = 1; s <= max_degree; ++s) all.push_back(make_element(s));
    return all;
  }();
  if (degree < 1 || degree > max_degree)
    throw std::invalid_argument(fmt::format("degree = {}; need 1 to {}", degree, max_degree));
  return elements[degree];
}

void check_points(int points, int least) {
  if (points < least || points > max_points)
    throw std::invalid_argument(fmt::format("points = {}; need {} to {}", points, least, max_points));
}

/// The node that a point stands for, or -1.
int node_at(const Element& element, double point) {
  const std::vector<double>& nodes = element.rounded.nodes;
  const auto found = std::lower_bound(nodes.begin(), nodes.end(), point);
  return found != nodes.end() && *found == point ? static_cast<int>(found - nodes.begin()) : -1;
}

/// φ_j(τ) = (w_j / (τ − τ_j)) / Σ_m w_m / (τ − τ_m).
void values_at(const Element& element, double point, std::span<Real> value) {
  const int node = node_at(element, point);
  const Abscissa at{point, 1 - Real(point)};
  Real sum = 0;
  for (std::size_t j = 0; j < value.size(); ++j) {
    value[j] = node < 0 ? element.barycentric[j] / (at - element.rule.nodes[j]) : Real(int(j) == node);
    sum += value[j];
  }
  for (Real& x : value) x /= sum;
}

/// φ_j'(τ) = φ_j(τ) Σ_{m≠j} 1/(τ − τ_m), and at a node i ≠ j: φ_j'(τ_i) = (w_j/w_i) / (τ_i − τ_j).
void derivatives_at(const Element& element, double point, std::span<const Real> value,
                    std::span<Real> derivative) {
  const std::vector<Abscissa>& nodes = element.rule.nodes;
  const int node = node_at(element, point), size = static_cast<int>(nodes.size());
  const Abscissa at = node < 0 ? Abscissa{point, 1 - Real(point)} : nodes[node];
  for (int j = 0; j < size; ++j) {
    if (node >= 0 && j != node) {
      derivative[j] = element.barycentric[j] / element.barycentric[node] / (at - nodes[j]);
      continue;
    }
    Real sum = 0;
    for (int m = 0; m < size; ++m)
      if (m != j) sum += 1 / (at - nodes[m]);
    derivative[j] = value[j] * sum;
  }
}

/// Rounds a row whose sum is zero so that it stays zero: the largest entry takes up the rounding of the
/// others.
void round_balanced(std::span<const Real> row, double* rounded) {
  Real rest = 0;
  std::size_t largest = 0;
  for (std::size_t j = 0; j < row.size(); ++j)
    if (std::abs(row[j]) > std::abs(row[largest])) largest = j;
  for (std::size_t j = 0; j < row.size(); ++j) {
    rounded[j] = static_cast<double>(row[j]);
    if (j != largest) rest += rounded[j];
  }
  rounded[largest] = static_cast<double>(-rest);
}

}  // namespace

Rule gauss_rule(int points) {
  check_points(points, 1);
  return rounded(real_gauss(points));
}

Rule lobatto_rule(int points) {
  check_points(points, 2);
  return rounded(real_lobatto(points));
}

Rule rule_of(const Scheme& scheme, int exact_points) {
  switch (scheme.quadrature) {
    case Quadrature::left:
      return {{0}, {1}};
    case Quadrature::right:
      return {{1}, {1}};
    case Quadrature::midpoint:
      return gauss_rule(1);
    case Quadrature::ends:
      return lobatto_rule(2);
    case Quadrature::simpson:
      return lobatto_rule(3);
    case Quadrature::gauss:
      return gauss_rule(scheme.points);
    case Quadrature::lobatto:
      return lobatto_rule(scheme.points);
    case Quadrature::exact:
      return gauss_rule(exact_points);
  }
  throw std::invalid_argument(fmt::format("quadrature {} does not exist", int(scheme.quadrature)));
}

Basis lobatto_basis(int degree, std::span<const double> points) {
  const Element& element = element_of(degree);
  const int m = degree + 1;
  Basis basis{degree, {points.begin(), points.end()}, {}, {}};
  basis.value.resize(points.size() * m);
  basis.derivative.resize(points.size() * m);
  std::array<Real, max_degree + 1> values, slopes;
  const std::span<Real> value(values.data(), m), slope(slopes.data(), m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    values_at(element, points[i], value);
    derivatives_at(element, points[i], value, slope);
    std::transform(value.begin(), value.end(), basis.value.begin() + i * m,
                   [](Real x) { return static_cast<double>(x); });
    round_balanced(slope, basis.derivative.data() + i * m);
  }
  return basis;
}

std::vector<double> interpolation_matrix(int degree, std::span<const double> points) {
  return lobatto_basis(degree, points).value;
}

/// The Lobatto rule is exact for P_k q, deg q <= s, if k < s; for k = s it is not, but the discrete norm
/// Σ_j w_j P_s(x_j)² = 1/s replaces 1/(2s+1).
std::vector<double> legendre_matrix(int degree) {
  const RealRule& rule = element_of(degree).rule;
  const int m = degree + 1;
  std::vector<double> matrix(m * m);
  for (int k = 0; k < m; ++k) {
    const Real scale = k < degree ? 2 * k + 1 : degree;
    for (int j = 0; j < m; ++j)
      matrix[k * m + j] =
          static_cast<double>(scale * rule.weights[j] * legendre(k, 2 * rule.nodes[j].right).value);
  }
  return matrix;
}

const Basis& lobatto_nodal_basis(int degree) {
  static const std::vector<Basis> bases = [] {
    std::vector<Basis> all(1);
    for (int s = 1; s <= max_degree; ++s) all.push_back(lobatto_basis(s, lobatto_barycentric(s).nodes));
    return all;
  }();
  element_of(degree);  // refuses other degrees
  return bases[degree];
}

const Barycentric& lobatto_barycentric(int degree) { return element_of(degree).rounded; }

}  // namespace extremal
