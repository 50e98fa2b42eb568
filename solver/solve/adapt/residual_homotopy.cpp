#include "solve/adapt/residual_homotopy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/adapt/limits.hpp"
#include "solve/curve/arclength.hpp"
#include "solve/mesh/resolution.hpp"

namespace extremal {

using namespace limits::residual_homotopy;

ResidualHomotopy::ResidualHomotopy(const Problem& problem, const ElementTables& tables, int elements,
                                   bool free_times, std::function<bool()> on_step)
    : tables_(tables),
      free_times_(free_times),
      on_step_(std::move(on_step)),
      equations_(problem, tables, elements, free_times) {}

/// All solutions of F(x) + F'(x) δx = (μ + δμ) F(x_0) are correction + δμ direction.
bool ResidualHomotopy::linearise(const Path& path, double mu) {
  const SchemeEquations::Vector& left = equations_.evaluate(path);
  if (--left_ < 0 || !on_step_() || !equations_.factor(path)) return false;
  const Eigen::Index unknowns = left.size();
  correction.setZero(unknowns + 1);
  direction.setOnes(unknowns + 1);
  correction.head(unknowns) = equations_.solve(mu * first_ - left);
  direction.head(unknowns) = equations_.solve(first_);
  return correction.allFinite() && direction.allFinite();
}

double ResidualHomotopy::dot(const Move& a, const Move& b) const {
  const Eigen::Index last = a.size() - 1;
  return equations_.product(a, b, at_.path, extent_) + a[last] * b[last];
}

bool ResidualHomotopy::apply(const Move& move, double factor) {
  if (!equations_.apply(at_.path, move, factor)) return false;
  at_.mu += factor * move[move.size() - 1];
  return true;
}

void ResidualHomotopy::save() {
  saved_ = at_;
  saved_left_ = left_;
}

bool ResidualHomotopy::correct(const Move& tangent, double length) {
  return contract(*this, across(*this, tangent),
                  {most_corrections, contraction, longest_correction * length, corrected * length,
                   close_to_curve * length, nearly * length}) &&
         linearise(Factors::anew);
}

/// Newton's method for one μ, until steps gain nothing more.
bool ResidualHomotopy::converge(Path& path, double mu) {
  const auto solve = [&](Factors) { return linearise(path, mu); };
  double before = INFINITY;
  Path trial;
  const auto take = [&](bool solved) {
    if (!solved) return Progress::failed;
    trial = path;
    const bool moved = equations_.apply(trial, correction, 1);
    const double after = moved ? equations_.size(equations_.evaluate(trial) - mu * first_, trial) : INFINITY;
    if (before <= enough_ && !(after < before)) return Progress::arrived;
    if (!(after < worst_residual)) return Progress::failed;
    before = after;
    std::swap(path, trial);
    return Progress::more;
  };
  const Progress progress = newton_loop(solve, most_newton_steps, take);
  return progress == Progress::arrived || before <= enough_;
}

/// Newton's method for values of μ that fall to 0 as fast as it converges.
bool ResidualHomotopy::descend(Point& at) {
  left_ = most_linearisations_of_curve();
  Path trial;
  for (double way = 1; way >= least_way && left_ > 0;) {
    trial = at.path;
    const double next = std::max(0.0, at.mu - way);
    if (!converge(trial, next)) {
      way /= 2;
      continue;
    }
    std::swap(at.path, trial);
    at.mu = next;
    if (next == 0) return true;
    way *= 2;
  }
  return false;
}

int ResidualHomotopy::most_linearisations_of_curve() const {
  return std::clamp(static_cast<int>(most_work / equations_.unknowns()), least_linearisations,
                    most_linearisations);
}

bool ResidualHomotopy::trace(const Point& from, double sense, Path& found) {
  left_ = most_linearisations_of_curve();
  at_ = from;
  double tried = std::abs(at_.mu);  // where Newton's method alone was tried
  if (!linearise(Factors::anew)) return false;
  ArclengthSteps<Move> steps{{least_length, shortening, sharpest_turn}, first_length};
  steps.begin(*this, nullptr, sense);
  const auto arrives = [&] {
    found = at_.path;
    return converge(found, 0);
  };
  while (steps.advance(*this)) {
    if (saved_.mu * at_.mu <= 0) {
      if (arrives()) return true;
      refuse();
      steps.length *= shortening;
      continue;
    }
    steps.accept(steps.length);
    if (std::abs(at_.mu) < std::abs(nearest_.mu)) nearest_ = at_;
    if (std::abs(at_.mu) < leap * tried) {
      tried = std::abs(at_.mu);
      if (arrives()) return true;
    }
    if (std::abs(at_.mu) > farthest || scales(at_.path, tables_).magnitude > runaway * extent_) return false;
    if (saved_left_ - left_ <= few_linearisations)
      steps.length = std::min(lengthening * steps.length, longest_length);
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
  nearest_ = {path, 1};
  bool reached = descend(nearest_);
  Path found = nearest_.path;
  const auto trace_from = [&](const Point& start) {
    for (const double sense : {-1.0, 1.0}) reached = reached || trace(start, sense, found);
  };
  if (nearest_.mu < 1) trace_from(Point(nearest_));  // a copy: curves replace the nearest
  trace_from({path, 1});
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
    const double change = std::abs(std::log(nearest_.path.lengths()[k] / from.lengths()[k]));
    if (change > most) node = std::max(k, 1);
    most = std::max(most, change);
  }
  return fmt::format(
      "no node times were found that give all elements the same discrete energy: at node {}, t = {:.6g}, "
      "where elements change most on the way, the equation of its time seems to have no solution, as where "
      "the energy error of the scheme changes its sign (often at a turning point); try fewer elements, "
      "another scheme, a shorter path, or leave steps out",
      node, nearest_.path.mesh()[node] * nearest_.path.duration());
}

}  // namespace extremal
