#pragma once

#include <string>

#include "solve/bordered/bordered_equations.hpp"

/// \file Integrals and conditions that depend on each other.

namespace extremal {

/// What is wrong with integrals or conditions whose derivatives by the path, where the equations were
/// evaluated last, vanish or are linearly dependent: their multipliers are not determined then, and the
/// second variation on the paths that keep them tells nothing. Empty if nothing is.
std::string dependence(const BorderedEquations& equations);

}  // namespace extremal
