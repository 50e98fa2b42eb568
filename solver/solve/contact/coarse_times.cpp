#include <algorithm>
#include <cmath>
#include <functional>

#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/element_hessian.hpp"
#include "solve/contact/limits.hpp"

/// \file Times of a coarse path: those of waypoints, and derivatives by those that are free.

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Square = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

std::vector<WaypointCondition> waypoints_of(const Problem& problem) {
  return problem.extension ? problem.extension->waypoints : std::vector<WaypointCondition>{};
}

/// Of a node, also in the next period.
double time_at(const std::vector<double>& times, int node) {
  const int last = static_cast<int>(times.size()) - 1;
  return node > last ? times[node - last] + times.back() : times[node];
}

/// Equal elements between the ends and waypoints, whose times are given.
std::vector<double> equal_times(const std::vector<double>& given, double duration, int elements) {
  const int count = static_cast<int>(given.size());
  std::vector<double> times{0};
  for (int w = 0; w <= count; ++w) {
    const double from = times.back(), to = w < count ? given[w] : duration;
    // At least one element remains for each leg that follows.
    const int first = static_cast<int>(times.size()) - 1, last = elements - (count - w);
    const int node = w == count ? elements
                                : std::clamp(static_cast<int>(std::lround(to / duration * elements)),
                                             first + 1, std::max(last, first + 1));
    for (int k = first + 1; k < node; ++k) times.push_back(from + (to - from) * (k - first) / (node - first));
    times.push_back(to);
  }
  return times;
}

/// Nodes within a stretch are replaced by equal elements; those that are given stay.
void put_closer(double from, double to, const std::vector<double>& given, std::vector<double>& times) {
  const double step = (to - from) / limits::contact::closer_elements;
  const auto stays = [&](double t) {
    return t == times.back() || t == 0 || std::ranges::count(given, t) > 0;
  };
  std::vector<double> kept;
  for (const double t : times)
    if (t < from - step / 2 || t > to + step / 2 || stays(t)) kept.push_back(t);
  const std::size_t before = kept.size();
  for (int k = 0; k <= limits::contact::closer_elements; ++k) {
    const double t = from + k * step;
    const auto next =
        std::lower_bound(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(before), t - step / 2);
    const bool near = next != kept.begin() + static_cast<std::ptrdiff_t>(before) && *next <= t + step / 2;
    if (!near && t > 0 && t < times.back()) kept.push_back(t);
  }
  std::ranges::sort(kept);
  times = std::move(kept);
}

}  // namespace

std::vector<double> coarse_times(const Problem& problem, const CoarseElements& elements) {
  const double duration = problem.duration.value;
  std::vector<double> given;
  for (const WaypointCondition& waypoint : waypoints_of(problem)) given.push_back(waypoint.at(duration));
  std::vector<double> times = equal_times(given, duration, elements.equal);
  std::vector<Stretch> closer = elements.closer;
  std::ranges::stable_sort(closer, std::ranges::greater{}, &Stretch::length);
  for (const Stretch& stretch : closer)
    put_closer(stretch.from * duration, stretch.to * duration, given, times);
  return times;
}

/// Each at the node that is nearest to its time.
void CoarseAction::put_waypoints() {
  const std::vector<WaypointCondition> waypoints = waypoints_of(problem_);
  std::vector<int> nodes{0};
  for (const WaypointCondition& waypoint : waypoints) {
    const double t = waypoint.at(times_.back());
    const auto after = std::lower_bound(times_.begin() + 1, times_.end() - 2, t);
    const bool before = after != times_.begin() + 1 && t - *(after - 1) < *after - t;
    nodes.push_back(static_cast<int>(after - times_.begin()) - before);
    for (const auto& [a, value] : waypoint.fixed) waypoints_.push_back({nodes.back(), a, value});
  }
  shifts_ = !waypoints.empty() && problem_.shifts_in_time() && inequalities_.all->autonomous();
  // Of a closed path that may be shifted in time, the leg after the last waypoint ends at the first.
  nodes.push_back(shifts_ ? elements_ + nodes[1] : elements_);
  for (std::size_t w = 0; w < waypoints.size(); ++w) {
    if (!waypoints[w].free) continue;
    free_waypoints_.push_back({static_cast<int>(w), nodes[w + 1]});
    if (w > 0 || !shifts_) free_times_.push_back({nodes[w], nodes[w + 1], nodes[w + 2]});
  }
}

/// Those of the elements that stretch.
std::vector<int> CoarseAction::nodes_beside(const FreeTime& free) const {
  std::vector<int> nodes;
  for (int k = 0; k <= free.after - elements_; ++k) nodes.push_back(k);
  for (int k = free.before; k <= std::min(free.after, elements_); ++k) nodes.push_back(k);
  return nodes;
}

double CoarseAction::stretch(const FreeTime& free, int element) const {
  const int k = element < free.before ? element + elements_ : element;
  if (k >= free.after) return 0;
  const bool before = k < free.node;
  const int from = before ? free.before : free.node, to = before ? free.node : free.after;
  return (before ? 1 : -1) * length(element) / (time_at(times_, to) - time_at(times_, from));
}

