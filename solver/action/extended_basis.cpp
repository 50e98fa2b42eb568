#include "action/extended_basis.hpp"

namespace extremal {

bool ExtendedBasis::bind(const SchemeTables& scheme) {
  const bool gauss = scheme.scheme.quadrature == Quadrature::gauss;
  if (!gauss && !scheme.nodal) return false;
  if (degree == scheme.degree && points == scheme.points && quadrature == scheme.scheme.quadrature)
    return true;
  degree = scheme.degree;
  points = scheme.points;
  quadrature = scheme.scheme.quadrature;
  nodal = scheme.nodal;
  rule = gauss ? real_gauss(points) : real_lobatto(points);
  const RealElement& element = real_element(degree);
  std::vector<Real> values(degree + 1), slopes(degree + 1);
  value.clear();
  slope.clear();
  for (const Abscissa& at : rule.nodes) {
    const int node = node_at(element, at);
    values_at(element, at, node, values);
    derivatives_at(element, at, node, values, slopes);
    value.insert(value.end(), values.begin(), values.end());
    slope.insert(slope.end(), slopes.begin(), slopes.end());
  }
  return true;
}

}  // namespace extremal
