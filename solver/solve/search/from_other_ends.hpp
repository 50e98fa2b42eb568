#pragma once

#include "solve/search/guess_mesh.hpp"

/// \file From ends that are nearer to each other to those wanted.

namespace extremal {

/// Each time by so much of the way that is left that Newton's method still comes along: near a singularity,
/// or where a layer becomes thinner, that is an equal part of the way, not an equal length.
Trial through_other_ends(Pursuit& pursuit, const std::vector<double>& ends);

}  // namespace extremal
