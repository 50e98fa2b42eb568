#include "study/path_constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/nearby.hpp"
#include "solve/external/method.hpp"
#include "study/constraints/constraints.hpp"
#include "study/constraints/limits.hpp"
#include "study/extension.hpp"
#include "study/model/modelling.hpp"
#include "study/model/unknown_constants.hpp"
#include "system/constraints.hpp"
#include "system/kinks.hpp"

namespace extremal {
namespace {

using namespace limits::constraints;

/// "left >= right" as "left  = right", of the same length; whether g = right − left.
struct Equation {
  Text text;
  bool negated = false;
};

Equation equation_of(const Text& inequality) {
  Equation equation{inequality};
  std::string& text = equation.text.value;
  const std::size_t sign = text.find_first_of("<>=");
  const auto refuse = [&](std::size_t offset, const char* what) {
    throw FaultyFormula(position(inequality, offset), what);
  };
  if (sign == std::string::npos || text[sign] == '=')
    refuse(sign == std::string::npos ? 0 : sign,
           "an inequality along the path is 'left >= right' or 'left <= right', as in \"x^2 + y^2 >= 1\"; "
           "equations belong to 'constraints' in [system]");
  if (sign + 1 == text.size() || text[sign + 1] != '=')
    refuse(sign, "a path may touch what an inequality excludes: write >= or <=");
  if (const std::size_t other = text.find_first_of("<>=", sign + 2); other != std::string::npos)
    refuse(other, "one inequality has one sign; write two inequalities");
  equation.negated = text[sign] == '<';
  text[sign] = ' ';
  return equation;
}

/// A system with inequalities as equations beside its constraints.
struct InequalityTable {
  SystemTable table;
  std::vector<Text> equations;
  std::vector<char> negated;

  explicit InequalityTable(const Scene& scene) : table(scene.system) {
    for (const Text& inequality : scene.inequalities->constraints) {
      Equation equation = equation_of(inequality);
      equations.push_back(std::move(equation.text));
      negated.push_back(equation.negated);
    }
  }

