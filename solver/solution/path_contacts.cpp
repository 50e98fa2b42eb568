#include "solution/path_contacts.hpp"

#include <algorithm>

#include "problem/manifold.hpp"

namespace extremal {

const PathContacts::Arc& PathContacts::at(double t) const {
  const auto later = std::ranges::upper_bound(arcs, t, {}, &Arc::from);
  return later == arcs.begin() ? arcs.front() : *(later - 1);
}

std::vector<double> PathContacts::forces(std::span<const double> q, std::span<const double> v,
                                         double t) const {
  std::vector<double> forces(constraints);
  const Arc& arc = at(t);
  if (arc.held.empty()) return forces;
  const std::vector<double> all = arc.manifold->multipliers(q, t, v);
  const std::size_t constraints = all.size() - arc.held.size();  // come first
  // What is negative within roundoff is zero: greater values have been refused.
  for (std::size_t i = 0; i < arc.held.size(); ++i)
    forces[arc.held[i]] = std::max(0.0, -all[constraints + i]);
  return forces;
}

std::vector<double> PathContacts::constraint_forces(std::span<const double> q, std::span<const double> v,
                                                    double t) const {
  const Arc& arc = at(t);
  if (arc.held.empty()) return {};
  std::vector<double> all = arc.manifold->multipliers(q, t, v);
  all.resize(all.size() - arc.held.size());
  return all;
}

}  // namespace extremal
