#include "solve/homotopy/homotopy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/homotopy/limits.hpp"
#include "solve/mesh/resolution.hpp"

namespace extremal {

using namespace limits::homotopy;

Homotopy::Homotopy(Path& path, Workspace& workspace, std::function<bool()> count, double unit)
    : path_(path),
      w_(workspace),
      count_(std::move(count)),
      unit_(unit),
      along_{{least_length, shortening, sharpest_turn}} {}

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

void Homotopy::save() {
  saved_ = path_;
  saved_parameter_ = parameter();
  saved_steps_ = steps_;
}

void Homotopy::restore() {
  path_ = saved_;
  set_parameter(saved_parameter_);
}

bool Homotopy::begin(const ElementTables& tables, int most_steps) {
  most_steps_ = most_steps;
  tables_ = &tables;
  steps_ = 0;
  along_.length = first_length;
  farthest_ = std::max(farthest * unit_, 2 * std::abs(parameter()));
  refusals_ = 0;
  w_.iteration.reset(problem(), tables, path_.elements());
  first_scale_ = scale_ = scales(path_, tables).q;
  return scale_ > 0;
}

/// Steps of bounded length: the bound doubles where corrections shrink, and is halved where they grow.
bool Homotopy::approach() {
  double bound = largest_approach, before = INFINITY;
  const auto take = [&](bool solved) {
    if (!solved) return Progress::failed;
    const double size = std::sqrt(dot(correction, correction));
    bound = size < before ? std::min(2 * bound, largest_approach) : 0.5 * bound;
    before = size;
    if (!apply(correction, std::min(1.0, bound / size))) return Progress::failed;
    return size < close_to_curve ? Progress::arrived : Progress::more;
  };
  return newton_loop(across(*this, direction), most_approaches, take) == Progress::arrived;
}

bool Homotopy::find_tangent() {
  if (!linearise(Factors::anew)) return false;
  along_.begin(*this, nullptr, onward(direction));
  return true;
}

bool Homotopy::correct(const Move& tangent, double length) {
  return contract(*this, across(*this, tangent),
                  {most_corrections, contraction, std::max(longest_correction * length, on_curve),
                   std::min(on_curve, corrected * length)});
}

/// Goes to where the parameter is zero, which the last step has passed, if that is near; else the next step
/// becomes shorter.
bool Homotopy::land(double from) {
  constexpr double wanted = 0;
  const double passed = parameter();
  if (contract(*this, to_value(*this, wanted), {most_landings, contraction, farthest_landing, landed}))
    return set_parameter(wanted);
  along_.length *= std::clamp(from / (from - passed), 0.1, 0.9);
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
      interpolated(along_.tangent.step.nodes, path_.coordinates(), path_.mesh(), finer.mesh);
  w_.other.resample_from(path_, *tables_, finer.mesh);
  std::swap(path_, w_.other);
  w_.iteration.reset(problem(), *tables_, path_.elements());
  along_.tangent.step.nodes = std::move(nodes);
  along_.tangent.times.clear();
  if (!linearise(Factors::anew)) return false;
  along_.begin(*this, &along_.tangent);
  return true;
}

/// Nearer to the family, where its tangent is known better.
void Homotopy::polish() {
  along_.way = 0;
  if (!approach() || !linearise(Factors::anew)) return restore();
  along_.begin(*this, &along_.tangent);
}

void Homotopy::refuse() {
  restore();
  if (++refusals_ == refusals_before_polish) polish();
}

bool Homotopy::reach() {
  while (along_.advance(*this)) {
    const bool passed = saved_parameter_ != 0 && saved_parameter_ * parameter() <= 0;
    if (passed) {
      beyond_ = path_;
      beyond_parameter_ = parameter();
      if (!land(saved_parameter_)) {
        restore();
        continue;
      }
    }
    along_.accept(along_.length);
    if (passed) return true;
    scale_ = scales(path_, *tables_).q;
    const bool away = std::abs(parameter()) > farthest_;
    if (away || scale_ > runaway * first_scale_ || !resolve()) return false;
    const double cosine = along_.cosine;
    const double growth = cosine > straight ? growth_if_straight : cosine > bent ? growth_if_bent : 1;
    if (refusals_ == 0) along_.length *= growth * (steps_ - saved_steps_ > few_steps ? slowdown : 1);
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
