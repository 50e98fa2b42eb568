#include "solve/mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace extremal {

void Density::clear() {
  tau_.clear();
  value_.clear();
  sum_ = 0;
}

void Density::add(double tau, double value) {
  if (!tau_.empty()) {
    if (tau <= tau_.back()) return;
    sum_ += 0.5 * (value + value_.back()) * (tau - tau_.back());
  }
  least_ = tau_.empty() ? value : std::min(least_, value);
  most_ = tau_.empty() ? value : std::max(most_, value);
  tau_.push_back(tau);
  value_.push_back(value);
}

double Density::grading(double floor) const {
  const double base = floor * sum_;
  return least_ + base > 0 ? (most_ + base) / (least_ + base) : 1;
}

std::vector<double> Density::mesh(int elements, double floor) const {
  if (!(sum_ > 0)) return uniform_mesh(elements);
  const double base = floor * sum_, total = sum_ + base;
  std::vector<double> mesh(elements + 1);
  double passed = 0;
  std::size_t i = 0;
  for (int k = 1; k < elements; ++k) {
    const double wanted = total * k / elements;
    for (; i + 2 < tau_.size(); ++i) {
      const double piece = (0.5 * (value_[i] + value_[i + 1]) + base) * (tau_[i + 1] - tau_[i]);
      if (passed + piece >= wanted) break;
      passed += piece;
    }
    // Where a linear density from a to b has passed the share r of its integral.
    const double a = value_[i] + base, b = value_[i + 1] + base, width = tau_[i + 1] - tau_[i];
    const double r = std::clamp((wanted - passed) / (0.5 * (a + b) * width), 0.0, 1.0);
    mesh[k] = tau_[i] + width * r * (a + b) / (a + std::sqrt(a * a + (b * b - a * a) * r));
  }
  mesh[elements] = 1;
  for (int k = 0; k < elements; ++k)
    if (!(mesh[k + 1] > mesh[k])) return uniform_mesh(elements);
  return mesh;
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

std::vector<double> graded(std::vector<double> mesh, double ratio) {
  for (std::size_t before = 0; before < mesh.size();) {
    before = mesh.size();
    std::vector<double> finer{mesh.front()};
    for (std::size_t k = 0; k + 1 < before; ++k) {
      const double length = mesh[k + 1] - mesh[k];
      const double left = k > 0 ? mesh[k] - mesh[k - 1] : length;
      const double right = k + 2 < before ? mesh[k + 2] - mesh[k + 1] : length;
      if (length > ratio * std::min(left, right)) finer.push_back(0.5 * (mesh[k] + mesh[k + 1]));
      finer.push_back(mesh[k + 1]);
    }
    mesh = std::move(finer);
  }
  return mesh;
}

std::vector<double> with_nodes(std::span<const double> mesh, std::span<const double> times) {
  constexpr double near = 0.3;
  std::vector<double> result(times.begin(), times.end());
  result.push_back(0);
  result.push_back(1);
  for (std::size_t k = 1; k + 1 < mesh.size(); ++k) {
    const double reach = near * std::min(mesh[k] - mesh[k - 1], mesh[k + 1] - mesh[k]);
    const auto after = std::lower_bound(times.begin(), times.end(), mesh[k]);
    const bool close = (after != times.end() && *after - mesh[k] < reach) ||
                       (after != times.begin() && mesh[k] - *(after - 1) < reach);
    if (!close) result.push_back(mesh[k]);
  }
  for (std::size_t k = 1; k < times.size(); ++k) {
    const auto between = [&](double t) { return t > times[k - 1] && t < times[k]; };
    if (std::ranges::none_of(result, between)) result.push_back(0.5 * (times[k - 1] + times[k]));
  }
  std::sort(result.begin(), result.end());
  return result;
}

double distance_to_nodes(std::span<const double> mesh, std::span<const double> times) {
  double largest = 0;
  for (const double t : times) {
    const auto after = std::lower_bound(mesh.begin() + 1, mesh.end() - 1, t);
    largest = std::max(largest, std::min(std::abs(*after - t), std::abs(t - *(after - 1))));
  }
  return largest;
}

std::vector<double> interpolated(std::span<const double> values, std::size_t n, std::span<const double> from,
                                 std::span<const double> to) {
  std::vector<double> result;
  result.reserve(to.size() * n);
  for (std::size_t k = 0, left = 0; k < to.size(); ++k) {
    while (left + 2 < from.size() && from[left + 1] < to[k]) ++left;
    const double share = (to[k] - from[left]) / (from[left + 1] - from[left]);
    const double* at = values.data() + left * n;
    for (std::size_t a = 0; a < n; ++a) result.push_back(at[a] + share * (at[n + a] - at[a]));
  }
  return result;
}

}  // namespace extremal
