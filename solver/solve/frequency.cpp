#include "solve/frequency.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// A light particle in a strong field is the fast one.
double lightest_mass(const Structure& s) {
  double lightest = INFINITY;
  for (const Triplet& m : s.mass)
    if (m.row == m.column) lightest = std::min(lightest, std::abs(m.value));
  return std::isfinite(lightest) ? lightest : 1;
}

/// Sizes of L_qq against L_q'q' in one point: rows of the remainder with a stride.
double squared_frequency(const Structure& s, double lightest, const double* hessian, std::size_t stride) {
  const int n = s.coordinates;
  double force = 0, inertia = 0;
  for (std::size_t e = 0; e < s.hessian.size(); ++e) {
    const double size = std::abs(hessian[e * stride]);
    if (s.hessian[e].row < n) force = std::max(force, size);
    if (s.hessian[e].column >= n && s.hessian[e].row == s.hessian[e].column)
      inertia = std::max(inertia, size);
  }
  if (s.quadratic) inertia = lightest;
  return inertia > 0 ? force / inertia : 0;
}

}  // namespace

void Frequency::clear() {
  tau_.clear();
  omega_.clear();
  sum_ = 0;
  finite_ = true;
}

void Frequency::add(double tau, double omega) {
  if (!std::isfinite(omega)) {
    finite_ = false;
    omega = omega_.empty() ? 0 : omega_.back();
  }
  if (!tau_.empty()) {
    if (tau <= tau_.back()) return;
    sum_ += 0.5 * (omega + omega_.back()) * (tau - tau_.back());
  }
  least_ = tau_.empty() ? omega : std::min(least_, omega);
  most_ = tau_.empty() ? omega : std::max(most_, omega);
  tau_.push_back(tau);
  omega_.push_back(omega);
}

double Frequency::grading(double floor) const {
  const double base = floor * sum_;
  return least_ + base > 0 ? (most_ + base) / (least_ + base) : 1;
}

std::vector<double> Frequency::mesh(int elements, double floor) const {
  if (!(sum_ > 0)) return uniform_mesh(elements);
  const double base = floor * sum_, total = sum_ + base;
  std::vector<double> mesh(elements + 1);
  double passed = 0;
  std::size_t i = 0;
  for (int k = 1; k < elements; ++k) {
    const double wanted = total * k / elements;
    double piece = 0;
    for (; i + 2 < tau_.size(); ++i) {
      piece = (0.5 * (omega_[i] + omega_[i + 1]) + base) * (tau_[i + 1] - tau_[i]);
      if (passed + piece >= wanted) break;
      passed += piece;
    }
    piece = (0.5 * (omega_[i] + omega_[i + 1]) + base) * (tau_[i + 1] - tau_[i]);
    mesh[k] = tau_[i] + (tau_[i + 1] - tau_[i]) * std::clamp((wanted - passed) / piece, 0.0, 1.0);
  }
  mesh[elements] = 1;
  for (int k = 0; k < elements; ++k)
    if (!(mesh[k + 1] > mesh[k])) return uniform_mesh(elements);
  return mesh;
}

void measure_frequency(const Problem& problem, DiscreteAction& action, const ElementTables& tables,
                       const Path& path, Frequency& frequency) {
  const Structure& s = problem.lagrangian->structure();
  const int points = tables.shape().points;
  const std::size_t stride = static_cast<std::size_t>(points) * lanes;
  const double lightest = lightest_mass(s);
  frequency.clear();
  frequency.set_duration(path.duration());
  for (int b = 0; b < path.batches(); ++b) {
    const double* hessian = action.rows(path, b, Order::hessian) + (1 + s.gradient.size()) * stride;
    for (int lane = 0; lane < std::min(lanes, path.elements() - b * lanes); ++lane) {
      const double from = path.mesh()[b * lanes + lane], to = path.mesh()[b * lanes + lane + 1];
      for (int i = 0; i < points; ++i)
        frequency.add(from + tables.scheme().node[i] * (to - from),
                      std::sqrt(squared_frequency(s, lightest, hessian + i * lanes + lane, stride)));
    }
  }
}

std::vector<double> uniform_mesh(int elements) {
  std::vector<double> mesh(elements + 1);
  for (int k = 0; k <= elements; ++k) mesh[k] = static_cast<double>(k) / elements;
  return mesh;
}

std::vector<double> halved(const std::vector<double>& mesh) {
  std::vector<double> result;
  for (std::size_t k = 0; k + 1 < mesh.size(); ++k) {
    result.push_back(mesh[k]);
    result.push_back(0.5 * (mesh[k] + mesh[k + 1]));
  }
  result.push_back(mesh.back());
  return result;
}

}  // namespace extremal
