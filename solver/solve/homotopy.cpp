#include "solve/homotopy.hpp"

#include <algorithm>
#include <cmath>

#include "solve/resolution.hpp"

namespace extremal {

namespace {

/// Durations that are looked at: so many octaves either side, in quarters.
constexpr int octaves = 6;
/// Forces that bend a path by less than this, relative to its range, leave it nearly as it is.
constexpr double slight = 0.2;
/// A duration is natural if the path is not further from a motion than this times the least distance.
constexpr double nearly_least = 1.3;
constexpr std::size_t most_durations = 4;
/// As T → 0: this much of the wanted duration.
constexpr double instant = 1e-4;

/// Lengths are relative: root mean square over the nodes by the path's range, and T by the wanted one.
constexpr double first_length = 0.1, least_length = 1e-5, largest_approach = 0.2;
constexpr double on_family = 1e-2, close_to_family = 1e-3, landed = 0.02;
/// A step is refused where corrections shrink less than this, are longer than this part of it, or where the
/// family turns by more than the angle with this cosine.
constexpr double contraction = 0.5, longest_correction = 0.5, sharpest_turn = 0.9;
constexpr int most_corrections = 4, most_approaches = 25, most_steps = 200;
/// The family has run away where the path is so much larger than at first.
constexpr double runaway = 1e3;

void add(Step& to, const Step& from, double factor) {
  for (std::size_t k = 0; k < to.nodes.size(); ++k) to.nodes[k] += factor * from.nodes[k];
  for (std::size_t k = 0; k < to.inner.size(); ++k) to.inner[k] += factor * from.inner[k];
  to.duration += factor * from.duration;
}

void scale(Step& step, double factor) {
  for (double& x : step.nodes) x *= factor;
  for (double& x : step.inner) x *= factor;
  step.duration *= factor;
}

double largest(const std::vector<double>& values) {
  double result = 0;
  for (double x : values) result = std::max(result, std::abs(x));
  return result;
}

}  // namespace

std::vector<double> natural_durations(const Problem& problem, Workspace& w, const ElementTables& tables) {
  const double wanted = problem.duration.value, short_one = instant * wanted;
  QuadraticModel& model = w.iteration.model();
  DiscreteAction& action = w.iteration.action();
  w.path.set_duration(short_one);
  if (!model.evaluate(action, w.path, nullptr) || !action.finite()) return {};
  const double range = scales(w.path, tables).q;
  struct Candidate {
    double distance, duration, ratio;
  };
  std::vector<Candidate> candidates;
  double least = INFINITY;
  for (int k = -4 * octaves; k <= 4 * octaves; ++k) {
    const double duration = wanted * std::pow(2.0, 0.25 * k);
    w.path.set_duration(duration);
    model.evaluate_gradient(action, w.path);
    Step step;
    model.solve(action, nullptr, step);
    const double distance = largest(step.nodes) * duration / (short_one * range);
    if (!action.finite() || !std::isfinite(distance)) continue;
    candidates.push_back({std::max(distance, slight), duration, std::abs(std::log(duration / wanted))});
    least = std::min(least, candidates.back().distance);
  }
  std::erase_if(candidates, [&](const Candidate& c) { return c.distance > nearly_least * least; });
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.ratio < b.ratio;
  });
  std::vector<double> durations;
  for (const Candidate& c : candidates)
    if (durations.size() < most_durations) durations.push_back(c.duration);
  return durations;
}

DurationHomotopy::DurationHomotopy(const Problem& problem, Workspace& workspace, std::function<bool()> count)
    : problem_(problem), w_(workspace), count_(std::move(count)), wanted_(problem.duration.value) {
  problem_.duration = {.value = wanted_, .free = true, .energy = 0, .where = {}};
}

/// With H and t the second derivatives of S_h in x and in x and T, H δx + t δT = −g leaves one direction
/// free. Two right-hand sides of the equation that would close it give two solutions, even where H is
/// singular.
bool DurationHomotopy::linearise() {
  if (++steps_ > most_steps) return false;
  if (!count_()) {
    steps_ = most_steps;
    return false;
  }
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  ClosingEquation closing;
  if (!model.evaluate(action, w_.path, &closing) || !action.finite()) return false;
  const double energy = std::abs(action.slope_duration()) + std::abs(action.action()) / w_.path.duration();
  closing.value = -action.slope_duration();
  model.solve(action, &closing, correction_);
  closing.value += energy > 0 ? energy : 1;
  model.solve(action, &closing, direction_);
  add(direction_, correction_, -1);
  const double length = dot(direction_, direction_);
  return std::isfinite(dot(correction_, correction_)) && std::isfinite(length) && length > 0;
}

