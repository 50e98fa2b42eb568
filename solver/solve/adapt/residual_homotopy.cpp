#include "solve/adapt/residual_homotopy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/adapt/limits.hpp"
#include "solve/mesh/resolution.hpp"

namespace extremal {

using namespace limits::residual_homotopy;

ResidualHomotopy::ResidualHomotopy(const Problem& problem, const ElementTables& tables, int elements,
                                   bool free_times, std::function<bool()> on_step)
    : tables_(tables),
      free_times_(free_times),
      on_step_(std::move(on_step)),
      equations_(problem, tables, elements, free_times) {}

/// All solutions of F(x) + F'(x) δx = (μ + δμ) F(x_0) are correction_ + δμ direction_.
bool ResidualHomotopy::linearise(const Path& path, double mu) {
  const SchemeEquations::Vector& left = equations_.evaluate(path);
  if (--left_ < 0 || !on_step_() || !equations_.factor(path)) return false;
  correction_ = equations_.solve(mu * first_ - left);
  direction_ = equations_.solve(first_);
  return correction_.allFinite() && direction_.allFinite();
}

double ResidualHomotopy::product(const Tangent& a, const Tangent& b, const Path& path) const {
  return equations_.product(a.step, b.step, path, extent_) + a.parameter * b.parameter;
}

/// Newton's method for one μ, until steps gain nothing more.
bool ResidualHomotopy::converge(Path& path, double mu) {
  double before = INFINITY;
  Path trial;
  for (int k = 0; k < most_newton_steps && linearise(path, mu); ++k) {
    trial = path;
    const bool moved = equations_.apply(trial, correction_, 1);
    const double after = moved ? equations_.size(equations_.evaluate(trial) - mu * first_, trial) : INFINITY;
    if (before <= enough_ && !(after < before)) return true;
    if (!(after < worst_residual)) return false;
    before = after;
    std::swap(path, trial);
  }
  return before <= enough_;
}

/// Newton's method for values of μ that fall to 0 as fast as it converges.
bool ResidualHomotopy::descend(Path& path, double& mu) {
  left_ = most_linearisations_of_curve();
  Path trial;
  for (double way = 1; way >= least_way && left_ > 0;) {
    trial = path;
    const double next = std::max(0.0, mu - way);
    if (!converge(trial, next)) {
      way /= 2;
      continue;
    }
    std::swap(path, trial);
    mu = next;
    if (mu == 0) return true;
    way *= 2;
  }
  return false;
}

/// Newton's method across the tangent; corrections shrink until they are roundoff.
bool ResidualHomotopy::correct(Path& path, double& mu, const Tangent& tangent, double length) {
  double longest = longest_correction * length, before = INFINITY;
  for (int k = 0; k < most_corrections && linearise(path, mu); ++k) {
    const double along = product(tangent, {direction_, 1}, path),
                 off = product(tangent, {correction_, 0}, path);
    if (along == 0) return false;
    const double by = -off / along;
    const Tangent step{correction_ + by * direction_, by};
    const double size = std::sqrt(product(step, step, path));
    if (!(size < longest) || !equations_.apply(path, step.step, 1)) return false;
    mu += by;
    const bool roundoff = size < nearly * length && size > contraction * before;
    if (size < corrected * length || roundoff) return true;
    before = size;
    longest = std::max(contraction * size, close_to_curve * length);
  }
  return false;
}

/// Of length one, onward from the one before, or to a μ that changes in this sense. False if the curve turns
/// too sharply.
bool ResidualHomotopy::next_tangent(const Path& path, const Tangent* before, double sense,
                                    Tangent& next) const {
  next = {direction_, 1};
  const double length = std::sqrt(product(next, next, path));
  const double along = before ? product(*before, next, path) / length : sense;
  next.step *= std::copysign(1 / length, along);
  next.parameter *= std::copysign(1 / length, along);
  return std::isfinite(length) && std::abs(along) > sharpest_turn;
}

/// Along the parabola through two tangents.
ResidualHomotopy::Tangent ResidualHomotopy::bent(const Tangent& here, const Tangent& before, double by) {
  return {here.step + by * (here.step - before.step),
          here.parameter + by * (here.parameter - before.parameter)};
}

int ResidualHomotopy::most_linearisations_of_curve() const {
  return std::clamp(static_cast<int>(most_work / equations_.unknowns()), least_linearisations,
                    most_linearisations);
}

bool ResidualHomotopy::trace(Path path, double mu, double sense, Path& found) {
  left_ = most_linearisations_of_curve();
  double length = first_length, tried = std::abs(mu);  // where Newton's method alone was tried
  Tangent tangent, next, before{{}, 0};
  double last_length = 0;  // from there; 0 if there is none
  if (!linearise(path, mu) || !next_tangent(path, nullptr, sense, tangent)) return false;
  while (length > least_length && left_ > 0) {
    Path trial = path;
    const Tangent ahead = last_length > 0 ? bent(tangent, before, 0.5 * length / last_length) : tangent;
    double reached = mu + length * ahead.parameter;
    const int began = left_;
    if (!equations_.apply(trial, ahead.step, length) || !correct(trial, reached, tangent, length) ||
        !linearise(trial, reached) || !next_tangent(trial, &tangent, 0, next)) {
      length /= 2;
      continue;
    }
    if (mu * reached <= 0) {
      found = trial;
      if (converge(found, 0)) return true;
      length /= 2;
      continue;
    }
    std::swap(path, trial);
    mu = reached;
    before = std::exchange(tangent, next);
    last_length = length;
    if (std::abs(mu) < least_) {
      least_ = std::abs(mu);
      nearest_ = path;
    }
    if (std::abs(mu) < leap * tried) {
      tried = std::abs(mu);
      found = path;
      if (converge(found, 0)) return true;
    }
    if (std::abs(mu) > farthest || scales(path, tables_).magnitude > runaway * extent_) return false;
    if (began - left_ <= few_linearisations) length = std::min(1.5 * length, longest_length);
  }
  return false;
}

ResidualHomotopy::Report ResidualHomotopy::find(Path& path) {
  first_ = equations_.evaluate(path);
  if (!first_.allFinite()) return {false, "the action is not finite along the path"};
  const double size_at_first = equations_.size(first_, path);
  enough_ = free_times_ ? std::clamp(part_of_first * size_at_first, roundoff, solved) : solved;
  if (size_at_first <= (free_times_ ? roundoff : solved)) return {true, {}};
  const Scales size = scales(path, tables_);
  extent_ = std::max(size.q, size.magnitude);
  nearest_ = path;
  least_ = 1;
  bool reached = descend(nearest_, least_);
  Path found = nearest_;
  const auto trace_from = [&](const Path& start, double mu) {
    for (const double sense : {-1.0, 1.0}) reached = reached || trace(start, mu, sense, found);
  };
  if (least_ < 1) trace_from(Path(nearest_), least_);  // a copy: curves replace the nearest
  trace_from(path, 1);
  if (!reached) return {false, failure(path)};
  path = std::move(found);
  return {true, {}};
}

/// The node beside which lengths have changed most on the way.
std::string ResidualHomotopy::failure(const Path& from) const {
  if (!free_times_) return "the curves of paths with a part of the residual do not lead to one without";
  int node = 1;
  double most = 0;
  for (int k = 0; k < from.elements(); ++k) {
    const double change = std::abs(std::log(nearest_.lengths()[k] / from.lengths()[k]));
    if (change > most) node = std::max(k, 1);
    most = std::max(most, change);
  }
  return fmt::format(
      "no node times were found that give all elements the same discrete energy: at node {}, t = {:.6g}, "
      "where elements change most on the way, the equation of its time seems to have no solution, as where "
      "the energy error of the scheme changes its sign (often at a turning point); try fewer elements, "
      "another scheme, a shorter path, or leave steps out",
      node, nearest_.mesh()[node] * nearest_.duration());
}

}  // namespace extremal
