#include "study/continued.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "problem/copies.hpp"
#include "problem/manifold.hpp"
#include "problem/phase_space.hpp"
#include "problem/recurrence.hpp"
#include "study/constraints/constraints.hpp"
#include "study/continued_by_values.hpp"
#include "study/extension.hpp"
#include "study/infinite.hpp"
#include "study/minimal_family.hpp"
#include "study/model/boundary.hpp"
#include "study/model/modelling.hpp"
#include "study/model/system_form.hpp"
#include "study/study.hpp"

namespace extremal {
namespace {

/// Values that differ by less than this, relative, are the same.
constexpr double same = 1e-12;
/// Part of the way to the value wanted, where it is tried what depends on a parameter.
constexpr double near = 1e-3;
/// Parts of the way where motions must recur: what recurs at the beginning only by its value fails at the
/// first.
constexpr double recurring[] = {near, 0.382, 1};

void check_different(const ContinuationTable& table, double from) {
  const double to = table.to.value;
  if (std::abs(to - from) <= same * std::max(std::abs(to), std::abs(from)))
    throw SceneError(table.to.at, fmt::format("{} is {} already; give another value for 'to'",
                                              table.parameter.value, from));
}

Continued varied_duration(const ContinuationTable& table, const Problem& problem) {
  if (problem.duration.free)
    throw SceneError(position(table.parameter, 0),
                     "the duration is free, so it cannot be varied; vary \"energy\" or a parameter");
  if (!problem.motion().structure().autonomous)
    throw SceneError(position(table.parameter, 0),
                     "varying the duration needs a Lagrangian that does not depend on t");
  if (problem.copies && problem.periodic)
    throw SceneError(position(table.parameter, 0),
                     "with forces that do not depend on t an orbit has a period of its own; write "
                     "duration = \"free\" and vary a parameter");
  if (!(table.to.value > 0))
    throw SceneError(table.to.at, fmt::format("to = {}; a duration must be positive", table.to.value));
  return {"duration", {problem, Varied::duration, problem.duration.value, table.to.value, {}}};
}

Continued varied_energy(const ContinuationTable& table, const Problem& problem) {
  if (!problem.duration.energy)
    throw SceneError(position(table.parameter, 0),
                     "varying the energy needs duration = \"free\" and 'energy' in [boundary]");
  return {"energy", {problem, Varied::energy, *problem.duration.energy, table.to.value, {}}};
}

bool same_coefficients(const EndMap& a, const EndMap& b) {
  return a.free == b.free &&
         std::equal(a.z.begin(), a.z.end(), b.z.begin(), b.z.end(), [](const Triplet& x, const Triplet& y) {
           return x.row == y.row && x.column == y.column && x.value == y.value;
         });
}

/// A scene whose parameter can be given any value.
class VariedScene {
 public:
  VariedScene(const Scene& scene, Problem problem, const std::string& parameter)
      : scene_(scene),
        form_(scene.system, parameter, problem.phase ? Formulation::phase_space : Formulation::legendre),
        near_(end_points(problem)),
        guess_(problem.guess),
        problem_(std::move(problem)) {
    problem_.guess = {};
  }

  Problem at(double value) {
    const System system = put(value);
    Problem problem = with(system);
    if (problem_.manifold) {
      constrain_like(*problem_.manifold, scene_.system, system, problem);
      EndPoints near = near_;
      complete_ends(scene_, near, problem);
    }
    return problem;
  }

  /// With constraints.
  BareProblem bare(double value) {
    const System system = put(value);
    BareProblem found{with(system), {}};
    found.graph = put_manifold_like(*problem_.manifold, scene_.system, system, found.problem);
    EndPoints near = near_;
    complete_ends(scene_, near, found.problem);
    return found;
  }

 private:
  System put(double value) {
    System system = form_.at(value);
    scene_.system = form_.table();
    return system;
  }

  /// But for constraints.
  Problem with(const System& system) {
    Problem problem = problem_;
    problem.lagrangian = system.lagrangian;
    if (problem.phase) set_phase_space(*system.hamiltonian, problem, problem_.phase.get());
    problem.copies = system.copies;
    if (problem_.extension) {
      put_extension(system, problem);
      return problem;
    }
    set_relation(scene_.boundary, system, problem);
    problem.duration = read_duration(scene_.boundary, system);
    if (problem_.infinite) {
      InfiniteEnds infinite = read_infinite_ends(scene_, Purpose::family, problem);
      problem.guess = guess_;
      leave_infinite_ends(scene_, std::move(infinite), problem);
    }
    return problem;
  }

  void put_extension(const System& system, Problem& problem) const {
    const ExtendedScene parts = split(scene_, system);
    set_relation(parts.linear, system, problem);
    problem.duration = read_duration(parts.linear, system);
    if (problem.duration.free) problem.duration.value = problem_.duration.value;
    read_extension(scene_, parts, system, {}, problem);
  }

