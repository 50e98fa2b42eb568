#pragma once

#include <optional>
#include <vector>

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file [boundary] as a relation between the ends and a duration.

namespace extremal {

/// The relation, and where in the scene each of its rows is written.
struct PlacedRelation {
  BoundaryRelation relation;
  std::vector<Location> rows;
  std::vector<char> momentum_given;    ///< 2n: the momentum of the end is given, zero or not; or empty
  std::optional<InitialData> initial;  ///< the relation fixes q(0) then
};

/// q(T) = R q(0) + c: one affine form of q(0) for each coordinate.
using Closure = std::vector<AffineForm>;

/// Whether the map says what becomes of momenta, or takes them to coordinates.
bool maps_momenta(const BoundaryTable& boundary, const System& system);

/// The map of a periodic orbit; what it leaves out is unchanged.
Closure read_closure(const BoundaryTable& boundary, const System& system);

/// Initial data, fixed ends, conditions, or the closure of a periodic orbit. Throws SceneError.
PlacedRelation read_relation(const BoundaryTable& boundary, const System& system);

/// The relation into a problem, solved. Throws SceneError where conditions depend on each other.
void set_relation(const BoundaryTable& boundary, const System& system, Problem& problem);

/// Without the guess of a free duration: its value is then 0. So it is where ends are at infinity.
Duration read_duration(const BoundaryTable& boundary, const System& system);

}  // namespace extremal
