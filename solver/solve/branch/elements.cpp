#include <algorithm>
#include <cmath>

#include "action/corners.hpp"
#include "solve/branch/limits.hpp"
#include "solve/branch/tracker.hpp"
#include "solve/mesh/kink_nodes.hpp"
#include "solve/mesh/mesh.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/periodic/later_orbit.hpp"

/// \file Elements along a branch.

namespace extremal {

using namespace limits::elements;

namespace {

/// In tolerances.
double excess(const Resolution::Error& error, const Scales& size, double tolerance) {
  return std::max(error.q / size.q, 1 / slope_tolerances * error.v / size.v) / tolerance;
}

}  // namespace

/// Elements that meet the tolerance, and not many more than that takes.
Tracker::Fit Tracker::fit_elements() {
  const ElementTables& tables = branch_.tables();
  if (auto mesh = mesh_to_kinks(tables, path_, true, tolerance_)) {
    change_elements(path_.degree(), *mesh);
    return Fit::changed;
  }
  const Scales size = sizes();
  w_.resolution.measure(path_, tables);
  const Resolution::Error error = w_.resolution.at(path_.degree());
  error_ = error.q + unit_roundoff * size.magnitude * std::sqrt(path_.elements() * path_.degree());
  branch_.set_errors(
      {null_eigenvalue_of_branch(size.q, error_, path_), size.q > 0 ? 2 * error_ / size.q : 0});
  const double missed = size.q > 0 ? excess(error, size, tolerance_) : 0;
  if (missed <= 1 && (missed == 0 || missed > lavish)) return Fit::fine;
  const Plan plan = plan_for(size);
  const bool fewer =
      plan.degree * plan.mesh.size() < worth_changing * path_.degree() * (path_.elements() + 1);
  if (missed <= 1 && (plan.mesh.empty() || !fewer)) return Fit::fine;
  if (plan.degree == 0) return Fit::too_many;
  adopt(plan);
  return Fit::changed;
}

/// Elements for the path that was measured.
Plan Tracker::plan_for(const Scales& size) {
  const auto aim = [&](double share) {
    return Resolution::Error{share * size.q, slope_tolerances * share * size.v};
  };
  return w_.planner.plan(w_.resolution, path_.mesh(), branch_.tables(),
                         {.aim = aim(spare * tolerance_),
                          .tolerated = aim(tolerated * tolerance_),
                          .raised_degree = std::min(path_.degree() + 1, highest_degree),
                          .least_degree = least_degree,
                          .highest_degree = highest_degree,
                          .most_elements = most_elements,
                          .strongest_cut = strongest_cut,
                          .strongest_growth = strongest_growth});
}

void Tracker::adopt(const Plan& plan) {
  if (plan.mesh.empty()) return change_elements(plan.degree, {path_.mesh().begin(), path_.mesh().end()});
  const std::vector<double> times = kink_times(branch_.tables(), path_, true);
  change_elements(plan.degree, times.empty() ? plan.mesh : with_nodes(plan.mesh, times));
}

std::optional<std::vector<double>> Tracker::mesh_beside_closing() const {
  return mesh_to_kinks(branch_.tables(), path_, true, tolerance_,
                       least_beside_closing(path_.degree(), tolerance_));
}

bool Tracker::move_to(const std::vector<double>& mesh, bool across) {
  const double value = state.varied;
  tangent_ = state.tangent;
  change_elements(path_.degree(), mesh);
  return correct(1, across ? nullptr : &value) && update_tangent();
}

/// Of an orbit that can be shifted in time and begins beside a kink of L: the node farthest from its
/// crossings. Steps move the orbit a little along itself, or its crossings, and elements between T and a
/// crossing would be shortened to nothing.
std::optional<int> Tracker::node_off_kinks() const {
  const Problem& problem = branch_.problem();
  const ElementTables& tables = branch_.tables();
  if (!tables.kinks() || !problem.periodic || !problem.shifts_in_time()) return std::nullopt;
  const ClosingMap closed = closing_map(problem);
  std::vector<double> times = crossings(*tables.kinks(), path_);
  for (const Corner& corner : corners_of(*tables.kinks(), path_, &closed))
    if (corner.node == path_.elements()) times.push_back(1);
  const auto away = [&](int node) {
    double least = 1;
    for (const double t : times) {
      const double apart = std::abs(t - path_.mesh()[node]);
      least = std::min({least, apart, 1 - apart});
    }
    return least;
  };
  const double longest = *std::ranges::max_element(path_.lengths());
  if (away(0) > 0.5 * tables.scheme().node[0] * longest) return std::nullopt;
  int farthest = 0;
  for (int k = 1; k < path_.elements(); ++k)
    if (away(k) > away(farthest)) farthest = k;
  return farthest > 0 ? std::optional(farthest) : std::nullopt;
}

/// The path, the tangent and what is held begin at a node.
void Tracker::begin_at_node(int node) {
  const ElementTables& tables = branch_.tables();
  const ClosingMap closed = closing_map(branch_.problem());
  const Path before = path_;
  begin_at(closed, before, tables, node, path_);
  branch_.bind();
  const auto turn = [&](Move& move) {
    if (move.step.nodes.empty()) return;
    Path whole, later;
    whole.reset(tables, before.mesh(), before.duration(), before.lengths());
    whole.add(move.step.nodes, move.step.inner, 1);
    whole.load_ends();
    begin_at({closed.r, 0 * closed.c}, whole, tables, node, later);
    const double duration = move.step.duration;
    move.step = values_of(later);
    move.step.duration = duration;
  };
  turn(tangent_);
  std::vector<Move> family = branch_.held_family();
  for (Move& direction : family) turn(direction);
  branch_.hold_family(std::move(family));
  std::vector<double> mesh{path_.mesh().begin(), path_.mesh().end()};
  mesh.erase(mesh.end() - 1 - node);  // where T was, beside a crossing
  change_elements(path_.degree(), with_nodes(mesh, crossings(*tables.kinks(), path_)));
}

/// Responses to loads before are those of another beginning.
void Tracker::begin_off_kinks() {
  const std::optional<int> node = node_off_kinks();
  if (!node) return;
  tangent_ = state.tangent;
  begin_at_node(*node);
  if (correct(1, nullptr) && update_tangent()) state.earlier.clear();
}

/// The path, the tangent and what is held on other elements.
void Tracker::change_elements(int degree, const std::vector<double>& mesh) {
  const Path before = path_;
  path_.resample_from(before, w_.levels.at(degree), mesh);
  branch_.bind();
  tangent_ = transferred(tangent_, before);
  std::vector<Move> family = branch_.held_family();
  for (Move& direction : family) direction = transferred(direction, before);
  branch_.hold_family(std::move(family));
}

std::optional<BranchState> Tracker::resolved_for(const BranchState& from, const Move& response) {
  if (!return_to(from)) return std::nullopt;
  const double length = std::sqrt(branch_.dot(response, response));
  path_.add(response.step.nodes, response.step.inner, 1 / length);
  path_.load_ends();
  const Scales size = scales(path_, branch_.tables());
  w_.resolution.measure(path_, branch_.tables());
  if (excess(w_.resolution.at(path_.degree()), size, tolerance_) <= 1) return std::nullopt;
  const Plan plan = plan_for(size);
  if (plan.degree == 0) return std::nullopt;
  path_ = from.path;
  adopt(plan);
  if (!correct(1, nullptr) || !update_tangent()) return std::nullopt;
  state.units = from.units;
  state.bend = transferred(from.bend, from.path);
  state.twist = transferred(from.twist, from.path);
  return state;
}

}  // namespace extremal
