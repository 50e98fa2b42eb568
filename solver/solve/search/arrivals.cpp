#include "solve/search/arrivals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "linear/dense.hpp"
#include "motion/dop853.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::arrivals;
using namespace limits::scanned_motions;

namespace {

using Vector = Arrivals::Vector;

/// Of length one, where the slope does nothing.
Vector null_direction(const Eigen::MatrixXd& slope) {
  return singular_value_decomposition(slope).v.col(slope.cols() - 1);
}

}  // namespace

Arrivals::Arrivals(const Lagrangian& lagrangian, Vector start, Vector rest, Vector end, Eigen::MatrixXd root,
                   const Tangents& tangents, double speed, double time)
    : flow_(lagrangian),
      n_(static_cast<int>(start.size())),
      dimensions_(static_cast<int>(tangents.start.cols())),
      cost_(lagrangian.structure().quadratic ? 1 : implicit_cost),
      start_(std::move(start)),
      rest_(std::move(rest)),
      end_(std::move(end)),
      root_(std::move(root)),
      along_(tangents.start),
      onto_(tangents.end.transpose() * root_),
      speed_(speed),
      time_(time),
      extent_(std::max((root_ * (end_ - start_)).norm(), (root_ * end_).norm())) {
  if (!(extent_ > 0)) extent_ = speed_ * time_;
}

/// (q, p) at t = 0.
Vector Arrivals::state(const Vector& w) const {
  Vector y(2 * n_);
  y << start_, rest_ + root_ * w;
  return y;
}

/// w by the unit of speed, and the logarithm of the time by its unit.
Vector Arrivals::unknowns(const Arrival& arrival) const {
  Vector u(dimensions_ + 1);
  u.head(dimensions_) = along_.transpose() * arrival.w / speed_;
  u[dimensions_] = std::log(arrival.time / time_);
  return u;
}

Arrivals::Arrival Arrivals::arrival(const Vector& u) const {
  return {speed_ * along_ * u.head(dimensions_), time_ * std::exp(u[dimensions_])};
}

/// The motion with its variations by w.
bool Arrivals::fly(const Vector& u, double step_error, Miss& miss) {
  const Arrival goal = arrival(u);
  Vector y = Vector::Zero(2 * n_ * (1 + dimensions_)), v(n_);
  y.head(2 * n_) = state(goal.w);
  for (int k = 0; k < dimensions_; ++k) y.segment(2 * n_ * (k + 1) + n_, n_) = speed_ * root_ * along_.col(k);
  if (!y.allFinite()) return false;
  DormandPrince<double> method(
      [this](double t, std::span<const double> x, std::span<double> slope) {
        return flow_.slope_with_variations(t, x, slope);
      },
      static_cast<int>(y.size()));
  IntegrationOptions options;
  options.tolerance = step_error;
  options.block = n_;
  options.controlled = 2 * n_;
  options.max_steps = most_integrator_steps;
  double t = 0;
  const Integrated result = method.advance(t, span_of(y), goal.time, options);
  if (!counted_(variations_cost * cost_ * (method.steps() + method.rejected())) || result != Integrated::done)
    return false;
  if (!flow_.velocity(span_of(y).first(n_), span_of(y).subspan(n_, n_), t, span_of(v))) return false;
  miss.miss = onto_ * (y.head(n_) - end_) / extent_;
  miss.away = (root_ * (y.head(n_) - end_)).norm() / extent_;
  miss.slope.resize(dimensions_, dimensions_ + 1);
  for (int k = 0; k < dimensions_; ++k) miss.slope.col(k) = onto_ * y.segment(2 * n_ * (k + 1), n_) / extent_;
  miss.slope.col(dimensions_) = onto_ * v * (goal.time / extent_);
  return miss.miss.allFinite() && miss.slope.allFinite();
}

/// Newton's method across the normal; a step as short as the last leaves about its square.
bool Arrivals::meet(Vector& u, const Vector& normal, const Nearness& wanted, Eigen::MatrixXd& slope,
                    int& steps) {
  double before = INFINITY;
  for (steps = 0; steps < most_newton_steps; ++steps) {
    Miss at;
    if (!fly(u, wanted.step_error, at)) return false;
    slope = at.slope;
    // Another point of a manifold may be seen where q1 is.
    const bool there = at.away <= seen_beside + seen_near * at.miss.norm();
    if (at.miss.norm() <= wanted.last * wanted.last) return there;
    Eigen::MatrixXd matrix(dimensions_ + 1, dimensions_ + 1);
    matrix << at.slope, normal.transpose();
    Vector right = Vector::Zero(dimensions_ + 1);
    right.head(dimensions_) = -at.miss;
    const Vector step = solved(matrix, right);
    const double size = step.norm();
    if (!(size < before * contraction) || !(size < longest_correction * (1 + u.head(dimensions_).norm())))
      return false;
    before = size;
    u += step;
    if (size <= wanted.last) return there;
  }
  return false;
}

