#pragma once

#include "scene/scene.hpp"
#include "system/constraints.hpp"
#include "system/formula.hpp"

/// \file [system] as a compiled system.

namespace extremal {

/// Throws SceneError at the place in the scene or system file where a formula is wrong.
System make_system(const SystemTable& table);

/// The same with its constraints, as an expression. Throws SceneError likewise.
ConstrainedGraph make_constrained(const SystemTable& table);

/// An error of a formula of the system, at its place.
SceneError at_its_place(const SystemTable& table, const FormulaError& error);

}  // namespace extremal
