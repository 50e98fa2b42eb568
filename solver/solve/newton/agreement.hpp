#pragma once

#include "solve/newton/model.hpp"

/// \file Steps of two copies of the coordinates.

namespace extremal {

/// Moves both copies by the mean of what a step moves them by. The exact step moves both alike; its roundoff
/// along the adjoint fields grows as the equations become singular.
void make_agree(Step& step, int coordinates);

}  // namespace extremal
