#pragma once

#include "solve/bordered/bordered_equations.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/state.hpp"

/// \file Minimisation of the action between waypoints.

namespace extremal {

/// Whether all unknowns but the times of waypoints are those of a path on which the action is to be
/// stationary: a path of least action is one then.
bool may_be_minimised(const Problem& problem);

/// Implicit steps (W/τ + δ²S_h) d = −δS_h downhill, as those of GradientFlow, on the elements of the state
/// and with the times of waypoints held; W is the time that a node stands for. 1/τ is as large as a positive
/// definite matrix and the agreement of the fall with that of the quadratic model ask for: in the end the
/// steps are Newton's, also to minima that are soft in some directions. `on_step` is called for each with its
/// size by that of the path. False if there is no minimiser near, as where the action is not bounded from
/// below.
bool minimise(BorderedEquations& equations, BorderedState& state, const Spent& spent,
              const std::function<void(double, double)>& on_step);

}  // namespace extremal
