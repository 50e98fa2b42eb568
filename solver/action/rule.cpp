#include "action/rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "action/real_rule.hpp"

namespace extremal {

namespace {

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

/// Of one degree, rounded.
const Barycentric& barycentric_of(int degree) {
  static const std::vector<Barycentric> all = [] {
    std::vector<Barycentric> result(1);
    for (int s = 1; s <= max_degree; ++s) {
      const RealElement& element = real_element(s);
      Real largest = 0;
      for (const Real w : element.barycentric) largest = std::max(largest, std::abs(w));
      result.push_back({rounded(element.rule).nodes, {}});
      for (const Real w : element.barycentric)
        result.back().weights.push_back(static_cast<double>(w / largest));
    }
    return result;
  }();
  real_element(degree);  // refuses other degrees
  return all[degree];
}

void check_points(int points, int least) {
  if (points < least || points > max_points)
    throw std::invalid_argument(fmt::format("points = {}; need {} to {}", points, least, max_points));
}

/// The node that a point stands for, or -1.
int node_at(const std::vector<double>& nodes, double point) {
  const auto found = std::lower_bound(nodes.begin(), nodes.end(), point);
  return found != nodes.end() && *found == point ? static_cast<int>(found - nodes.begin()) : -1;
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
  const RealElement& element = real_element(degree);
  const std::vector<double>& nodes = barycentric_of(degree).nodes;
  const int m = degree + 1;
  Basis basis{degree, {points.begin(), points.end()}, {}, {}};
  basis.value.resize(points.size() * m);
  basis.derivative.resize(points.size() * m);
  std::array<Real, max_degree + 1> values, slopes;
  const std::span<Real> value(values.data(), m), slope(slopes.data(), m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Abscissa at{points[i], 1 - Real(points[i])};
    const int node = node_at(nodes, points[i]);
    values_at(element, at, node, value);
    derivatives_at(element, at, node, value, slope);
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
  const RealRule& rule = real_element(degree).rule;
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
  real_element(degree);  // refuses other degrees
  return bases[degree];
}

const Barycentric& lobatto_barycentric(int degree) { return barycentric_of(degree); }

}  // namespace extremal