/// Arrivals at the time between two points of a curve, where its cubic interpolation crosses it.
void Arrivals::cross(const Vector& a, const Vector& slope_a, const Vector& b, const Vector& slope_b,
                     double length, std::vector<Arrival>& found) {
  const auto between = [&](double x) -> Vector {
    const double y = 1 - x;
    return y * y * (1 + 2 * x) * a + x * x * (1 + 2 * y) * b + length * x * y * (y * slope_a - x * slope_b);
  };
  Vector last = a;
  for (int k = 1; k <= crossing_samples; ++k) {
    const Vector next = between(static_cast<double>(k) / crossing_samples);
    if ((last[dimensions_] < 0) != (next[dimensions_] < 0)) {
      Vector u = last + (next - last) * (last[dimensions_] / (last[dimensions_] - next[dimensions_]));
      u[dimensions_] = 0;
      Eigen::MatrixXd slope;
      int steps = 0;
      const Vector normal = Vector::Unit(dimensions_ + 1, dimensions_);
      if (meet(u, normal, {step_error_along, last_step_along}, slope, steps) &&
          meet(u, normal, {step_error_arriving, last_step_arriving}, slope, steps))
        found.push_back(arrival(u));
    }
    last = next;
  }
}

/// One way along a curve; whether it closes.
bool Arrivals::trace(const Vector& seed, double sense, double fastest, double longest,
                     std::vector<Arrival>& found) {
  Miss at;
  if (!fly(seed, step_error_along, at)) return false;
  std::vector<Point>& curve = curves_.emplace_back();
  Vector u = seed, tangent = sense * null_direction(at.slope);
  curve.push_back({u, tangent});
  double length = first_length, last_length = 0;
  Vector last_tangent = tangent;
  for (int k = 0; k < most_points && length > least_length; ++k) {
    // The parabola through the tangents here and before.
    Vector next = u + length * tangent;
    if (last_length > 0) next += length * length / (2 * last_length) * (tangent - last_tangent);
    int steps = 0;
    if (!meet(next, tangent, {step_error_along, last_step_along}, at.slope, steps)) {
      if (!counted_(0)) return false;
      length *= 0.4;
      continue;
    }
    Vector onward = null_direction(at.slope);
    double cosine = onward.dot(tangent);
    if (cosine < 0) {
      onward = -onward;
      cosine = -cosine;
    }
    if (cosine < sharpest_turn) {
      length *= 0.4;
      continue;
    }
    cross(u, tangent, next, onward, (next - u).norm(), found);
    const bool closed = k > 2 && (next - seed).norm() < length;
    last_length = (next - u).norm();
    u = next;
    last_tangent = std::exchange(tangent, onward);
    curve.push_back({u, tangent});
    if (closed) return true;
    const bool later = tangent[dimensions_] > 0;
    if (u.head(dimensions_).norm() * speed_ > fastest ||
        (later && u[dimensions_] > std::log(longest / time_)))
      return false;
    if (steps <= 2 && cosine > mild_turn)
      length = std::min(1.6 * length, longest_length * (1 + u.head(dimensions_).norm()));
  }
  return false;
}

std::vector<Arrivals::Arrival> Arrivals::along(const Arrival& seed, double fastest, double longest) {
  std::vector<Arrival> found;
  const Vector u = unknowns(seed);
  if (!trace(u, 1, fastest, longest, found)) trace(u, -1, fastest, longest, found);
  return found;
}

/// A chord of length h is off the curve by h/8 times the angle by which it turns.
bool Arrivals::followed(const Arrival& arrival) const {
  const Vector u = unknowns(arrival);
  for (const std::vector<Point>& curve : curves_)
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
      const Vector along = curve[k + 1].u - curve[k].u;
      const double length = along.norm();
      if (!(length > 0)) continue;
      const double part = std::clamp((u - curve[k].u).dot(along) / (length * length), 0.0, 1.0);
      const double turn = (curve[k + 1].tangent - curve[k].tangent).norm();
      if ((u - curve[k].u - part * along).norm() < length * (turn / 4 + near_curve)) return true;
    }
  return false;
}

/// Where the motion passes q1, and whether it lasts: in one dimension the side is 0.
void Arrivals::pass(Flight& flight, double until) {
  Vector y = state(flight.w);
  DormandPrince<double> method([this](double t, std::span<const double> x,
                                      std::span<double> slope) { return flow_.slope(t, x, slope); },
                               2 * n_);
  IntegrationOptions options;
  options.tolerance = coarse_step;
  options.block = n_;
  std::vector<Passage>& found = flight.passages;
  struct Sample {
    double time, distance;  // from q1
    Vector seen;            // from there, in the tangents
  };
  std::vector<Sample> samples;
  const auto add = [&](double t, const Vector& q) {
    samples.push_back({t, (root_ * (q - end_)).norm(), onto_ * (q - end_)});
    const std::size_t k = samples.size() - 1;
    if (k < 2) return;
    const Sample &before = samples[k - 2], &middle = samples[k - 1], &after = samples[k];
    if (dimensions_ == 1) {
      const double a = middle.seen[0], b = after.seen[0];
      const bool near = std::min(middle.distance, after.distance) <= seen_near * std::abs(b - a);
      if (near && (a < 0) != (b < 0))
        found.push_back({middle.time + (after.time - middle.time) * a / (a - b), 0});
      return;
    }
    if (!(middle.distance < before.distance && middle.distance <= after.distance)) return;
    const Vector along = (after.seen - before.seen).normalized();
    const double back = middle.seen.dot(along);
    const double speed = (after.seen - before.seen).norm() / (after.time - before.time);
    found.push_back({middle.time - back / speed, along[0] * middle.seen[1] - along[1] * middle.seen[0]});
  };
  add(0, start_);
  double t = 0;
  Vector between(n_);
  while (t < until) {
    const double from = t;
    if (method.steps() >= most_integrator_steps ||
        method.accept_step(t, span_of(y), until, options) != Integrated::done ||
        !method.prepare_interpolation(span_of(y), 2 * n_))
      break;
    for (int k = 1; k <= samples_a_step; ++k) {
      const double part = static_cast<double>(k) / samples_a_step;
      method.interpolate(part, span_of(between));
      add(from + part * (t - from), between);
    }
  }
  counted_(cost_ * (method.steps() + method.rejected()));
  flight.lasts = t >= until;
}

