#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "study/model/naming.hpp"
#include "system/constraints.hpp"
#include "system/formula.hpp"

/// \file [system] as a compiled system.

namespace extremal {

/// The texts of a system, with the values of its parameters. Throws FormulaError.
SystemText system_text(const SystemTable& table);

/// The second derivative of a Hamiltonian by the momenta is singular.
struct NoLegendreTransform : SceneError {
  using SceneError::SceneError;
};

/// Throws SceneError at the place in the scene or system file where a formula is wrong. `active`: parameters
/// that stay symbolic, for derivatives or to be replaced. A Hamiltonian may have no Legendre transform.
System make_system(const SystemTable& table, const std::vector<std::string>& active = {},
                   Formulation formulation = Formulation::legendre, bool replaceable = false);

/// The Lagrangian of two copies of a system with forces, of which the last coordinates are constants. Throws
/// SceneError likewise.
std::shared_ptr<const Lagrangian> make_copies(const SystemTable& table, int constants);

/// The same with its constraints, as expressions; without its forces. Throws SceneError likewise.
ConstrainedGraph make_constrained(const SystemTable& table);
/// With its forces too; `system` has its names. `active` as make_system().
ConstrainedGraph make_constrained(const SystemTable& table, const System& system,
                                  const std::vector<std::string>& active = {});

/// An error of a formula of the system, at its place.
FaultyFormula at_its_place(const SystemTable& table, const FormulaError& error);

}  // namespace extremal
