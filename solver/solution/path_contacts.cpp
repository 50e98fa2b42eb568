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
  const std::vector<double> held = arc.manifold->multipliers(q, t, v);
  // What is negative within roundoff is zero: greater values have been refused.
  for (std::size_t i = 0; i < held.size(); ++i) forces[arc.held[i]] = std::max(0.0, -held[i]);
  return forces;
}

}  // namespace extremal
