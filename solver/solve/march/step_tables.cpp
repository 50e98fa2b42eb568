#include "solve/march/step_tables.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "action/rule.hpp"

namespace extremal {

namespace {

int whole_lanes(int count) {
  const int lanes = simd_lanes();
  return (count + lanes - 1) / lanes * lanes;
}

}  // namespace

const StepKernels& step_kernels() {
  static const StepKernels chosen = at_simd_level(EXTREMAL_AT_EACH_LEVEL(step_kernels))();
  return chosen;
}

StepTables::StepTables(const Scheme& scheme, int points, const Lagrangian& lagrangian)
    : scheme_(scheme, points), lagrangian_(lagrangian) {
  const Structure& structure = lagrangian.structure();
  shape_.n = structure.coordinates;
  shape_.s = scheme_.degree;
  shape_.points = scheme_.points;
  shape_.width = whole_lanes(scheme_.points);
  shape_.functions = whole_lanes(scheme_.degree);
  arrange_basis();
  for (const Triplet& m : structure.mass) mass_.push_back({m.row, m.column, m.value});
  for (const Triplet& c : structure.gyroscopic) gyroscopic_.push_back({c.row, c.column, c.value});
  linear_ = structure.linear;
  list_pairs();
  shape_.mass_count = static_cast<int>(mass_.size());
  shape_.gyroscopic_count = static_cast<int>(gyroscopic_.size());
  shape_.gradient_count = static_cast<int>(structure.gradient.size());
  shape_.pair_count = static_cast<int>(pairs_.size());
  shape_.mass = mass_.data();
  shape_.gyroscopic = gyroscopic_.data();
  shape_.linear = linear_.empty() ? nullptr : linear_.data();
  shape_.gradient = structure.gradient.data();
  shape_.pairs = pairs_.data();
}

/// From the basis (φ_1 … φ_{s−1}, 1 − τ, τ) of the scheme.
void StepTables::arrange_basis() {
  const int s = shape_.s, points = shape_.points, width = shape_.width, rows = shape_.functions;
  node_.assign(width, scheme_.node.back());
  weight_.assign(width, 0.0);
  value_.assign(static_cast<std::size_t>(std::max(s - 1, 1)) * width, 0.0);
  slope_.assign(value_.size(), 0.0);
  test_value_.assign(static_cast<std::size_t>(points) * rows, 0.0);
  test_slope_.assign(test_value_.size(), 0.0);
  sum_value_.assign(test_value_.size(), 0.0);
  sum_slope_.assign(test_value_.size(), 0.0);
  trial_value_.resize(static_cast<std::size_t>(points) * s);
  trial_slope_.resize(trial_value_.size());
  for (int i = 0; i < width; ++i) {
    const int point = std::min(i, points - 1);  // beyond, the last point again: nothing exceptional
    const double *value = &scheme_.value[point * (s + 1)], *slope = &scheme_.slope[point * (s + 1)];
    node_[i] = scheme_.node[point];
    for (int j = 0; j + 1 < s; ++j) {
      value_[j * width + i] = value[j];
      slope_[j * width + i] = slope[j];
    }
    if (i >= points) continue;
    const double weight = weight_[i] = scheme_.weight[i];
    for (int k = 0; k < s; ++k) {
      test_value_[i * rows + k] = weight * value[k];
      test_slope_[i * rows + k] = weight * slope[k];
      const int trial = k == s - 1 ? s : k;
      trial_value_[i * s + k] = value[trial];
      trial_slope_[i * s + k] = slope[trial];
      sum_value_[i * rows + k] = k == s - 1 ? scheme_.node[i] : value[k];
      sum_slope_[i * rows + k] = k == s - 1 ? 1 : slope[k];
    }
  }
  stiffness_.assign(static_cast<std::size_t>(s) * rows, 0.0);
  for (int k = 0; k < s; ++k)
    for (int f = 0; f < s; ++f)
      stiffness_[k * rows + f] = scheme_.stiffness[(k == s - 1 ? s : k) * (s + 1) + f];
  shape_.node = node_.data();
  shape_.weight = weight_.data();
  shape_.value = value_.data();
  shape_.slope = slope_.data();
  shape_.sum_value = sum_value_.data();
  shape_.sum_slope = sum_slope_.data();
  shape_.test_value = test_value_.data();
  shape_.test_slope = test_slope_.data();
  shape_.trial_value = trial_value_.data();
  shape_.trial_slope = trial_slope_.data();
  shape_.stiffness = stiffness_.data();
}

void StepTables::list_pairs() {
  const Structure& structure = lagrangian_.structure();
  const int n = shape_.n;
  std::map<std::pair<int, int>, CoupledPair> found;
  const auto pair = [&](int a, int b) -> CoupledPair& {
    return found.try_emplace({a, b}, CoupledPair{a, b, -1, -1, -1, -1, 0, 0, 0, false}).first->second;
  };
  for (const Triplet& m : structure.mass) pair(m.row, m.column).mass += m.value;
  for (const Triplet& c : structure.gyroscopic) {  // C(row of q', column of q)
    pair(c.row, c.column).vq0 += c.value;
    pair(c.column, c.row).qv0 += c.value;
    pair(c.row, c.column).velocities = pair(c.column, c.row).velocities = true;
  }
  for (int e = 0; e < static_cast<int>(structure.hessian.size()); ++e) {
    const auto [row, column] = structure.hessian[e];
    if (row < n) {
      pair(row, column).qq = pair(column, row).qq = e;
    } else if (column < n) {
      pair(row - n, column).vq = e;
      pair(column, row - n).qv = e;
      pair(row - n, column).velocities = pair(column, row - n).velocities = true;
    } else {
      pair(row - n, column - n).vv = pair(column - n, row - n).vv = e;
      pair(row - n, column - n).velocities = pair(column - n, row - n).velocities = true;
    }
  }
  for (const auto& [key, value] : found) pairs_.push_back(value);
}

}  // namespace extremal
