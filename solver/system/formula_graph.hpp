#pragma once

#include <span>
#include <string>

#include "system/formula_names.hpp"
#include "system/tape.hpp"

/// \file A Lagrangian or Hamiltonian that is written as a formula, as terms over a graph.

namespace extremal::formula {

/// Sums that are summands of L, up to factors, become kernels with one row an index combination (nested
/// sums are flattened, factors move inside); the rest of L is one plain term, which comes first. Sums
/// elsewhere are written out. Throws FormulaError.
/// `where` names the text in errors. Of a Hamiltonian the velocity inputs are momenta.
LagrangianGraph graph_of(Names& names, const std::string& text, const std::string& where);

/// Σ F_a λ_a over the forces, likewise. λ stand as coordinates n … 2n − 1 beside the n of `names`. Throws
/// FormulaError.
LagrangianGraph power_of(Names& names, std::span<const ForceText> forces);

/// left − right of an equation "left = right" in coordinates, t and parameters, likewise. Throws
/// FormulaError, also where velocities or no coordinates stand in it.
LagrangianGraph equation_of(Names& names, const std::string& text, const std::string& where);

}  // namespace extremal::formula
