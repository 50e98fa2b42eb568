#include "solve/homotopy/homotopy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/homotopy/limits.hpp"
#include "solve/mesh/resolution.hpp"

namespace extremal {

using namespace limits::homotopy;

namespace {

/// Corrections that shrink: each is shorter than `longest`, and than a part of the one before.
struct ShrinkingSteps {
  ExtremalCurve& curve;
  int most_steps;
  double longest, enough, before = INFINITY;

  static Factors factors(int) { return Factors::anew; }
  Progress take(bool solved, int) {
    if (!solved) return Progress::failed;
    const double size = std::sqrt(curve.dot(curve.correction, curve.correction));
    if (!(size < contraction * before && size < longest) || !curve.apply(curve.correction, 1))
      return Progress::failed;
    before = size;
    return size < enough ? Progress::arrived : Progress::more;
  }
  static Progress exhausted() { return Progress::failed; }
};

/// Steps of bounded length from a path that need not be near: the bound doubles where corrections shrink, and
/// is halved where they grow.
struct BoundedSteps {
  ExtremalCurve& curve;
  int most_steps;
  double longest, enough, bound = longest, before = INFINITY;

  static Factors factors(int) { return Factors::anew; }
  Progress take(bool solved, int) {
    if (!solved) return Progress::failed;
    const double size = std::sqrt(curve.dot(curve.correction, curve.correction));
    bound = size < before ? std::min(2 * bound, longest) : 0.5 * bound;
    before = size;
    if (!curve.apply(curve.correction, std::min(1.0, bound / size))) return Progress::failed;
    return size < enough ? Progress::arrived : Progress::more;
  }
  static Progress exhausted() { return Progress::failed; }
};

}  // namespace

Homotopy::Homotopy(Path& path, Workspace& workspace, std::function<bool()> count, double unit)
    : path_(path), w_(workspace), count_(std::move(count)), unit_(unit) {}

bool Homotopy::linearise(Factors) {
  if (++steps_ > most_steps_) return false;
  if (!count_()) {
    steps_ = most_steps_;
    return false;
  }
  if (!solve_linearised(correction, direction)) return false;
  for (Move* move : {&correction, &direction}) {
    move->times.clear();
    if (!std::isfinite(dot(*move, *move))) return false;
    comoving_.take_along(path_, scale_, move->step, move->times);
  }
  const double length = dot(direction, direction);
  return std::isfinite(dot(correction, correction)) && std::isfinite(length) && length > 0;
}

double Homotopy::dot(const Move& a, const Move& b) const {
  double sum = 0;
  for (std::size_t k = 0; k < a.step.nodes.size(); ++k) sum += a.step.nodes[k] * b.step.nodes[k];
  const double duration = path_.duration();
  return sum / (scale_ * scale_ * static_cast<double>(a.step.nodes.size())) +
         a.step.duration * b.step.duration / (duration * duration) +
         a.parameter * b.parameter / (unit_ * unit_) + strain_product(path_, a.times, b.times);
}

bool Homotopy::apply(const Move& move, double factor) {
  const double duration = path_.duration() + factor * move.step.duration;
  if (!(duration > 0) || !path_.move_mesh(move.times, factor, least_element) ||
      !set_parameter(parameter() + factor * move.parameter))
    return false;
  path_.add(move.step.nodes, move.step.inner, factor);
  if (move.step.duration != 0) path_.set_duration(duration);
  path_.load_ends();
  return true;
}

void Homotopy::restore() {
  path_ = saved_;
  set_parameter(saved_parameter_);
}

bool Homotopy::begin(const ElementTables& tables, int most_steps) {
  most_steps_ = most_steps;
  tables_ = &tables;
  steps_ = 0;
  length_ = first_length;
  farthest_ = std::max(farthest * unit_, 2 * std::abs(parameter()));
  refusals_ = 0;
  last_length_ = 0;
  tangent_ = {};
  w_.iteration.reset(problem(), tables, path_.elements());
  first_scale_ = scale_ = scales(path_, tables).q;
  return scale_ > 0;
}

bool Homotopy::approach() {
  BoundedSteps policy{*this, most_approaches, largest_approach, close_to_curve};
  return newton_loop(BorderedSteps{*this, {}}, policy) == Progress::arrived;
}

bool Homotopy::find_tangent() {
  if (!linearise() || !update_tangent()) return false;
  std::swap(tangent_, next_);
  return true;
}

/// Newton's method across the tangent.
bool Homotopy::correct() {
  ShrinkingSteps policy{*this, most_corrections, std::max(longest_correction * length_, on_curve),
                        std::min(on_curve, corrected * length_)};
  return newton_loop(BorderedSteps{*this, {.tangent = &tangent_}}, policy) == Progress::arrived;
}

/// The next tangent, onward.
bool Homotopy::update_tangent() {
  const bool first = tangent_.step.nodes.empty();
  const TangentScale tangent =
      tangent_scale(*this, first ? nullptr : &tangent_, first ? onward(direction) : 0);
  next_ = direction;
  next_.scale(tangent.scale);
  cosine_ = tangent.cosine;
  return cosine_ > sharpest_turn;
}

/// Goes to where the parameter is zero, which the last step has passed, if that is near; else the next step
/// becomes shorter.
bool Homotopy::land(double from) {
  constexpr double wanted = 0;
  const double passed = parameter();
  ShrinkingSteps policy{*this, most_landings, farthest_landing, landed};
  if (newton_loop(BorderedSteps{*this, {.value = &wanted}}, policy) == Progress::arrived)
    return set_parameter(wanted);
  length_ *= std::clamp(from / (from - passed), 0.1, 0.9);
  return false;
}

/// Other elements where those there are do not resolve the path. False if it takes too many.
bool Homotopy::resolve() {
  const int degree = path_.degree();
  w_.resolution.measure(path_, *tables_);
  if (w_.resolution.at(degree).q <= unresolved * scale_) return true;
  const Resolution::Error aim{resolved * scale_, INFINITY, INFINITY};
  const Plan finer = w_.planner.plan(w_.resolution, path_.mesh(), *tables_,
                                     {aim, aim, degree, degree, degree, most_elements, strongest_cut});
  if (finer.mesh.empty()) return finer.degree != 0;
  std::vector<double> nodes =
      interpolated(tangent_.step.nodes, path_.coordinates(), path_.mesh(), finer.mesh);
  w_.other.resample_from(path_, *tables_, finer.mesh);
  std::swap(path_, w_.other);
  w_.iteration.reset(problem(), *tables_, path_.elements());
  tangent_.step.nodes = std::move(nodes);
  tangent_.times.clear();
  last_length_ = 0;
  if (!linearise()) return false;
  update_tangent();
  std::swap(tangent_, next_);
  return true;
}

/// Nearer to the family, where its tangent is known better.
void Homotopy::polish() {
  last_length_ = 0;
  if (!approach() || !linearise()) return restore();
  update_tangent();
  std::swap(tangent_, next_);
}

/// The parabola through the tangents here and before.
Move Homotopy::predicted() const {
  Move move = tangent_;
  if (last_length_ == 0) return move;
  const double half = 0.5 * length_ / last_length_;
  move.add(tangent_, half);
  move.add(previous_, -half);
  return move;
}

bool Homotopy::reach() {
  while (length_ > least_length && steps_ < most_steps_) {
    saved_ = path_;
    saved_parameter_ = parameter();
    const int began = steps_;
    if (!apply(predicted(), length_) || !correct() || !update_tangent()) {
      restore();
      length_ *= 0.4;
      if (++refusals_ == refusals_before_polish) polish();
      continue;
    }
    const bool passed = saved_parameter_ != 0 && saved_parameter_ * parameter() <= 0;
    if (passed) {
      beyond_ = path_;
      beyond_parameter_ = parameter();
      if (!land(saved_parameter_)) {
        restore();
        continue;
      }
    }
    previous_ = std::exchange(tangent_, next_);
    last_length_ = length_;
    if (passed) return true;
    scale_ = scales(path_, *tables_).q;
    const bool away = std::abs(parameter()) > farthest_;
    if (away || scale_ > runaway * first_scale_ || !resolve()) return false;
    const double growth = cosine_ > 0.98 ? 2 : cosine_ > 0.93 ? 1.4 : 1;
    if (refusals_ == 0) length_ *= growth * (steps_ - began > 2 ? 0.7 : 1);
    refusals_ = 0;
  }
  return false;
}

void Homotopy::resume() {
  steps_ = 0;
  path_ = beyond_;
  w_.iteration.reset(problem(), *tables_, path_.elements());
  set_parameter(beyond_parameter_);
}

}  // namespace extremal
