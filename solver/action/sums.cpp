#include <algorithm>
#include <cmath>

#include "action/discrete_action.hpp"

/// \file What batches of elements leave, summed up from the first to the last.

namespace extremal {

namespace {

/// Of the fastest: momenta where the path is slower say little of inertia.
constexpr double slow = 0.1;

}  // namespace

void DiscreteAction::clear_sums() {
  action_ = slope_duration_ = residual_ = momentum_scale_ = 0;
  std::fill(nodes.gradient.begin(), nodes.gradient.end(), 0.0);
  std::fill(raw_nodes_.begin(), raw_nodes_.end(), 0.0);
  nodes.border_gradient = nodes.border_part = 0;
  nodes.end_parts.clear();
  extended_ready_ = false;
}

/// Keeps of the gradient of a batch, before condensation, what is summed up.
void DiscreteAction::keep_gradient(int b, const double* gradient) {
  double* const largest = sums(b, of_residual);
  std::fill_n(largest, lanes, 0.0);
  for (int u = 0; u < inner_; ++u)
    for (int lane = 0; lane < lanes; ++lane) {
      const double size = std::abs(gradient[u * lanes + lane]);
      largest[lane] = size > largest[lane] ? size : largest[lane];
    }
  std::copy_n(gradient + inner_ * lanes, 2 * n_ * lanes, sums(b, of_ends));
}

/// Puts the gradient of a batch there as rounded from extended precision. Where elements meet, the difference
/// of their momenta is rounded, not they: the element before has it, the one behind has nothing. At the ends
/// of the path the digits that do not fit a double stay.
void DiscreteAction::take_extended(int b, double* gradient) {
  double *action = sums(b, of_action), *slope = sums(b, of_slope);
  std::fill_n(gradient, sizes_.vector, 0.0);
  std::fill_n(action, lanes, 0.0);
  std::fill_n(slope, lanes, 0.0);
  const std::size_t width = static_cast<std::size_t>(inner_);
  const DoubleDouble* const nodes = taken().nodes.data();
  for (int k = b * lanes, lane = 0; lane < lanes && k < elements_; ++k, ++lane) {
    const DoubleDouble *inner = taken().inner.data() + k * width,
                       *left = nodes + static_cast<std::size_t>(k) * n_;
    for (int u = 0; u < inner_; ++u) gradient[u * lanes + lane] = inner[u].x[0];
    for (int a = 0; a < n_; ++a) {
      const DoubleDouble& right = left[n_ + a];
      if (k == 0) gradient[(inner_ + a) * lanes + lane] = left[a].x[1];
      gradient[(inner_ + n_ + a) * lanes + lane] = right.x[k + 1 == elements_];
    }
  }
  keep_gradient(b, gradient);
}

/// What take_extended() left out.
void DiscreteAction::finish_extended() {
  const std::vector<DoubleDouble>& g = taken().nodes;
  const std::size_t last = g.size() - n_;
  nodes.end_parts.resize(2 * static_cast<std::size_t>(n_));
  for (int a = 0; a < n_; ++a) {
    start_gradient_[a] = nodes.end_parts[a] = g[a].x[0];
    end_gradient_[a] = nodes.end_parts[n_ + a] = g[last + a].x[0];
  }
  action_ = taken().action.x[0];
  slope_duration_ = taken().slope_duration.x[0];
  momentum_scale_ = taken().momentum_scale;
  nodes.border_part = slope_duration_;
  nodes.border_gradient += taken().slope_duration.x[1];
}

/// Sums the values and the gradient of a batch as they are, before condensation.
void DiscreteAction::gather(const Path& path, int b) {
  const double *action = sums(b, of_action), *slope = sums(b, of_slope), *largest = sums(b, of_residual),
               *ends = sums(b, of_ends);
  const int first = b * lanes, last = std::min(elements_, first + lanes);
  residual_ = std::max(residual_, *std::max_element(largest, largest + lanes));
  for (int k = first; k < last; ++k) {
    const int lane = k - first;
    action_ += action[lane];
    if (border_) slope_duration_ += slope[lane] * path.lengths()[k];
    double* node = raw_nodes_.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) {
      const double g = ends[a * lanes + lane];
      node[a] += g;
      momentum_scale_ = std::max(momentum_scale_, std::abs(g));
    }
  }
}