  Scene scene_;
  SystemForm form_;
  EndPoints near_;  ///< where the family begins
  Guess guess_;
  Problem problem_;
};

/// A map must leave L unchanged, and a duration must be one that L repeats after, along the whole family.
void check_recurrence_along(VariedScene& varied, const Problem& problem, const ContinuationTable& table,
                            double from) {
  if (!problem.periodic) return;
  for (const double part : recurring) {
    const double value = from + part * (table.to.value - from);
    Problem at;
    try {
      at = varied.at(value);
    } catch (const SceneError&) {
      continue;  // the family ends before
    }
    at.guess = problem.guess;
    if (at.duration.free) at.duration.value = problem.duration.value;
    try {
      if (at.phase) at.lagrangian = at.phase->bare;
      check_recurrence(at.copies ? pair_of(at) : at);
    } catch (const RecurrenceError& e) {
      throw SceneError(
          position(table.parameter, 0),
          fmt::format(
              "at {0} = {1}: {2}; write what must follow, the duration or the map, as a formula of {0}",
              table.parameter.value, value, e.change));
    }
  }
}

/// Nothing where there is no problem.
template <class Make>
auto where_possible(const Make& make) -> std::optional<decltype(make())> {
  try {
    return make();
  } catch (const SceneError&) {
    return std::nullopt;
  } catch (const FormulaError&) {
    return std::nullopt;
  }
}

Continued varied_parameter(const Scene& scene, const System& system, const Problem& problem) {
  const ContinuationTable& table = *scene.continuation;
  const std::string& name = table.parameter.value;
  const auto known = system.parameters.find(name);
  if (known == system.parameters.end()) {
    std::vector<std::string> names{problem.duration.energy ? "energy" : "duration"};
    for (const auto& [other, value] : system.parameters) names.push_back(other);
    throw UnknownChoice(position(table.parameter, 0), fmt::format("unknown parameter '{}'", name), name,
                        names);
  }
  if (known->second.list)
    throw SceneError(position(table.parameter, 0),
                     fmt::format("'{}' is a list; a continued parameter must be one number", name));
  const auto varied = std::make_shared<VariedScene>(scene, problem, name);
  Continued continued{name, {problem, Varied::parameter, known->second.value.front(), table.to.value, {}}};
  const double beside = continued.family.from + near * (table.to.value - continued.family.from);
  if (!same_coefficients(problem.ends, varied->at(beside).ends))
    throw SceneError(
        position(table.parameter, 0),
        fmt::format("coefficients of the boundary relation depend on '{}'; only right-hand sides may", name));
  check_recurrence_along(*varied, problem, table, continued.family.from);
  continued.family.name = name;
  continued.family.at = [varied](double value) { return where_possible([&] { return varied->at(value); }); };
  if (problem.manifold)
    continued.bare = [varied](double value) { return where_possible([&] { return varied->bare(value); }); };
  return continued;
}

}  // namespace

Continued read_continued(const Scene& scene, const System& system, const Problem& problem) {
  const ContinuationTable& table = *scene.continuation;
  const std::string& name = table.parameter.value;
  if (problem.infinite && (name == "duration" || name == "energy"))
    throw SceneError(position(table.parameter, 0),
                     fmt::format("with ends at infinity the {} is not varied; vary a parameter", name));
  if (problem.infinite && table.switching)
    throw SceneError(position(table.parameter, 0),
                     "with ends at infinity branch points are not looked for; leave 'switch' out");
  if (scene.solve.scheme && table.switching)
    throw SceneError(
        position(*scene.solve.scheme, 0),
        "families of a scheme are followed from value to value, and branch points are not looked "
        "for; leave 'scheme' or 'switch' out");
  Continued continued = name == "duration" ? varied_duration(table, problem)
                        : name == "energy" ? varied_energy(table, problem)
                                           : varied_parameter(scene, system, problem);
  check_different(table, continued.family.from);
  if (table.points) continued.points = static_cast<int>(table.points->value);
  continued.switching = table.switching;
  return continued;
}

FollowedBranch follow(const Study& study, const std::function<void(const BranchPoint&)>& progress) {
  if (!study.continuation)
    throw std::invalid_argument(
        study.scene + ": the table [continuation] is missing; it names the parameter and its last value");
  const Continued& continued = *study.continuation;
  if (continued_by_values(study.problem, study.options)) return follow_by_values(study, continued, progress);
  SolveOptions options = study.options;
  options.deadline = deadline_of(study);
  std::optional<FollowedBranch> minimal = follow_in_minimal_coordinates(study, options);
  if (minimal && progress)
    for (const BranchPoint& point : minimal->points) progress(point);
  if (minimal && unended(*minimal) == 0) return *std::move(minimal);
  Diagram diagram(continued.family, {std::move(options), continued.points, continued.switching});
  FollowedBranch followed;
  followed.title = study.title;
  followed.parameter = continued.parameter;
  followed.names = study.problem.names;
  while (diagram.advance()) {
    followed.points.push_back(diagram.point());
    if (progress) progress(followed.points.back());
  }
  followed.branches = diagram.branches();
  if (minimal && unended(*minimal) <= unended(followed)) return *std::move(minimal);
  return followed;
}

}  // namespace extremal
