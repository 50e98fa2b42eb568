#include "analysis/bounds.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "action/tables.hpp"
#include "linear/dense.hpp"

namespace extremal {

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// Stiffness and mass of one element of unit length, functions in the order of element.hpp.
struct Element {
  MatrixXd stiffness, mass;
};

Element element(const Scheme& scheme) {
  const SchemeTables tables(scheme, scheme.points);
  const int f = tables.functions;
  Element result{MatrixXd(f, f), MatrixXd::Zero(f, f)};
  for (int j = 0; j < f; ++j)
    for (int k = 0; k < f; ++k) {
      result.stiffness(j, k) = tables.stiffness[j * f + k];
      for (int i = 0; i < tables.points; ++i)
        result.mass(j, k) += tables.weight[i] * tables.value[i * f + j] * tables.value[i * f + k];
    }
  return result;
}

/// √ of the least z² with K − z² M singular, for K positive definite and M ≥ 0.
double least_frequency(const MatrixXcd& stiffness, const MatrixXcd& mass) {
  const Eigen::VectorXd values = hermitian_eigenvalues(mass, stiffness);
  const double largest = values[values.size() - 1];
  const double roundoff = 1e-14 * mass.cwiseAbs().maxCoeff() / stiffness.cwiseAbs().maxCoeff();
  return largest > roundoff ? 1 / std::sqrt(largest) : std::numeric_limits<double>::infinity();
}

/// Of paths whose values are multiplied by e^{iθ} from one element to the next: the end value is e^{iθ} times
/// the start value, so one element tells all.
double bloch_frequency(const Element& e, double theta) {
  const Eigen::Index inner = e.stiffness.rows() - 2;
  MatrixXcd closed = MatrixXcd::Zero(inner + 2, inner + 1);
  closed.topRows(inner + 1).setIdentity();
  closed(inner + 1, inner) = std::polar(1.0, theta);
  return least_frequency(closed.adjoint() * e.stiffness * closed, closed.adjoint() * e.mass * closed);
}

}  // namespace

/// With n ≥ 2 the slowest path that vanishes at both ends has the values sin(kπ/n) at the nodes, the sum of
/// two waves with θ = ±π/n. With n = 1 only inner unknowns are free.
double window_bound(const Scheme& scheme, int elements) {
  if (elements < 1) throw std::invalid_argument(fmt::format("elements = {}; need at least 1", elements));
  const Element e = element(scheme);
  if (elements > 1) return elements * bloch_frequency(e, std::numbers::pi / elements);
  const Eigen::Index inner = e.stiffness.rows() - 2;
  if (inner == 0) return std::numeric_limits<double>::infinity();
  return least_frequency(e.stiffness.topLeftCorner(inner, inner).cast<std::complex<double>>(),
                         e.mass.topLeftCorner(inner, inner).cast<std::complex<double>>());
}

}  // namespace extremal
