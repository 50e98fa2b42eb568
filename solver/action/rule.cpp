#include "action/rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "action/by_degree.hpp"
#include "action/real_rule.hpp"

namespace extremal {

namespace {

/// The upper nodes are one minus the lower ones to the last bit.
Rule rounded(const RealRule& rule) {
  Rule result;
  for (const Abscissa& node : rule.nodes) {
    const double distance = to_double(std::min(node.left, node.right));
    result.nodes.push_back(node.left <= node.right ? distance : 1 - distance);
  }
  for (const Real weight : rule.weights) result.weights.push_back(to_double(weight));
  return result;
}

Barycentric make_barycentric(int degree) {
  const RealElement& element = real_element(degree);
  Real largest = 0;
  for (const Real w : element.barycentric) largest = std::max(largest, abs(w));
  Barycentric result{rounded(element.rule).nodes, {}};
  for (const Real w : element.barycentric) result.weights.push_back(to_double(w / largest));
  return result;
}

Basis make_nodal_basis(int degree) { return lobatto_basis(degree, lobatto_barycentric(degree).nodes); }

void check_points(int points, int least) {
  if (points < least || points > max_points)
    throw std::invalid_argument(fmt::format("points = {}; need {} to {}", points, least, max_points));
}

/// The node that a point stands for, or -1. Quotients by a distance less than `least` would overflow.
int node_at(const std::vector<double>& nodes, double point) {
  constexpr double least = 1e-150;
  if (point < least) return 0;
  const auto found = std::lower_bound(nodes.begin(), nodes.end(), point);
  return found != nodes.end() && *found == point ? static_cast<int>(found - nodes.begin()) : -1;
}

/// Rounds a row whose sum is zero so that it stays zero: the largest entry takes up the rounding of the
/// others.
void round_balanced(std::span<const Real> row, double* rounded) {
  Real rest = 0;
  std::size_t largest = 0;
  for (std::size_t j = 0; j < row.size(); ++j)
    if (abs(row[j]) > abs(row[largest])) largest = j;
  for (std::size_t j = 0; j < row.size(); ++j) {
    rounded[j] = to_double(row[j]);
    if (j != largest) rest += rounded[j];
  }
  rounded[largest] = to_double(-rest);
}

}  // namespace

Rule gauss_rule(int points) {
  check_points(points, 1);
  return rounded(real_gauss(points));
}

Rule lobatto_rule(int points) {
  check_points(points, 2);
  return rounded(points <= max_degree + 1 ? real_element(points - 1).rule : real_lobatto(points));
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

/// In doubles, for single points: 106 bits cost twenty times as much.
void lobatto_basis_at(int degree, double point, double* value, double* derivative) {
  const Barycentric& element = lobatto_barycentric(degree);
  const int m = degree + 1;
  if (const int node = node_at(element.nodes, point); node >= 0) {
    const Basis::Row row = lobatto_nodal_basis(degree).row(node);
    std::copy_n(row.value, m, value);
    if (derivative) std::copy_n(row.derivative, m, derivative);
    return;
  }
  std::array<double, max_degree + 1> inverse;
  double sum = 0, largest = 0;
  for (int j = 0; j < m; ++j) {
    inverse[j] = 1 / (point - element.nodes[j]);
    value[j] = element.weights[j] * inverse[j];
    sum += value[j];
  }
  for (int j = 0; j < m; ++j) value[j] /= sum;
  if (!derivative) return;
  // Their sum is zero: the largest takes up the rounding of the others.
  int last = 0;
  double rest = 0;
  for (int j = 0; j < m; ++j) {
    double by_others = 0;
    for (int k = 0; k < m; ++k)
      if (k != j) by_others += inverse[k];
    derivative[j] = value[j] * by_others;
    rest += derivative[j];
    if (std::abs(derivative[j]) > largest) largest = std::abs(derivative[j]), last = j;
  }
  derivative[last] -= rest;
}

Basis lobatto_basis(int degree, std::span<const double> points) {
  const RealElement& element = real_element(degree);
  const int m = degree + 1;
  Basis basis{degree, {points.begin(), points.end()}, {}, {}};
  std::array<Real, max_degree + 1> values, slopes;
  const std::span<Real> value(values.data(), m), slope(slopes.data(), m);
  basis.derivative.resize(points.size() * m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Abscissa at{points[i], 1 - Real(points[i])};
    const int node = node_at(lobatto_barycentric(degree).nodes, points[i]);
    values_at(element, at, node, value);
    std::ranges::transform(value, std::back_inserter(basis.value),
                           [](const Real& x) { return to_double(x); });
    derivatives_at(element, at, node, value, slope);
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
  for (int j = 0; j < m; ++j) {
    const Real u = 2 * rule.nodes[j].right;
    Legendre p;
    for (int k = 0; k < m; p = p.next(k, u), ++k) {
      const Real scale = k < degree ? 2 * k + 1 : degree;
      matrix[k * m + j] = to_double(scale * rule.weights[j] * p.value);
    }
  }
  return matrix;
}

const Basis& lobatto_nodal_basis(int degree) {
  static ByDegree<Basis> bases(make_nodal_basis);
  return bases.at(degree);
}

const Barycentric& lobatto_barycentric(int degree) {
  static ByDegree<Barycentric> all(make_barycentric);
  return all.at(degree);
}

}  // namespace extremal
