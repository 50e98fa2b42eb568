#pragma once

#include <optional>
#include <utility>

#include "action/tables.hpp"
#include "solution/solution.hpp"
#include "solve/bordered/state.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/resolution.hpp"

/// \file A state on elements, and how far others are from it.

namespace extremal {

struct Found {
  BorderedState state;
  const ElementTables *tables = nullptr, *own = nullptr;  ///< as Elements has them
  double correction = 0;                                  ///< the last, relative

  Path own_path() const;  ///< without the constants
};

/// The largest differences of q and q' of two paths, the elements of the second parts of those of the first.
std::pair<double, double> differences(const Trajectory& path, const Trajectory& finer);

/// Elements cut where their coefficients, measured last, are larger than they may be of q and of q'.
LegMesh cut(const Found& found, const Resolution& resolution, double aim_q, double aim_v);

/// The elements of one leg as a trajectory of its own, from time 0.
Trajectory leg_of(const Trajectory& whole, const LegMesh& mesh, int leg);

/// Whether the energy of `held`, L with all constants held, drifts along the legs no more than the elements
/// explain.
bool holds_energy(const Lagrangian& held, const LegMesh& mesh, const Trajectory& path,
                  const Resolution::Error& left_out);

/// The polynomials of higher degree that the momenta of `held` at the nodes give; none where these give no
/// velocities. `levels` are of as many coordinates.
std::optional<Path> recovered(const Found& found, const Lagrangian& held, Levels& levels);

}  // namespace extremal