double DurationHomotopy::dot(const Step& a, const Step& b) const {
  double sum = 0;
  for (std::size_t k = 0; k < a.nodes.size(); ++k) sum += a.nodes[k] * b.nodes[k];
  return sum / (scale_ * scale_ * static_cast<double>(a.nodes.size())) +
         a.duration * b.duration / (wanted_ * wanted_);
}

bool DurationHomotopy::apply(const Step& step, double factor) {
  const double duration = w_.path.duration() + factor * step.duration;
  if (!(duration > 0)) return false;
  w_.path.add(step.nodes, step.inner, factor);
  w_.path.set_duration(duration);
  w_.path.load_ends();
  return true;
}

void DurationHomotopy::restore() {
  w_.path.copy_values(saved_);
  w_.path.load_ends();
}

/// The shortest correction each time (Gauss-Newton): regular also where the problem with T fixed is singular.
bool DurationHomotopy::approach() {
  double longest = largest_approach, before = INFINITY;
  for (int k = 0; k < most_approaches && linearise(); ++k) {
    add(correction_, direction_, -dot(direction_, correction_) / dot(direction_, direction_));
    const double size = std::sqrt(dot(correction_, correction_));
    longest = size < before ? std::min(2 * longest, largest_approach) : 0.5 * longest;
    before = size;
    if (!apply(correction_, std::min(1.0, longest / size))) return false;
    if (size < close_to_family) return true;
  }
  return false;
}

/// Newton's method across the tangent.
bool DurationHomotopy::correct(double length) {
  double before = INFINITY;
  for (int k = 0; k < most_corrections && linearise(); ++k) {
    const double along = dot(tangent_, direction_);
    if (along == 0) return false;
    add(correction_, direction_, -dot(tangent_, correction_) / along);
    const double size = std::sqrt(dot(correction_, correction_));
    const bool short_enough =
        size < contraction * before && size < std::max(longest_correction * length, on_family);
    if (!short_enough || !apply(correction_, 1)) return false;
    if (size < on_family) return true;
    before = size;
  }
  return false;
}

/// The next tangent, onward; at first towards the wanted duration.
bool DurationHomotopy::turn() {
  const bool first = tangent_.nodes.empty();
  const double length = std::sqrt(dot(direction_, direction_));
  const double along =
      first ? direction_.duration * (wanted_ - w_.path.duration()) : dot(tangent_, direction_);
  next_ = direction_;
  scale(next_, std::copysign(1 / length, along));
  cosine_ = first ? 1 : std::abs(along) / (length * std::sqrt(dot(tangent_, tangent_)));
  return cosine_ > sharpest_turn;
}

/// Goes to the wanted duration, which the last step has passed, if that is near; else `length` becomes that
/// of a shorter step.
bool DurationHomotopy::land(double from, double& length) {
  const double passed = w_.path.duration();
  if (linearise()) {
    add(correction_, direction_, (wanted_ - passed - correction_.duration) / direction_.duration);
    if (std::sqrt(dot(correction_, correction_)) <= landed && apply(correction_, 1)) {
      w_.path.set_duration(wanted_);
      return true;
    }
  }
  length *= std::clamp((wanted_ - from) / (passed - from), 0.1, 0.9);
  return false;
}

bool DurationHomotopy::follow(const ElementTables& tables) {
  steps_ = 0;
  tangent_ = {};
  w_.iteration.reset(problem_, tables, w_.path.elements());
  scale_ = scales(w_.path, tables).q;
  const double first_scale = scale_;
  if (!(scale_ > 0) || !approach() || !linearise() || !turn()) return false;
  std::swap(tangent_, next_);
  bool refused = false;
  for (double length = first_length; length > least_length && steps_ < most_steps;) {
    saved_ = w_.path;
    const int began = steps_;
    if (!apply(tangent_, length) || !correct(length) || !turn()) {
      restore();
      length *= 0.4;
      refused = true;
      continue;
    }
    const double from = saved_.duration();
    if ((from - wanted_) * (w_.path.duration() - wanted_) <= 0) {
      if (land(from, length)) return true;
      restore();
      continue;
    }
    std::swap(tangent_, next_);
    scale_ = scales(w_.path, tables).q;
    if (scale_ > runaway * first_scale) return false;
    const double growth = cosine_ > 0.98 ? 2 : cosine_ > 0.93 ? 1.4 : 1;
    if (!refused) length *= growth * (steps_ - began > 2 ? 0.7 : 1);
    refused = false;
  }
  return false;
}

}  // namespace extremal
