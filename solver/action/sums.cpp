#include <algorithm>
#include <cmath>

#include "action/discrete_action.hpp"

/// \file What batches of elements leave, summed up from the first to the last.

namespace extremal {

namespace {

/// Of the fastest: momenta where the path is slower say little of inertia.
constexpr double slow = 0.1;

/// Largest |x|; not-a-number is passed over. Eight maxima side by side, which compilers turn into vectors.
double largest_magnitude(const double* x, int count) {
  constexpr int parts = 8;
  double part[parts] = {};
  int i = 0;
  for (; i + parts <= count; i += parts)
    for (int k = 0; k < parts; ++k) {
      const double size = std::abs(x[i + k]);
      part[k] = size > part[k] ? size : part[k];
    }
  for (; i < count; ++i) part[0] = std::max(part[0], std::abs(x[i]));
  return *std::max_element(part, part + parts);
}

}  // namespace

void DiscreteAction::clear_sums() {
  action_ = slope_duration_ = residual_ = momentum_scale_ = 0;
  std::fill(nodes.gradient.begin(), nodes.gradient.end(), 0.0);
  std::fill(raw_nodes_.begin(), raw_nodes_.end(), 0.0);
  nodes.border_gradient = nodes.border_part = 0;
  nodes.end_parts.clear();
  corners_.clear();
  extended_ready_ = stopped_ = false;
}

/// Keeps of the gradient of a batch, before condensation, what is summed up.
void DiscreteAction::keep_gradient(int b, const double* gradient) {
  *sums(b, of_residual) = largest_magnitude(gradient, inner_ * lanes_);
  std::copy_n(gradient + inner_ * lanes_, 2 * n_ * lanes_, sums(b, of_ends));
}

/// Puts the gradient of a batch there as rounded from extended precision. Where elements meet, the difference
/// of their momenta is rounded, not they: the element before has it, the one behind has nothing. At the ends
/// of the path the digits that do not fit a double stay.
void DiscreteAction::take_extended(int b, double* gradient) {
  double *action = sums(b, of_action), *slope = sums(b, of_slope);
  std::fill_n(gradient, sizes_.vector, 0.0);
  std::fill_n(action, lanes_, 0.0);
  std::fill_n(slope, lanes_, 0.0);
  const std::size_t width = static_cast<std::size_t>(inner_);
  const DoubleDouble* const nodes = taken().nodes.data();
  for (int lane = 0; lane < lanes_; ++lane) {
    const int k = std::min(b * lanes_ + lane, elements_ - 1);  // idle lanes copy the last element
    const DoubleDouble *inner = taken().inner.data() + k * width,
                       *left = nodes + static_cast<std::size_t>(k) * n_;
    for (int u = 0; u < inner_; ++u) gradient[u * lanes_ + lane] = inner[u].x[0];
    for (int a = 0; a < n_; ++a) {
      const DoubleDouble& right = left[n_ + a];
      if (k == 0) gradient[(inner_ + a) * lanes_ + lane] = left[a].x[1];
      gradient[(inner_ + n_ + a) * lanes_ + lane] = right.x[k + 1 == elements_];
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
  const double *action = sums(b, of_action), *slope = sums(b, of_slope), *ends = sums(b, of_ends);
  const int first = b * lanes_, last = std::min(elements_, first + lanes_);
  residual_ = std::max(residual_, *sums(b, of_residual));
  for (int k = first; k < last; ++k) {
    const int lane = k - first;
    action_ += action[lane];
    if (border_) slope_duration_ += slope[lane] * path.lengths()[k];
    double* node = raw_nodes_.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) {
      const double g = ends[a * lanes_ + lane];
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
      const double p = sums(k / lanes_, of_ends)[(n_ + a) * lanes_ + k % lanes_];
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
        path.x(k / lanes_) + static_cast<std::size_t>(path.degree() * n_) * lanes_ + k % lanes_;
    double largest = 0;
    for (int a = 0; a < n_; ++a) largest = std::max(largest, std::abs(delta[a * lanes_]));
    return largest / path.h(k / lanes_)[k % lanes_];
  };
  double fastest = 0, inertia = 0;
  for (int k = 0; k < elements_; ++k) fastest = std::max(fastest, speed(k));
  for (int k = 0; k < elements_; ++k) {
    const double fast = speed(k),
                 *p = sums(k / lanes_, of_ends) + static_cast<std::size_t>(n_) * lanes_ + k % lanes_;
    for (int a = 0; a < n_ && fast > slow * fastest; ++a)
      inertia = std::max(inertia, std::abs(p[a * lanes_]) / fast);
  }
  return inertia;
}

void DiscreteAction::gather_pivots(int b) {
  const double *negative = sums(b, of_negative), *ratio = sums(b, of_ratio);
  for (int lane = 0; lane < std::min(lanes_, elements_ - b * lanes_); ++lane) {
    nodes.negative += static_cast<int>(negative[lane]);
    if (!(ratio[lane] >= nodes.pivot_ratio)) nodes.pivot_ratio = ratio[lane];
  }
}

void DiscreteAction::gather_gradient(int b) {
  const double* gradient = reduced(b);
  const int first = b * lanes_, last = std::min(elements_, first + lanes_);
  for (int k = first; k < last; ++k) {
    double* node = nodes.gradient.data() + static_cast<std::size_t>(k) * n_;
    for (int a = 0; a < 2 * n_; ++a) node[a] += gradient[(inner_ + a) * lanes_ + k - first];
  }
  if (!border_) return;
  double taken[most_lanes];
  eliminated(b, gradient, gradient + sizes_.vector, taken);
  for (int k = first; k < last; ++k) nodes.border_gradient -= taken[k - first];
}

/// Σ x_j y_j / d_j of each lane: what elimination takes from the product of two vectors.
void DiscreteAction::eliminated(int b, const double* x, const double* y, double* sum) const {
  const Fronts& fronts = condensation_->fronts;
  const double* inverse = inverses_.data() + b * sizes_.vector;
  std::fill_n(sum, lanes_, 0.0);
  for (int f = 0; f < fronts.count(); ++f) {
    const FrontView& front = fronts.data()[f];
    for (int j = 0; j < front.pivots; ++j, inverse += lanes_) {
      const int u = front.unknown[j] * lanes_;
      for (int lane = 0; lane < lanes_; ++lane) sum[lane] += x[u + lane] * y[u + lane] * inverse[lane];
    }
  }
}

/// Finds the corners of a path, and adds what they contribute to the gradient.
void DiscreteAction::measure_corners(const Path& path) {
  corners_ = corners_of(*tables_->kinks(), path, closed_);
  for (const Corner& corner : corners_) {
    const std::size_t first = static_cast<std::size_t>(corner.node) * n_;
    add_force(corner, corner.u, nodes.gradient.data() + first);
    add_force(corner, corner.u, raw_nodes_.data() + first);
  }
}

void DiscreteAction::add_corners() {
  for (const Corner& corner : corners_)
    add_stiffness(corner,
                  corner.node == elements_ ? nodes.last.data() : nodes.chain.diagonal(corner.node - 1));
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
  if (!momenta_.empty() && !changed_) add_momenta();
  double sum = action_;
  for (double g : raw_nodes_) sum += g;
  finite_ = !stopped_ && std::isfinite(sum) && std::isfinite(residual_) && std::isfinite(slope_duration_);
}

/// ∂/∂q of p(0)·q(0) − p(T)·q(T).
void DiscreteAction::add_momenta() {
  nodes.end_parts.resize(momenta_.size());
  for (int a = 0; a < n_; ++a) {
    nodes.end_parts[a] += momenta_[a];
    nodes.end_parts[n_ + a] -= momenta_[n_ + a];
  }
}

/// Value and slopes of the costs of the ends.
void DiscreteAction::add_costs(const Path& path) {
  if (costs_.empty()) return;
  const std::size_t n = n_;
  cost_slopes_.assign(2 * n, 0);
  nodes.end_parts.resize(2 * n);
  for (const std::size_t end : {0, 1})
    if (costs_[end].given())
      action_ += costs_[end].add(path.node(end == 0 ? 0 : elements_), cost_slopes_.data() + end * n);
  for (std::size_t e = 0; e < 2 * n; ++e) nodes.end_parts[e] += cost_slopes_[e];
}

void DiscreteAction::add_stiffness_of_costs() {
  for (std::size_t end = 0; end < costs_.size(); ++end) {
    std::vector<double>& block = end == 0 ? nodes.first : nodes.last;
    for (std::size_t k = 0; k < costs_[end].stiffness.size(); ++k) block[k] += costs_[end].stiffness[k];
  }
}

double DiscreteAction::imbalance(int e) const {
  const double given = momenta_.empty() ? 0 : momenta_[e];
  const double slope = cost_slopes_.empty() ? 0 : cost_slopes_[e];
  return slope + (e < n_ ? start_gradient_[e] + given : end_gradient_[e - n_] - given);
}

}  // namespace extremal
