#include "solve/search/arrivals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "linear/dense.hpp"
#include "motion/dop853.hpp"
#include "solve/curve/arclength.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::arrivals;
using namespace limits::scanned_motions;

using Vector = Arrivals::Vector;

/// The curve of arrivals, at one of them; see solve/curve/arclength.hpp.
struct Arrivals::Curve {
  Arrivals& of;
  Vector u;                                                           ///< unknowns
  double step_error = step_error_along, last_step = last_step_along;  ///< the integrator's, Newton's
  Vector correction = {}, direction = {}, saved = {};
  bool seen = false;           ///< where q1 is: not another point of a manifold
  int tries = 0, flights = 0;  ///< steps begun, and motions of the last one

  bool linearise(Factors);
  bool apply(const Vector& move, double factor) { return (u += factor * move).allFinite(); }
  static double dot(const Vector& a, const Vector& b) { return a.dot(b); }
  bool goes_on() const { return tries < most_points && of.counted_(0); }
  void save() {
    saved = u;
    ++tries;
    flights = 0;
  }
  void refuse() { u = saved; }
  bool correct(const Vector& normal, double length = 0);
};

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

/// By the motion with its variations by w: the shortest correction, and the direction in which the slope does
/// nothing. What is missed is relative to the extent.
bool Arrivals::Curve::linearise(Factors) {
  ++flights;
  const int n = of.n_, dimensions = of.dimensions_;
  const auto& [start, time] = of.arrival(u);
  Vector y = Vector::Zero(2 * n * (1 + dimensions)), v(n);
  y.head(2 * n) = of.state(start);
  for (int k = 0; k < dimensions; ++k)
    y.segment(2 * n * (k + 1) + n, n) = of.speed_ * of.root_ * of.along_.col(k);
  if (!y.allFinite()) return false;
  DormandPrince<double> method(
      [this](double t, std::span<const double> x, std::span<double> slope) {
        return of.flow_.slope_with_variations(t, x, slope);
      },
      static_cast<int>(y.size()));
  IntegrationOptions options;
  options.tolerance = step_error;
  options.block = n;
  options.controlled = 2 * n;
  options.max_steps = most_integrator_steps;
  double t = 0;
  const Integrated result = method.advance(t, span_of(y), time, options);
  const int work = variations_cost * of.cost_ * (method.steps() + method.rejected());
  if (!of.counted_(work) || result != Integrated::done) return false;
  if (!of.flow_.velocity(span_of(y).first(n), span_of(y).subspan(n, n), t, span_of(v))) return false;
  const Vector miss = of.onto_ * (y.head(n) - of.end_) / of.extent_;
  Eigen::MatrixXd slope(dimensions, dimensions + 1);
  for (int k = 0; k < dimensions; ++k) slope.col(k) = of.onto_ * y.segment(2 * n * (k + 1), n) / of.extent_;
  slope.col(dimensions) = of.onto_ * v * (time / of.extent_);
  if (!miss.allFinite() || !slope.allFinite()) return false;
  const double missed = miss.norm(), away = (of.root_ * (y.head(n) - of.end_)).norm() / of.extent_;
  // Another point of a manifold may be seen where q1 is.
  seen = away <= seen_beside + seen_near * missed;
  const SingularValues parts = singular_value_decomposition(slope);
  direction = parts.v.col(dimensions);
  correction = Vector::Zero(dimensions + 1);
  if (missed > last_step * last_step)
    correction -= parts.v.leftCols(dimensions) * (parts.u.transpose() * miss).cwiseQuotient(parts.values);
  return true;
}

/// Newton's method across the normal; a step as short as the last leaves about its square.
bool Arrivals::Curve::correct(const Vector& normal, double) {
  const double longest = longest_correction * (1 + u.head(of.dimensions_).norm());
  return contract(*this, across(*this, normal), {most_newton_steps, contraction, longest, last_step}) && seen;
}

/// Arrivals at the time between two points of a curve, where its cubic interpolation crosses it.
void Arrivals::cross(const Point& a, const Point& b, std::vector<Arrival>& found) {
  const double length = (b.u - a.u).norm();
  const auto between = [&](double x) -> Vector {
    const double y = 1 - x;
    return y * y * (1 + 2 * x) * a.u + x * x * (1 + 2 * y) * b.u +
           length * x * y * (y * a.tangent - x * b.tangent);
  };
  Vector last = a.u;
  for (int k = 1; k <= crossing_samples; ++k) {
    const Vector next = between(static_cast<double>(k) / crossing_samples);
    if ((last[dimensions_] < 0) != (next[dimensions_] < 0)) {
      Curve there{*this,
                  last + (next - last) * (last[dimensions_] / (last[dimensions_] - next[dimensions_]))};
      there.u[dimensions_] = 0;
      const Vector normal = Vector::Unit(dimensions_ + 1, dimensions_);
      const bool near = there.correct(normal);
      there.step_error = step_error_arriving;
      there.last_step = last_step_arriving;
      if (near && there.correct(normal)) found.push_back(arrival(there.u));
    }
    last = next;
  }
}

/// One way along a curve; whether it closes.
bool Arrivals::trace(const Vector& seed, double sense, double fastest, double longest,
                     std::vector<Arrival>& found) {
  Curve curve{*this, seed};
  if (!curve.linearise(Factors::anew)) return false;
  ArclengthSteps<Vector> steps{{least_length, shortening, sharpest_turn}, first_length};
  steps.begin(curve, nullptr, sense);
  std::vector<Point>& points = curves_.emplace_back();
  points.push_back({seed, steps.tangent});
  while (steps.advance(curve)) {
    const Point next{curve.u, steps.next};
    cross(points.back(), next, found);
    const bool closed = points.size() > 3 && (next.u - seed).norm() < steps.length;
    steps.accept((next.u - points.back().u).norm());
    points.push_back(next);
    if (closed) return true;
    const double speed = next.u.head(dimensions_).norm();
    const bool later = next.tangent[dimensions_] > 0;
    if (speed * speed_ > fastest || (later && next.u[dimensions_] > std::log(longest / time_))) return false;
    if (curve.flights <= few_flights && steps.cosine > mild_turn)
      steps.length = std::min(lengthening * steps.length, longest_length * (1 + speed));
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
  Curve there{*this, unknowns({w, time})};
  Vector normal = Vector::Zero(dimensions_ + 1);
  normal.head(dimensions_) = along_.transpose() * w.normalized();
  if (there.correct(normal)) found.push_back(arrival(there.u));
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
