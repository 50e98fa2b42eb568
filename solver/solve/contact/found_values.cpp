#include "solve/contact/found_values.hpp"

#include <memory>
#include <utility>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"

namespace extremal {

std::vector<double> unknowns_of(const Problem& problem) {
  return problem.extension ? problem.extension->guess : std::vector<double>{};
}

void put_unknowns(const std::vector<double>& unknowns, Problem& problem) {
  if (unknowns.empty() || unknowns == unknowns_of(problem)) return;
  Extension extension = *problem.extension;
  extension.guess = unknowns;
  std::vector<double> constants = unknowns;
  constants.resize(constants.size() + extension.integrals.size(), 1.0);
  problem.lagrangian = extension.at(constants);
  if (problem.manifold) problem.manifold = extension.manifold_at(constants);
  if (problem.inequalities->at) {
    Inequalities inequalities = *problem.inequalities;
    inequalities.all = inequalities.at(constants);
    problem.inequalities = std::make_shared<const Inequalities>(std::move(inequalities));
  }
  problem.extension = std::make_shared<const Extension>(std::move(extension));
}

void put_free_times(const std::vector<WaypointNode>& free, const std::vector<double>& times,
                    Problem& problem) {
  if (free.empty()) return;
  Extension extension = *problem.extension;
  for (const WaypointNode& each : free)
    extension.waypoints[each.waypoint].time = times[each.node] / times.back();
  problem.extension = std::make_shared<const Extension>(std::move(extension));
}

}  // namespace extremal
