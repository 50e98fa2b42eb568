#pragma once

#include "solve/newton/model.hpp"

/// \file Newton steps where the factors have lost their digits.

namespace extremal {

/// Makes a step, which the model solved for, that of the second variation itself: by GMRES on the steps that
/// the model makes of δ²S·x in twice the precision (Carson and Higham, SIAM J. Sci. Comput. 39 (2017) A2834).
/// Where the factors err along few directions it takes few iterations. The action's last gradient, and it
/// stays, must have been evaluated at `path` and extended.
void refine_by_krylov(DiscreteAction& action, QuadraticModel& model, const Path& path,
                      const ClosingEquation* closing, Step& step);

}  // namespace extremal
