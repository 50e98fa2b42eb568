#include "study/singular_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "action/scheme.hpp"
#include "problem/singular_ends.hpp"
#include "study/phase.hpp"

namespace extremal {
namespace {

/// Whether a rule has points at the ends of elements.
bool evaluates_at_ends(const Scheme& scheme) {
  switch (scheme.quadrature) {
    case Quadrature::midpoint:
    case Quadrature::gauss:
    case Quadrature::exact:
      return false;
    default:
      return true;
  }
}

/// Where something is asked for, why there is no such thing, and what to do instead.
struct Request {
  Location at;
  std::string what;
  std::string mend = "leave it out";
};

bool names_momentum(const Assignment& a) { return a.name.starts_with("p_"); }

std::optional<Request> of_solve(const SolveTable& solve) {
  if (!solve.scheme) return std::nullopt;
  const Location at = position(*solve.scheme, 0);
  if (!solve.elements)
    return Request{at, fmt::format("elements of '{}' are not adapted to a tolerance", solve.scheme->value),
                   "leave 'scheme' out"};
  if (evaluates_at_ends(scheme(solve.scheme->value)))
    return Request{at, fmt::format("'{}' evaluates it", solve.scheme->value), "write gauss(s)"};
  return std::nullopt;
}

std::optional<Request> of_boundary(const BoundaryTable& boundary) {
  for (const std::vector<Assignment>* end : {&boundary.start, &boundary.end})
    if (const auto it = std::ranges::find_if(*end, names_momentum); it != end->end())
      return Request{it->name_at, "momenta at ends are not available"};
  if (!boundary.integrals.empty())
    return Request{position(boundary.integrals.front(), 0), "integrals are not available"};
  return std::nullopt;
}

/// The first thing that is asked for and is not available at such an end.
std::optional<Request> unavailable(const Scene& scene, Purpose purpose) {
  if (purpose == Purpose::comparison)
    return Request{scene.boundary.at, "shooting is not available to compare with", "write 'solve' instead"};
  if (scene.search) return Request{scene.search->solutions.at, "[search] is not available"};
  if (scene.continuation && purpose == Purpose::family && scene.continuation->switching)
    return Request{position(scene.continuation->parameter, 0), "branch points of families are not looked for",
                   "leave 'switch' out"};
  if (scene.inequalities) return Request{scene.inequalities->at, "[path] is not available"};
  if (!scene.system.force.empty())
    return Request{scene.system.force.front().name_at, "forces are not available"};
  if (!scene.waypoints.empty()) return Request{scene.waypoints.front().at, "waypoints are not available"};
  if (scene.fit) return Request{scene.fit->at, "a fit is not available"};
  if (std::optional<Request> found = of_boundary(scene.boundary)) return found;
  return of_solve(scene.solve);
}

}  // namespace

void check_singular_ends(const Scene& scene, Purpose purpose, const Problem& problem) {
  // Constants that are asked for have no values yet.
  if (!scene.boundary.unknowns.empty()) return;
  const std::optional<Request> request = unavailable(scene, purpose);
  if (!request) return;
  const std::optional<InfiniteLagrangian> found = infinite_lagrangian(problem);
  if (!found) return;
  const std::vector<std::string> names = coordinate_names(problem);
  std::string place;
  for (std::size_t a = 0; a < found->q.size() && a < names.size(); ++a)
    place += fmt::format("{}{} = {:.6g}", a > 0 ? ", " : "", names[a], found->q[a]);
  const std::string end = found->at_end ? "end" : "start";
  if (found->by_time)
    throw SceneError(request->at, fmt::format("L is infinite at the time of the {}, and there {}; {}", end,
                                              request->what, request->mend));
  throw SceneError(
      request->at,
      fmt::format("L is infinite at the {}, {}, and there {}; {}, or move the {} aside, to {}", end, place,
                  request->what, request->mend, end,
                  found->coordinate >= 0 ? fmt::format("{} = {:.6g}", names[found->coordinate], found->beside)
                                         : "values at which L is finite"));
}

}  // namespace extremal
