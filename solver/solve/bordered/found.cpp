#include "solve/bordered/found.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "action/discrete_action.hpp"
#include "action/recovery.hpp"
#include "action/rule.hpp"
#include "solution/observe.hpp"
#include "solve/adapt/workspace.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/mesh/conservation.hpp"

namespace extremal {

Path Found::own_path() const {
  Path path;
  without_constants(state.path, *own, path);
  return path;
}

std::pair<double, double> differences(const Trajectory& path, const Trajectory& finer) {
  const int n = path.coordinates, ratio = finer.elements() / path.elements();
  std::vector<double> q(n), v(n), other_q(n), other_v(n);
  double most_q = 0, most_v = 0;
  for (int k = 0; k < finer.elements(); ++k)
    for (const double tau : lobatto_barycentric(finer.degree).nodes) {
      path.in_element(k / ratio, (k % ratio + tau) / ratio, q, v);
      finer.in_element(k, tau, other_q, other_v);
      for (int i = 0; i < n; ++i) {
        most_q = std::max(most_q, std::abs(q[i] - other_q[i]));
        most_v = std::max(most_v, std::abs(v[i] - other_v[i]));
      }
    }
  return {most_q, most_v};
}

LegMesh cut(const Found& found, const Resolution& resolution, double aim_q, double aim_v) {
  const LegMesh& old = found.state.mesh;
  const int degree = found.state.path.degree();
  LegMesh mesh;
  mesh.first.push_back(0);
  for (int l = 0; l < old.legs(); ++l) {
    for (int k = old.first[l]; k < old.first[l + 1]; ++k) {
      const Resolution::Tail& tail = resolution.tails()[k];
      const double left = tail.size * tail.fall / (1 - std::min(tail.fall, 0.9));
      const double of_v = left * (degree + 1) * (degree + 2) / tail.h;
      const double excess = std::max(left / aim_q, of_v / aim_v);
      const int count =
          std::clamp(static_cast<int>(std::ceil(std::pow(std::max(excess, 0.0), 1.0 / (degree + 1)))), 1,
                     limits::bordered::strongest_cut);
      for (int i = 0; i < count; ++i) mesh.parts.push_back(old.parts[k] / count);
    }
    mesh.first.push_back(static_cast<int>(mesh.parts.size()));
  }
  return mesh;
}

Trajectory leg_of(const Trajectory& whole, const LegMesh& mesh, int leg) {
  const int first = mesh.first[leg], last = mesh.first[leg + 1];
  Trajectory part;
  part.coordinates = whole.coordinates;
  part.degree = whole.degree;
  for (int k = first; k <= last; ++k) part.times.push_back(whole.times[k] - whole.times[first]);
  const auto size = static_cast<std::ptrdiff_t>(whole.degree + 1) * whole.coordinates;
  part.nodes.assign(whole.nodes.begin() + first * size, whole.nodes.begin() + last * size);
  part.slopes.assign(whole.slopes.begin() + first * size, whole.slopes.begin() + last * size);
  part.lengths.assign(whole.lengths.begin() + first, whole.lengths.begin() + last);
  return part;
}

bool holds_energy(const Lagrangian& held, const LegMesh& mesh, const Trajectory& path,
                  const Resolution::Error& left_out) {
  if (!held.structure().autonomous) return true;
  for (int l = 0; l < mesh.legs(); ++l) {
    const Trajectory leg = leg_of(path, mesh, l);
    const Survey drift = survey(held, leg);
    if (!drift.finite || !conserves_energy(drift, leg, left_out)) return false;
  }
  return true;
}

std::optional<Path> recovered(const Found& found, const Lagrangian& held, Levels& levels) {
  const Path path = found.own_path();
  ElementTables tables;
  tables.bind(found.own->scheme(), held);
  DiscreteAction action;
  action.reset(held, tables, path.elements(), false, Condense::nothing);
  Recovery recovery;
  std::optional<Path> raised(std::in_place);
  if (!recover(held, action, path, recovery, levels, *raised)) raised.reset();
  return raised;
}

}  // namespace extremal