  /// Of the inequalities with these numbers, perhaps behind the constraints.
  ConstrainedGraph graph(const std::vector<int>& numbers, bool with_constraints) const {
    SystemTable part = table;
    if (!with_constraints) part.constraints.clear();
    const std::size_t first = part.constraints.size();
    for (const int k : numbers) part.constraints.push_back(equations[k]);
    ConstrainedGraph graph = make_constrained(part);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (negated[numbers[i]])
        graph.constraints[first + i] = graph.graph.unary(Op::neg, graph.constraints[first + i]);
    return graph;
  }
};

/// Each of them alone, so that an error names its own.
void check_formulas(const InequalityTable& inequalities) {
  constexpr std::string_view velocities = "stands for velocities";
  for (std::size_t k = 0; k < inequalities.equations.size(); ++k) try {
      inequalities.graph({static_cast<int>(k)}, false);
    } catch (const FaultyFormula& e) {
      const std::string what = e.what();
      const std::size_t found = what.find(velocities);
      if (found == std::string::npos) throw;
      const std::size_t begin = what.rfind(": ", found);
      throw FaultyFormula(
          e.at, what.substr(begin == std::string::npos ? 0 : begin + 2,
                            found + velocities.size() - (begin == std::string::npos ? 0 : begin + 2)) +
                    "; an inequality along the path holds between coordinates: where a velocity is "
                    "at its bound, the motion is that of a system without inertia, whose switches "
                    "this method does not find. Write it between coordinates");
    }
}

const Location& place_of(const BoundaryTable& boundary, bool at_end) {
  const std::vector<Assignment>& table = at_end ? boundary.end : boundary.start;
  if (!table.empty()) return table.front().name_at;
  return boundary.conditions.empty() ? boundary.at : boundary.conditions.front().at;
}

/// A point that is fixed must keep the inequalities.
void check_point(const Location& where, const char* name, const Inequalities& inequalities,
                 const std::vector<double>& q, double t, double size) {
  const ConstraintValues values = inequalities.all->at(q, t);
  for (int k = 0; k < inequalities.count(); ++k) {
    if (!std::isfinite(values.g[k]))
      throw SceneError(where, fmt::format("the inequality '{}' is not finite at the {}; give another point",
                                          inequalities.texts[k], name));
    if (values.g[k] >= -end_distance * size * values.slopes.row(k).norm()) continue;
    throw SceneError(where,
                     fmt::format("the {} does not keep the inequality '{}': it is missed by {:.6g} there; "
                                 "give values that keep it",
                                 name, inequalities.texts[k], -values.g[k]));
  }
}

void check_points(const Scene& scene, const Inequalities& inequalities, const Problem& problem) {
  const int n = problem.coordinates();
  double size = 0;
  for (const double x : problem.ends.offset) size = std::max(size, std::abs(x));
  if (size == 0) size = 1;
  for (const bool at_end : {false, true}) {
    if (!problem.ends.fixes(at_end)) continue;
    const auto begin = problem.ends.offset.begin() + (at_end ? n : 0);
    check_point(place_of(scene.boundary, at_end), at_end ? "end" : "start", inequalities, {begin, begin + n},
                at_end ? problem.duration.value : 0, size);
  }
  if (!problem.extension) return;
  for (std::size_t w = 0; w < problem.extension->waypoints.size(); ++w) {
    const WaypointCondition& waypoint = problem.extension->waypoints[w];
    if (std::ssize(waypoint.fixed) < n) continue;
    std::vector<double> q;
    for (const auto& [a, value] : waypoint.fixed) q.push_back(value);
    check_point(scene.waypoints[w].at, "waypoint", inequalities, q, waypoint.at(problem.duration.value),
                size);
  }
}

/// The least of all inequalities at a point, as a distance.
double least_distance(const Inequalities& inequalities, const std::vector<double>& q, double t) {
  const ConstraintValues values = inequalities.all->at(q, t);
  double least = INFINITY;
  for (Eigen::Index c = 0; c < values.g.size(); ++c)
    least = std::min(least, values.g[c] / std::max(values.slopes.row(c).norm(), 1e-300));
  return least;
}

/// Moves a point to a distance from the surface of an inequality, along its slope.
void move_beside(const Inequalities& inequalities, int k, double distance, double t, std::vector<double>& q) {
  constexpr int most_steps = 20;
  for (int step = 0; step < most_steps; ++step) {
    const ConstraintValues values = inequalities.all->at(q, t);
    const Eigen::VectorXd slope = values.slopes.row(k);
    const double length = slope.norm();
    if (!(length > 0)) return;
    for (std::size_t a = 0; a < q.size(); ++a)
      q[a] += (distance - values.g[k] / length) * slope[static_cast<Eigen::Index>(a)] / length;
  }
}

/// What is allowed on a closed path must be allowed one period later, where its map takes it: compared on
/// both sides of each surface.
void check_closed(const Scene& scene, const Inequalities& inequalities, const Problem& problem) {
  if (!problem.periodic) return;
  const int n = problem.coordinates();
  NearbyPoints points(problem);
  std::vector<double> near, v;
  for (int k = 0; k < closing_points; ++k) {
    const double t = points.next(near, v);
    double size = 0;
    for (const double x : near) size = std::max(size, std::abs(x));
    for (int c = 0; c < 2 * inequalities.count(); ++c) {
      std::vector<double> q = near;
      move_beside(inequalities, c / 2, (c % 2 ? 1 : -1) * closing_distance * size, t, q);
      std::vector<double> later(problem.ends.offset.begin() + n, problem.ends.offset.end());
      for (const Triplet& z : problem.ends.z)
        if (z.row >= n) later[z.row - n] += z.value * q[problem.ends.home[z.column]];
      const double a = least_distance(inequalities, q, t),
                   b = least_distance(inequalities, later, t + problem.duration.value);
      const bool clear = std::min(std::abs(a), std::abs(b)) > closing_distance * size / 2;
      if (!clear || (a < 0) == (b < 0)) continue;
      throw SceneError(scene.inequalities->at,
                       fmt::format("a closed path recurs only if the inequalities do: a point that is {} at "
                                   "t = {:.6g} is {} where the path takes it one period later; give "
                                   "inequalities that 'map' and 'duration' leave unchanged",
                                   a < 0 ? "excluded" : "allowed", t, b < 0 ? "excluded" : "allowed"));
    }
  }
}

}  // namespace

bool inequalities_vary(const Scene& scene) {
  const Dependents dependents = dependents_of(scene);
  return scene.inequalities && std::ranges::any_of(scene.inequalities->constraints, [&](const Text& text) {
           return any_of(names_in(equation_of(text).text.value), dependents);
         });
}

void check_inequalities(const Scene& scene, Purpose purpose) {
  if (!scene.inequalities) return;
  const auto refuse = [](const Location& at, const std::string& what) {
    throw SceneError(at, "with inequalities along the path " + what);
  };
  const BoundaryTable& boundary = scene.boundary;
  if (!available(Method::ipopt))
    throw SceneError(scene.inequalities->at,
                     "[path] needs Ipopt, which is not part of this build; build with -DEXTREMAL_IPOPT=ON");
  if (scene.system.hamiltonian)
    refuse(scene.inequalities->at,
           "the system must have a 'lagrangian', whose action is minimised; write that, or leave [path] out");
  if (!scene.system.force.empty())
    refuse(scene.system.force.front().name_at,
           "there must be an action that can be least, and forces have none; leave them out, or the "
           "inequalities");
  if (boundary.infinite)
    refuse(boundary.duration.at, "the duration must be finite; write a number, or leave [path] out");
  if (scene.fit) refuse(scene.fit->at, "a fit is not available; leave one or the other out");
  if (scene.continuation && purpose == Purpose::family)
    refuse(scene.continuation->at,
           "families are not continued; solve for each value with --set instead, without [continuation]");
  if (purpose == Purpose::comparison)
    refuse(scene.inequalities->at, "shooting is not available to compare with; write 'solve' instead");
  if (scene.solve.scheme)
    refuse(position(*scene.solve.scheme, 0),
           fmt::format("elements end where contacts begin and end, and follow the tolerance; leave {} out",
                       scene.solve.steps      ? "'scheme', 'elements' and 'steps'"
                       : scene.solve.elements ? "'scheme' and 'elements'"
                                              : "'scheme'"));
  if (scene.solve.method && scene.solve.method->value == name(Method::ceres))
    refuse(position(*scene.solve.method, 0), "the method is \"ipopt\"; write that, or leave 'method' out");
}

void put_inequalities(const Scene& scene, const System& system, Problem& problem) {
  if (!scene.inequalities) return;
  const InequalityTable table(scene);
  check_formulas(table);
  if (problem.initial)
    throw SceneError(scene.inequalities->at,
                     "'start' gives initial data, and their motion is no minimiser; leave [path] out, or fix "
                     "the end instead of momenta");
  if (problem.lagrangian->kinks())
    throw SceneError(position(scene.system.law(), 0),
                     "with inequalities along the path the Lagrangian must be smooth, without abs, min, max "
                     "and step");
  if (system.names.size() > most_coordinates)
    throw SceneError(scene.inequalities->at, fmt::format("inequalities of {} coordinates; {} are the most",
                                                         system.names.size(), most_coordinates));
  auto inequalities = std::make_shared<Inequalities>();
  std::vector<int> numbers;
  for (const Text& text : scene.inequalities->constraints) {
    numbers.push_back(static_cast<int>(numbers.size()));
    inequalities->texts.push_back(text.value);
  }
  const Eigen::MatrixXd metric = metric_of_motion(system, problem);
  const double rate = growth / problem.duration.value;
  inequalities->all = constrained_values(table.graph(numbers, false), system, metric);
  if (!scene.boundary.unknowns.empty())
    inequalities->at = [table, scene, system, metric, numbers](const std::vector<double>& constants) {
      InequalityTable there = table;
      there.table = table_at(scene, constants);
      return constrained_values(there.graph(numbers, false), system, metric);
    };
  inequalities->hold = [table, scene, system, metric, rate](
                           const std::vector<int>& held, const std::vector<double>& constants) -> HeldSystem {
    InequalityTable there = table;
    if (!constants.empty()) there.table = table_at(scene, constants);
    const System moved = constants.empty() ? system : make_system(there.table);
    ConstrainedSystem found = constrained_system(there.graph(held, true), moved, metric, rate);
    return {std::move(found.lagrangian), std::move(found.manifold)};
  };
  if (problem.duration.free && problem.duration.energy && !inequalities->all->autonomous())
    throw SceneError(scene.inequalities->at,
                     "inequalities that depend on t change the energy; with 'energy' they must not: write "
                     "'where', or give the duration as a number");
  for (const WaypointTable& waypoint : scene.waypoints)
    if (waypoint.free && !inequalities->all->autonomous())
      throw SceneError(
          waypoint.time.at,
          "inequalities that depend on t change the energy, which at = \"free\" makes continuous; "
          "give the time of the waypoint as a number");
  if (!inequalities_vary(scene)) check_points(scene, *inequalities, problem);
  check_closed(scene, *inequalities, problem);
  problem.inequalities = std::move(inequalities);
}

}  // namespace extremal
