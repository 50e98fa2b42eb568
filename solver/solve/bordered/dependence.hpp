#pragma once

#include <string>

#include "solve/bordered/bordered_equations.hpp"

/// \file Integrals and conditions that depend on each other.

namespace extremal {

/// What is wrong with integrals or conditions whose derivatives by the path, at the state that was evaluated
/// last, vanish or are linearly dependent: their multipliers are not determined then, and the second
/// variation on the paths that keep them tells nothing. Newton's method also tends to states of this kind
/// that are no solutions, with multipliers that grow as the conditions come to be met (Fritz John points):
/// there a step for the conditions alone leaves a quarter of what they are missed by, where it leaves next to
/// nothing if their derivatives are independent. The ends that meet them must not be farther than `accuracy`.
/// Empty if nothing is wrong. Evaluates other states.
std::string dependence(BorderedEquations& equations, const BorderedState& state, double accuracy);

}  // namespace extremal
