#pragma once

#include <functional>

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "study/study.hpp"

/// \file duration = "infinite" in [boundary].

namespace extremal {

/// The ends at infinity of a problem that has the relation of its scene; its duration becomes that of the
/// default guess. Throws SceneError where no end is at a hyperbolic equilibrium, and for a comparison.
InfiniteEnds read_infinite_ends(const Scene& scene, Purpose purpose, Problem& problem);

/// Where the scene gives no 'guess.duration', doubles the part of the time axis that the guess describes as
/// long as its ends come nearer to their equilibria, and are not there; `put_guess` puts it into the problem.
void reach_equilibria(const Scene& scene, const InfiniteEnds& infinite,
                      const std::function<void(Problem& problem)>& put_guess, Problem& problem);

/// Leaves these ends free, once the guess has been read, or gives the default guess. Throws SceneError where
/// that is the equilibrium itself.
void leave_infinite_ends(const Scene& scene, InfiniteEnds infinite, Problem& problem);

}  // namespace extremal
