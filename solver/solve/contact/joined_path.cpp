#include "solve/contact/joined_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "action/rule.hpp"
#include "problem/inequalities.hpp"
#include "solution/observe.hpp"
#include "solution/path_contacts.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

/// Adds the elements of an arc that begins at `from`, raised to the degree of the path.
void append(const Trajectory& arc, double from, double to, Trajectory& path) {
  const std::size_t n = arc.coordinates;
  const Basis& basis = lobatto_nodal_basis(path.degree);
  std::vector<double> q(n), v(n);
  for (int k = 0; k < arc.elements(); ++k) {
    for (std::size_t j = 0; j < basis.points.size(); ++j) {
      arc.in_element(k, basis.points[j], q, v);
      path.nodes.insert(path.nodes.end(), q.begin(), q.end());
      path.slopes.insert(path.slopes.end(), v.begin(), v.end());
    }
    path.times.push_back(k + 1 == arc.elements() ? to : from + arc.times[k + 1]);
    path.lengths.push_back(arc.length(k));
  }
}

std::shared_ptr<const PathContacts> contacts_of(Arcs& arcs, const Junctions& path) {
  const std::vector<PathArc>& parts = path.arcs();
  auto found = std::make_shared<PathContacts>();
  found->constraints = arcs.problem().inequalities->count();
  const auto touches = [&](bool at_end) {
    const std::vector<int>& held = at_end ? parts.back().held : parts.front().held;
    const double t = at_end ? path.duration() : 0;
    for (const EndContact& contact : path.end_contacts())
      if (contact.at_end == at_end && !contact.holonomic &&
          !std::ranges::binary_search(held, contact.constraint))
        found->contacts.push_back({contact.constraint, t, t});
  };
  touches(false);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PathArc& arc = parts[i];
    if (i > 0 && path.touched()[i - 1] >= 0)
      found->contacts.push_back({path.touched()[i - 1], arc.from, arc.from});
    found->arcs.push_back({arc.from, arc.to, arc.held, arcs.manifold(arc)});
    for (const int k : arc.held) {
      const auto lasting = std::ranges::find_if(
          found->contacts, [&](const Contact& c) { return c.constraint == k && c.to == arc.from; });
      if (lasting != found->contacts.end())
        lasting->to = arc.to;
      else
        found->contacts.push_back({k, arc.from, arc.to});
    }
  }
  touches(true);
  return found;
}

/// Unknowns, multipliers of integrals and impulses at waypoints; nothing where there are none.
std::shared_ptr<const ExtensionValues> extension_values(const Problem& problem, const Junctions& path) {
  auto values = std::make_shared<ExtensionValues>();
  for (const SolvedArc& arc : path.solved())
    values->waypoints.insert(values->waypoints.end(), arc.waypoints.begin(), arc.waypoints.end());
  const std::vector<double>& constants = path.constants();
  if (values->waypoints.empty() && constants.empty()) return nullptr;
  const Extension& extension = *problem.extension;
  for (int i = 0; i < extension.unknowns(); ++i)
    values->unknowns.emplace_back(extension.names[i], constants[i]);
  values->integral_multipliers = {constants.begin() + extension.unknowns(), constants.end()};
  values->lagrangian = extension.at(constants);
  if (problem.manifold && extension.manifold_at) values->manifold = extension.manifold_at(constants);
  return values;
}

}  // namespace

Solution joined_path(Arcs& arcs, const Junctions& path) {
  const Problem& problem = arcs.problem();
  Solution solution;
  Trajectory& trajectory = solution.trajectory;
  trajectory.coordinates = problem.coordinates();
  trajectory.times = {0};
  for (const SolvedArc& arc : path.solved())
    trajectory.degree = std::max(trajectory.degree, arc.trajectory.degree);
  solution.degree = trajectory.degree;
  solution.residual = path.mismatch();
  solution.unknowns = path.unknowns();
  for (std::size_t i = 0; i < path.arcs().size(); ++i) {
    const PathArc& arc = path.arcs()[i];
    const SolvedArc& solved = path.solved()[i];
    append(solved.trajectory, arc.from, arc.to, trajectory);
    solution.action += solved.action;
    solution.error_estimate = std::max(solution.error_estimate, solved.error);
    solution.residual = std::max(solution.residual, solved.residual);
    solution.unknowns += (solved.degree * solved.trajectory.elements() - 1) * problem.coordinates();
  }
  solution.extension = extension_values(problem, path);
  if (solution.extension)
    for (std::size_t j = 0; j < solution.extension->integral_multipliers.size(); ++j)
      solution.action -= solution.extension->integral_multipliers[j] * problem.extension->integrals[j];
  solution.error_estimate = solution.error_estimate * (1 + path.amplification()) + path.movement();
  for (std::size_t j = 0; j < path.touched().size(); ++j)  // in place of arcs that are shorter
    solution.error_estimate += (path.solved()[j].v_end - path.solved()[j + 1].v_start).norm() *
                               limits::contact::shortest_arc * path.duration();
  solution.momentum_start = {path.solved().front().p_start.begin(), path.solved().front().p_start.end()};
  solution.momentum_end = {path.solved().back().p_end.begin(), path.solved().back().p_end.end()};
  solution.contacts = contacts_of(arcs, path);
  solution.iterations = arcs.iterations();
  if (problem.inequalities->all->autonomous()) observe_energy(arcs.motion(path.constants()), solution);
  solution.minimizing = true;
  solution.status = Status::converged;
  const std::size_t count = solution.contacts->contacts.size();
  solution.message = fmt::format("local minimiser with {} contact{}", count, count == 1 ? "" : "s");
  solution.strategy = "contacts by an interior point method, then arcs that meet without a kink";
  return solution;
}

}  // namespace extremal