double DiscreteAction::momentum_range() const {
  double range = 0;
  for (int a = 0; a < n_ && !extended_ready_; ++a) {
    double low = -start_gradient_[a], high = low;
    for (int k = 0; k < elements_; ++k) {
      const double p = sums(k / lanes, of_ends)[(n_ + a) * lanes + k % lanes];
      low = std::min(low, p);
      high = std::max(high, p);
    }
    range = std::max(range, high - low);
  }
  return range;
}

/// Momenta at the ends of elements by velocities within, where these are not small.
double DiscreteAction::inertia(const Path& path) const {
  if (extended_ready_) return 0;
  const auto speed = [&](int k) {
    const double* delta =
        path.x(k / lanes) + static_cast<std::size_t>(path.degree() * n_) * lanes + k % lanes;
    double largest = 0;
    for (int a = 0; a < n_; ++a) largest = std::max(largest, std::abs(delta[a * lanes]));
    return largest / path.h(k / lanes)[k % lanes];
  };
  double fastest = 0, inertia = 0;
  for (int k = 0; k < elements_; ++k) fastest = std::max(fastest, speed(k));
  for (int k = 0; k < elements_; ++k) {
    const double fast = speed(k),
                 *p = sums(k / lanes, of_ends) + static_cast<std::size_t>(n_) * lanes + k % lanes;
    for (int a = 0; a < n_ && fast > slow * fastest; ++a)
      inertia = std::max(inertia, std::abs(p[a * lanes]) / fast);
  }
  return inertia;
}

void DiscreteAction::gather_pivots(int b) {
  const double *negative = sums(b, of_negative), *ratio = sums(b, of_ratio);
  for (int lane = 0; lane < std::min(lanes, elements_ - b * lanes); ++lane) {
    nodes.negative += static_cast<int>(negative[lane]);
    if (!(ratio[lane] >= nodes.pivot_ratio)) nodes.pivot_ratio = ratio[lane];
  }
}

void DiscreteAction::gather_gradient(int b) {
  const double* gradient = reduced(b);
  const int first = b * lanes, last = std::min(elements_, first + lanes);
  for (int k = first; k < last; ++k) {
    double* node = nodes.gradient.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) node[a] += gradient[(inner_ + a) * lanes + k - first];
  }
  if (!border_) return;
  double taken[lanes];
  eliminated(b, gradient, gradient + sizes_.vector, taken);
  for (int k = first; k < last; ++k) nodes.border_gradient -= taken[k - first];
}

/// Σ x_j y_j / d_j of each lane: what elimination takes from the product of two vectors.
void DiscreteAction::eliminated(int b, const double* x, const double* y, double* sum) const {
  const Fronts& fronts = condensation_->fronts;
  const double* inverse = inverses_.data() + b * sizes_.vector;
  std::fill_n(sum, lanes, 0.0);
  for (int f = 0; f < fronts.count(); ++f) {
    const FrontView& front = fronts.data()[f];
    for (int j = 0; j < front.pivots; ++j, inverse += lanes) {
      const int u = front.unknown[j] * lanes;
      for (int lane = 0; lane < lanes; ++lane) sum[lane] += x[u + lane] * y[u + lane] * inverse[lane];
    }
  }
}

void DiscreteAction::finish_sums() {
  for (int a = 0; a < n_; ++a) {
    start_gradient_[a] = raw_nodes_[a];
    end_gradient_[a] = raw_nodes_[static_cast<std::size_t>(elements_) * n_ + a];
  }
  for (std::size_t k = n_; k < static_cast<std::size_t>(elements_) * n_; ++k)
    residual_ = std::max(residual_, std::abs(raw_nodes_[k]));
  if (extended_ready_)
    finish_extended();
  else
    nodes.border_gradient += slope_duration_;
  double sum = action_;
  for (double g : raw_nodes_) sum += g;
  finite_ = std::isfinite(sum) && std::isfinite(residual_) && std::isfinite(slope_duration_);
}

}  // namespace extremal
