#include "solve/contact/coarse_minimum.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "problem/extension.hpp"
#include "solve/contact/coarse_minima.hpp"
#include "solve/contact/end_equations.hpp"
#include "solve/contact/found_values.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A zero of the closing condition of coarse minima, as a function of the duration.
class DurationSearch {
 public:
  /// Keeps a reference to the minima, of which the last is one already.
  explicit DurationSearch(CoarseMinima& minima) : minima_(minima) {}

  bool run() {
    const Point first = point();
    note(first);
    std::optional<Point> now = at(first.duration * first_ratio);
    if (!now) now = at(first.duration / first_ratio);
    if (now) note(*now);
    if (close(first, now)) return true;
    if (other_side_) return false;
    const std::optional<Point> beyond = least();
    return beyond && close(nearest_, beyond);
  }

  /// Why it was not found, where that is known.
  std::string reason() const {
    if (!std::isfinite(nearest_.value) || other_side_) return {};
    if (closed_by_condition(problem()))
      return fmt::format(
          "minimisers do not satisfy 'where': they come nearest to it, by {:.3g}, at a duration of {:.6g}",
          nearest_.value, nearest_.duration);
    return fmt::format(
        "no minimiser near the guess has this energy: the nearest is about {:.4g}, at a duration of {:.4g}",
        nearest_.value + *problem().duration.energy, nearest_.duration);
  }

 private:
  struct Point {
    double duration, value;
  };
  const Problem& problem() const { return minima_.last().problem; }
  Point point() const { return {problem().duration.value, minima_.last().closing}; }
  /// The minimum there becomes the last one.
  std::optional<Point> at(double duration) {
    if (!minima_.find(duration, {})) return std::nullopt;
    return point();
  }
  void note(const Point& found) {
    known_[found.duration] = found.value;
    if (std::abs(found.value) < std::abs(nearest_.value)) nearest_ = found;
  }

  /// From two durations.
  bool close(std::optional<Point> old, std::optional<Point> now) {
    int vain = 0;
    for (int k = 0; k < most_durations && now && vain < most_vain_durations && !minima_.deadline().passed();
         ++k) {
      if (std::abs(now->duration - old->duration) <= near_duration * now->duration || now->value == 0)
        return true;
      if ((now->value < 0) != (old->value < 0)) other_side_ = old;
      double next = secant(*old, *now);
      std::optional<Point> found = at(next);
      for (int halved = 0; !found && halved < most_halvings; ++halved) {
        next = (next + now->duration) / 2;
        found = at(next);
      }
      old = now;
      now = found;
      const double before = std::abs(nearest_.value);
      if (now) note(*now);
      vain = other_side_ || std::abs(nearest_.value) < useful_share * before ? 0 : vain + 1;
    }
    return false;
  }

  /// The least value, of one sign so far, between durations that are known: by parabolas through it and its
  /// neighbours. A duration beyond zero if there is one.
  std::optional<Point> least() {
    for (int k = 0; k < most_durations && !minima_.deadline().passed(); ++k) {
      const auto middle = known_.find(nearest_.duration), after = std::next(middle);
      if (middle == known_.begin() || after == known_.end()) break;
      const auto before = std::prev(middle);
      const double back = middle->first - before->first, onward = after->first - middle->first;
      const double fall = (middle->second - before->second) / back,
                   rise = (after->second - middle->second) / onward;
      const double next = 0.5 * (before->first + middle->first - fall * (back + onward) / (rise - fall));
      if (!(next > before->first && next < after->first)) break;
      if (std::abs(next - middle->first) <= near_duration * middle->first) break;
      const std::optional<Point> found = at(next);
      if (!found) break;
      if ((found->value < 0) != (nearest_.value < 0)) return found;
      note(*found);
    }
    return std::nullopt;
  }

  /// Between values of different signs the zero stays enclosed.
  double secant(const Point& old, const Point& now) const {
    double next = now.duration - now.value * (now.duration - old.duration) / (now.value - old.value);
    if (!std::isfinite(next)) next = now.duration * first_ratio;
    if (other_side_ && (now.value < 0) != (other_side_->value < 0)) {
      const auto [low, high] = std::minmax(now.duration, other_side_->duration);
      return next > low && next < high ? next : (low + high) / 2;
    }
    return std::clamp(next, now.duration / most_ratio, now.duration * most_ratio);
  }

  CoarseMinima& minima_;
  std::optional<Point> other_side_;
  Point nearest_{0, INFINITY};      ///< the least value so far
  std::map<double, double> known_;  ///< values by durations
};

/// Unknown constants, and a free duration with them, for which the conditions hold at coarse minima: Newton's
/// method with differences as derivatives, and Broyden's updates.
class ConstantSearch {
 public:
  /// Keeps a reference to the minima, of which the last is one already.
  explicit ConstantSearch(CoarseMinima& minima)
      : minima_(minima),
        free_(minima.last().problem.duration.free),
        units_(values(minima.last()).cwiseAbs()),
        first_(all_missed_by(minima.last()).cwiseAbs()) {
    for (VectorXd* units : {&units_, &first_})
      for (double& unit : *units)
        if (unit == 0) unit = 1;
  }

