#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/continuation.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/zero_eigenvalue.hpp"
#include "solve/search/search.hpp"

/// \file How a branch begins, and on which elements it goes on.

namespace extremal {

namespace {

constexpr double first_length = 0.02, least_longest = 0.1, most_longest = 0.4;
/// The longest step, so that so many make up the distance wanted where as many points are allowed.
constexpr double coverage = 4;
/// Of the size of the guess: a path smaller than this is at rest.
constexpr double rest = 1e-9;
/// The first step onto a branch that crosses another; at least.
constexpr double first_departure = 0.05, least_departure = 1e-4;
/// Elements are planned for this share of the tolerance.
constexpr double spare = 0.1;
constexpr int highest_degree = 16, least_degree = 5, most_elements = 1 << 10;
/// Elements follow the path from point to point: where it becomes smooth they become longer again.
constexpr double strongest_cut = 16, strongest_growth = 2;
/// Elements whose error is below this share of the tolerance are more than needed.
constexpr double lavish = 1e-4;

}  // namespace

bool Continuation::begin() {
  longest_ = std::clamp(coverage / options_.points, least_longest, most_longest);
  length_ = std::min(first_length, longest_);
  if (!(seed_ ? begin_from_seed() : begin_from_solve())) return false;
  measure_anew();
  found_.push_back({read(PointKind::regular)});
  first_ = here_;
  check_action();
  return true;
}

/// The extremal that a solve finds, with the branch's tangent there.
bool Continuation::begin_from_solve() {
  w_.levels.bind(family_.problem.lagrangian);
  SolveOptions adaptive = options_.solve;
  adaptive.scheme.reset();
  adaptive.elements = 0;
  Search search(family_.problem, adaptive, w_);
  const Outcome& outcome = search.run();
  std::swap(path_, search.path());
  if (outcome.status != Status::converged)
    return stop(BranchEnd::not_started, "no extremal to begin with: " + outcome.message);
  for (const double x : family_.problem.guess.q) rest_ = std::max(rest_, rest * std::abs(x));
  const double coordinate = family_.varied == Varied::parameter ? family_.from : path_.duration();
  if (!branch_.place(coordinate) || resolve() == Elements::too_many || !turn(true))
    return stop(BranchEnd::not_started, "the equations of the branch are singular at its first point");
  if (here_.rate * (family_.to - family_.from) < 0) here_.scale(-1);
  return true;
}

/// Along what the equations answer next to where they are singular: it has little of the branch that is
/// crossed, and across it that branch does not go far.
bool Continuation::begin_from_seed() {
  const Seed seed = *std::exchange(seed_, std::nullopt);
  path_ = seed.path;
  branch_.set_units(seed.units);
  here_.units = seed.units;
  rest_ = rest * seed.units.extent;
  if (branch_.place(seed.coordinate)) {
    branch_.bind();
    if (turn(true)) {
      Stand from = here_;
      branch_.respond(here_.tangent, from.tangent);
      from.tangent.scale(side_ / std::sqrt(branch_.dot(from.tangent, from.tangent)));
      // What varies changes with the square of the length, perhaps fast: not past the value wanted at once.
      double past = 0;
      for (double length = first_departure; length > least_departure; length *= 0.7) {
        if (!go(from, length)) continue;
        if ((here_.varied - family_.to) * (from.varied - family_.to) > 0) return true;
        past = length;
      }
      if (past > 0 && go(from, past)) return true;
    }
  }
  return stop(BranchEnd::not_started, "no other branch was found where the equations are singular");
}

Scales Continuation::sizes() const {
  Scales size = scales(path_, branch_.tables());
  if (size.q <= rest_) size.q = 0;
  return size;
}

/// Elements that meet the tolerance, and not many more than that takes.
Continuation::Elements Continuation::resolve() {
  const ElementTables& tables = branch_.tables();
  const Scales size = sizes();
  w_.resolution.measure(path_, tables);
  const Resolution::Error error = w_.resolution.at(path_.degree());
  const double tolerance = options_.solve.tolerance;
  error_ = error.q + unit_roundoff * size.magnitude * std::sqrt(path_.elements() * path_.degree());
  branch_.set_null_threshold(zero_eigenvalue_along(size.q, error_, path_.elements()));
  const double excess = size.q > 0 ? std::max(error.q / size.q, 0.1 * error.v / size.v) / tolerance : 0;
  if (excess <= 1 && (excess == 0 || excess > lavish)) return Elements::fine;
  const Plan plan = plan_for(size);
  const bool fewer = plan.degree * plan.mesh.size() < 0.7 * path_.degree() * (path_.elements() + 1);
  if (excess <= 1 && (plan.mesh.empty() || !fewer)) return Elements::fine;
  if (plan.degree == 0) return Elements::too_many;
  adopt(plan);
  return Elements::changed;
}

/// Elements for the path that was measured.
Plan Continuation::plan_for(const Scales& size) {
  const double tolerance = options_.solve.tolerance;
  const auto aim = [&](double share) { return Resolution::Error{share * size.q, 10 * share * size.v}; };
  return w_.planner.plan(w_.resolution, path_.mesh(), branch_.tables(),
                         {.aim = aim(spare * tolerance),
                          .tolerated = aim(0.7 * tolerance),
                          .raised_degree = std::min(path_.degree() + 1, highest_degree),
                          .least_degree = least_degree,
                          .highest_degree = highest_degree,
                          .most_elements = most_elements,
                          .strongest_cut = strongest_cut,
                          .strongest_growth = strongest_growth});
}

/// The path and the tangent on other elements.
void Continuation::adopt(const Plan& plan) {
  const std::vector<double> before(path_.mesh().begin(), path_.mesh().end());
  const std::vector<double>& mesh = plan.mesh.empty() ? before : plan.mesh;
  w_.other.resample_from(path_, w_.levels.at(plan.degree), mesh);
  if (!tangent_.step.nodes.empty())
    tangent_.step.nodes = interpolated(tangent_.step.nodes, path_.coordinates(), before, mesh);
  std::swap(path_, w_.other);
  branch_.bind();
}

/// A place on elements that tell also the way to a branch that crosses there; nothing if its own do.
std::optional<Continuation::Stand> Continuation::resolved_for(const Stand& from, const Move& response) {
  path_ = from.path;
  tangent_ = from.tangent;
  branch_.set_units(from.units);
  if (!branch_.place(from.coordinate)) return std::nullopt;
  branch_.bind();
  branch_.close_by(from.row);
  const double length = std::sqrt(branch_.dot(response, response));
  path_.add(response.step.nodes, response.step.inner, 1 / length);
  path_.load_ends();
  const Scales size = scales(path_, branch_.tables());
  w_.resolution.measure(path_, branch_.tables());
  const Resolution::Error error = w_.resolution.at(path_.degree());
  if (std::max(error.q / size.q, 0.1 * error.v / size.v) <= options_.solve.tolerance) return std::nullopt;
  const Plan plan = plan_for(size);
  if (plan.degree == 0) return std::nullopt;
  path_ = from.path;
  adopt(plan);
  if (!correct(1, nullptr) || !turn()) return std::nullopt;
  here_.units = from.units;
  here_.bend = carried(from.bend, from.path);
  here_.twist = carried(from.twist, from.path);
  return here_;
}

}  // namespace extremal
