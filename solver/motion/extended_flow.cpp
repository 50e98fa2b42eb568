#include "motion/extended_flow.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

constexpr int most_coordinates = 64;

using Real = ExtendedFlow::Real;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

bool finite(std::span<const Real> x) {
  return std::all_of(x.begin(), x.end(), [](Real a) { return std::isfinite(a); });
}

}  // namespace

bool ExtendedFlow::suits(const Lagrangian& lagrangian) {
  const Structure& structure = lagrangian.structure();
  if (!structure.quadratic || !structure.velocity_free || structure.coordinates > most_coordinates)
    return false;
  const std::vector<Real> at(structure.coordinates, 0);
  std::vector<Real> rows(lagrangian.rows(Order::gradient));
  PointScratch<Extended> scratch;
  return lagrangian.evaluate_extended(at.data(), at.data(), 0, rows.data(), scratch);
}

ExtendedFlow::ExtendedFlow(const Lagrangian& lagrangian)
    : lagrangian_(lagrangian), structure_(lagrangian.structure()), rows_(lagrangian.rows(Order::gradient)) {
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> mass;
  mass.setZero(structure_.coordinates, structure_.coordinates);
  for (const Triplet& m : structure_.mass) mass(m.row, m.column) += m.value;
  mass_.compute(mass);
}

bool ExtendedFlow::momentum(std::span<const Real> q, std::span<const Real> v, Real, std::span<Real> p) const {
  std::fill(p.begin(), p.end(), Real(0));
  for (const Triplet& m : structure_.mass) p[m.row] += m.value * v[m.column];
  for (const Triplet& c : structure_.gyroscopic) p[c.row] += c.value * q[c.column];
  for (std::size_t a = 0; a < structure_.linear.size(); ++a) p[a] += structure_.linear[a];
  return finite(p);
}

bool ExtendedFlow::slope(Real t, std::span<const Real> y, std::span<Real> slope) {
  const std::size_t n = structure_.coordinates;
  const std::span<const Real> q = y.first(n);
  const std::span<Real> v = slope.first(n), force = slope.subspan(n, n);
  std::copy_n(y.begin() + static_cast<std::ptrdiff_t>(n), n, v.begin());
  for (const Triplet& c : structure_.gyroscopic) v[c.row] -= c.value * q[c.column];
  for (std::size_t a = 0; a < structure_.linear.size(); ++a) v[a] -= structure_.linear[a];
  Eigen::Map<Vector> velocity(v.data(), structure_.coordinates);
  velocity = mass_.solve(velocity).eval();
  lagrangian_.evaluate_extended(q.data(), v.data(), t, rows_.data(), scratch_);
  std::fill(force.begin(), force.end(), Real(0));
  for (const Triplet& c : structure_.gyroscopic) force[c.column] += c.value * v[c.row];
  for (std::size_t g = 0; g < structure_.gradient.size(); ++g) force[structure_.gradient[g]] += rows_[1 + g];
  return finite(slope.first(2 * n));
}

}  // namespace extremal