  bool run() {
    bool exact = false;
    int vain = 0;
    double nearest = missed_by(minima_.last()).norm();
    for (int k = 0; k < most_durations && vain < most_vain_durations && !minima_.deadline().passed(); ++k) {
      if (slopes_.size() == 0) {
        if (!differentiate()) return false;
        exact = true;
      }
      const Eigen::ColPivHouseholderQR<MatrixXd> factors(slopes_);
      if (!slopes_.allFinite() || !factors.isInvertible()) return false;
      const VectorXd missed = missed_by(minima_.last()), step = -factors.solve(missed);
      if (step.lpNorm<Eigen::Infinity>() <= near_duration) return true;
      double factor = 1 / std::max(1.0, step.lpNorm<Eigen::Infinity>() * most_ratio);
      std::optional<CoarseMinima::Minimum> found;
      for (int halved = 0; !found && halved < most_halvings; ++halved) {
        found = at(factor * step);
        // The next step, by the same derivatives, is shorter.
        if (found && !(factors.solve(missed_by(*found)).norm() < step.norm())) found.reset();
        if (!found) factor /= 2;
      }
      if (!found && exact) return false;
      if (!found) {
        slopes_.resize(0, 0);
        continue;
      }
      const VectorXd taken = factor * step, change = missed_by(*found) - missed;
      slopes_ += (change - slopes_ * taken) * taken.transpose() / taken.squaredNorm();
      exact = false;
      minima_.take(*std::move(found));
      const double now = missed_by(minima_.last()).norm();
      vain = now < useful_share * nearest ? 0 : vain + 1;
      nearest = std::min(nearest, now);
    }
    return false;
  }

 private:
  VectorXd values(const CoarseMinima::Minimum& minimum) const {
    std::vector<double> all = unknowns_of(minimum.problem);
    if (free_) all.push_back(minimum.problem.duration.value);
    return Eigen::Map<const VectorXd>(all.data(), static_cast<Index>(all.size()));
  }
  /// In parts of what the first minimum missed.
  VectorXd missed_by(const CoarseMinima::Minimum& minimum) const {
    return all_missed_by(minimum).cwiseQuotient(first_);
  }
  VectorXd all_missed_by(const CoarseMinima::Minimum& minimum) const {
    std::vector<double> all = minimum.where;
    if (free_) all.push_back(minimum.closing);
    return Eigen::Map<const VectorXd>(all.data(), static_cast<Index>(all.size()));
  }
  /// A step from the last minimum, in parts of the first values.
  std::optional<CoarseMinima::Minimum> at(const VectorXd& step) {
    const VectorXd next = values(minima_.last()) + units_.cwiseProduct(step);
    const double duration = free_ ? next[next.size() - 1] : minima_.last().problem.duration.value;
    return minima_.at(duration, {next.begin(), next.end() - (free_ ? 1 : 0)});
  }
  bool differentiate() {
    const VectorXd missed = missed_by(minima_.last());
    const Index size = units_.size();
    slopes_.resize(size, size);
    for (Index i = 0; i < size; ++i) {
      double by = first_ratio - 1;
      std::optional<CoarseMinima::Minimum> beside = at(by * VectorXd::Unit(size, i));
      if (!beside) {
        by = -by;
        beside = at(by * VectorXd::Unit(size, i));
      }
      if (!beside) return false;
      slopes_.col(i) = (missed_by(*beside) - missed) / by;
    }
    return true;
  }

  CoarseMinima& minima_;
  bool free_;
  VectorXd units_, first_;
  MatrixXd slopes_;
};

/// A first minimum; of a free duration, shorter paths are minimisers where longer ones are not.
bool find_first(CoarseMinima& minima) {
  const double guess = minima.last().problem.duration.value;
  const bool free = minima.last().problem.duration.free;
  bool found = minima.find(guess, {});
  for (int k = 0; free && !found && k < most_halvings && !minima.deadline().passed(); ++k)
    found = minima.find(guess * std::pow(0.5, k + 1), {});
  return found;
}

}  // namespace

CoarseMinimum coarse_minimum(Problem& problem, const CoarseElements& elements, const std::vector<double>& z,
                             const Deadline& deadline) {
  CoarseMinima minima(problem, elements, z, deadline);
  if (!find_first(minima)) return {minima.failure()};
  CoarseMinimum found;
  bool closed = true;
  if (!unknowns_of(problem).empty()) {
    closed = ConstantSearch(minima).run();
    if (!closed)
      found.reason = "no unknowns were found for which a minimiser near the guess satisfies 'where'";
  } else if (problem.duration.free) {
    DurationSearch search(minima);
    closed = search.run();
    if (!closed) found.reason = search.reason();
  }
  const CoarseMinima::Minimum& last = minima.last();
  found.report = last.report;
  found.report.converged = closed;
  found.z = last.path.z;
  found.times = last.path.times;
  problem = last.problem;
  return found;
}

}  // namespace extremal