Arrivals::Flight Arrivals::flight(Vector w, double until, const Scale& scale) {
  if (scale && !scale(w)) return {};
  Flight there{std::move(w), {}};
  pass(there, until);
  return there;
}

/// Adds the arrival near a motion that has this length of w.
void Arrivals::land(const Vector& w, double time, std::vector<Arrival>& found) {
  if (!(time > 0)) return;
  Vector u = unknowns({w, time}), normal = Vector::Zero(dimensions_ + 1);
  normal.head(dimensions_) = along_.transpose() * w.normalized();
  Eigen::MatrixXd slope;
  int steps = 0;
  if (meet(u, normal, {step_error_along, last_step_along}, slope, steps)) found.push_back(arrival(u));
}

/// Arrivals between two neighbours that pass q1 on different sides. Where these are not near to it or to each
/// other, a motion between tells more.
void Arrivals::compare(const Flight& one, const Flight& other, double until, const Scale& scale, int halvings,
                       std::vector<Arrival>& found) {
  const auto nearest = [](const std::vector<Passage>& all, double time) -> const Passage* {
    const Passage* best = nullptr;
    for (const Passage& p : all)
      if (!best || std::abs(p.time - time) < std::abs(best->time - time)) best = &p;
    return best;
  };
  bool resolved = true;
  std::vector<std::pair<const Passage*, const Passage*>> pairs;
  for (const Passage& a : one.passages) {
    const Passage* const b = nearest(other.passages, a.time);
    const bool mutual = b && nearest(one.passages, b->time) == &a;
    if (!mutual)
      resolved &= std::abs(a.side) > far_passage * extent_;
    else if ((a.side < 0) != (b->side < 0))
      pairs.emplace_back(&a, b);
  }
  for (const Passage& b : other.passages) {
    const Passage* const a = nearest(one.passages, b.time);
    if (!a || nearest(other.passages, a->time) != &b) resolved &= std::abs(b.side) > far_passage * extent_;
  }
  for (const auto& [a, b] : pairs) resolved &= std::abs(a->side - b->side) < near_passage * extent_;
  if (!resolved && halvings < most_halvings && counted_(0)) {
    const double length = (one.w.norm() + other.w.norm()) / 2;
    const Flight middle = flight(length * (one.w + other.w).normalized(), until, scale);
    if (middle.w.size() == 0) return;
    compare(one, middle, until, scale, halvings + 1, found);
    compare(middle, other, until, scale, halvings + 1, found);
    return;
  }
  for (const auto& [a, b] : pairs) {
    // So near to each other neighbours pass far apart where they part at a collision.
    if (std::abs(a->side - b->side) >= near_passage * extent_) continue;
    const double part = a->side / (a->side - b->side);
    const double length = (1 - part) * one.w.norm() + part * other.w.norm();
    land(length * (one.w + part * (other.w - one.w)).normalized(), a->time + part * (b->time - a->time),
         found);
  }
}

std::vector<Arrivals::Arrival> Arrivals::sweep(double speed, double until, const Scale& scale) {
  std::vector<Arrival> found;
  if (dimensions_ == 1) {
    for (double side : {1.0, -1.0}) {
      const Flight there = flight(side * speed * along_, until, scale);
      for (const Passage& passage : there.passages) land(there.w, passage.time, found);
    }
    return found;
  }
  std::vector<Flight> flights;
  for (int k = 0; k < sectors && counted_(0); ++k) {
    const double angle = 2 * std::numbers::pi * k / sectors;
    flights.push_back(
        flight(speed * along_ * Eigen::Vector2d(std::cos(angle), std::sin(angle)), until, scale));
  }
  for (std::size_t k = 0; k < flights.size() && counted_(0); ++k) {
    const Flight& next = flights[(k + 1) % flights.size()];
    all_last_ = all_last_ && (flights[k].lasts || next.lasts);
    if (flights[k].w.size() > 0 && next.w.size() > 0) compare(flights[k], next, until, scale, 0, found);
  }
  return found;
}

}  // namespace extremal
