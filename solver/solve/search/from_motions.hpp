#pragma once

#include <vector>

#include "solve/search/guess_mesh.hpp"

/// \file Motions from the start, continued to the end that they miss.

namespace extremal {

/// From a motion from the start, which misses the end, through extremals with other ends to those that are
/// `wanted`: the path is nearly one of the problem then, if that is found. Only for ends that are fixed.
Trial move_to_ends(Pursuit& pursuit, const std::vector<double>& wanted, const Guess& motion, double duration);

/// Pursues a motion from the start that nearly meets the end; whether an extremal was found.
bool refine_motion(Pursuit& pursuit, GuessMesh& guess, const Guess& motion, double duration,
                   const char* strategy);
/// The same of a periodic problem, from a motion that does not close.
bool refine_open_motion(Pursuit& pursuit, GuessMesh& guess, const Guess& motion, const char* strategy);

/// A motion satisfies all but the end. As much effort as all paths before, but for the steps that are `kept`:
/// it finds extremals that they miss.
Trial from_motions(Pursuit& pursuit, GuessMesh& guess, int kept);
/// From the motion that forces make of the guess in the course of time.
bool from_settled_motion(Pursuit& pursuit, GuessMesh& guess);

}  // namespace extremal
