#pragma once

#include "solve/search/guess_mesh.hpp"

/// \file Newton's method from the guess alone.

namespace extremal {

/// To the extremal near the guess, which nothing judges; a path far from the guess is a failure.
const Outcome& pursue_near_guess(Pursuit& pursuit, GuessMesh& guess);

}  // namespace extremal