bool CoarseAction::ordered() const {
  return std::ranges::adjacent_find(times_, std::greater_equal<>()) == times_.end();
}

std::vector<double> CoarseAction::variables(std::span<const double> z, double size) const {
  std::vector<double> x(z.begin(), z.end());
  for (const FreeTime& free : free_times_)
    x.push_back((times_[free.node] - times_[origin()]) * size / times_.back());
  return x;
}

std::vector<double> CoarseAction::times_at(std::span<const double> variables, double size) const {
  std::vector<double> times = times_;
  const std::span<const double> since = variables.subspan(nodes_size());
  if (since.empty()) return times;
  const double duration = times_.back();
  if (shifts_) {
    // The end of the path keeps its part of the leg across it.
    const double before = duration - times_[free_times_.back().node], first = times_[origin()];
    times[origin()] = first / (first + before) * (duration - since.back() * duration / size);
  }
  const double first = times[origin()];
  for (std::size_t f = 0; f < free_times_.size(); ++f)
    times[free_times_[f].node] = first + since[f] * duration / size;
  // Nodes between keep their part of a leg.
  const auto keep = [&](int from, int to) {
    const double begin = time_at(times, from), end = time_at(times, to);
    const double old_begin = time_at(times_, from), old_end = time_at(times_, to);
    for (int k = from + 1; k < to; ++k) {
      const double time = begin + (end - begin) * (time_at(times_, k) - old_begin) / (old_end - old_begin);
      if (k < elements_) times[k] = time;
      if (k > elements_) times[k - elements_] = time - duration;
    }
  };
  for (const FreeTime& free : free_times_) {
    keep(free.before, free.node);
    keep(free.node, free.after);
  }
  return times;
}

CoarseAction CoarseAction::at_variables(std::span<const double> variables, double size) const {
  CoarseAction moved = *this;
  moved.times_ = times_at(variables, size);
  return moved;
}

VectorXd CoarseAction::velocity(std::span<const double> z, int k) const {
  Point point;
  midpoint(z, k, point);
  return Eigen::Map<const VectorXd>(point.v.data(), n_);
}

VectorXd CoarseAction::time_slopes(std::span<const double> z) const {
  VectorXd slopes = VectorXd::Zero(static_cast<Index>(free_times_.size()));
  for (int k = 0; k < elements_ && slopes.size() > 0; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    const double slope = l.value - velocity(z, k).dot(Eigen::Map<const VectorXd>(l.dv.data(), n_));
    for (Index f = 0; f < slopes.size(); ++f) slopes[f] += stretch(free_times_[f], k) * slope;
  }
  return slopes;
}

/// ∂∫g/∂t, a row of each g.
MatrixXd CoarseAction::integral_rates(std::span<const double> z) const {
  const int m = integrals(), all = first_multiplier() + m;
  MatrixXd rates = MatrixXd::Zero(m, static_cast<Index>(free_times_.size()));
  for (int k = 0; k < elements_ && rates.size() > 0; ++k) {
    const PointValues l = values(z, k, Order::hessian);
    const VectorXd by_length =
        Eigen::Map<const VectorXd>(l.dq.data(), all).tail(m) -
        Square(l.vq.data(), all, all).topRightCorner(n_, m).transpose() * velocity(z, k);
    for (Index f = 0; f < rates.cols(); ++f) rates.col(f) += stretch(free_times_[f], k) * by_length;
  }
  return rates;
}

MatrixXd CoarseAction::mixed_with_times(std::span<const double> z, double factor,
                                        std::span<const double> nu) const {
  MatrixXd mixed = MatrixXd::Zero(static_cast<Index>(free_times_.size()), static_cast<Index>(nodes_size()));
  for (int k = 0; k < elements_ && mixed.rows() > 0; ++k) {
    const ElementStretch element =
        element_stretch(weighted(z, k, Order::hessian, factor, nu), velocity(z, k), length(k));
    for (Index f = 0; f < mixed.rows(); ++f) {
      const double longer = stretch(free_times_[f], k);
      mixed.row(f).segment(k * n_, n_) += longer * element.by_start.transpose();
      mixed.row(f).segment((k + 1) * n_, n_) += longer * element.by_end.transpose();
    }
  }
  return mixed;
}

MatrixXd CoarseAction::between_times(std::span<const double> z, double factor,
                                     std::span<const double> nu) const {
  const auto count = static_cast<Index>(free_times_.size());
  MatrixXd between = MatrixXd::Zero(count, count);
  for (int k = 0; k < elements_ && count > 0; ++k) {
    VectorXd longer(count);
    for (Index f = 0; f < count; ++f) longer[f] = stretch(free_times_[f], k);
    const PointValues l = weighted(z, k, Order::hessian, factor, nu);
    between += element_stretch(l, velocity(z, k), length(k)).second * longer * longer.transpose();
  }
  return between;
}

}  // namespace extremal
