#pragma once

#include "solve/newton/model.hpp"

/// \file Steps of two copies of the coordinates.

namespace extremal {

/// Moves both copies by the mean of what a step of a problem of two copies moves them by. The exact step moves
/// both alike; along the adjoint fields its roundoff has as little against it as the equations are singular.
void make_agree(Step& step, int coordinates);

}  // namespace extremal
