#pragma once

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file [guess] as samples of a path.

namespace extremal {

/// The guess that a scene gives: formulas tabulated, a file, or a state integrated; nothing where it gives
/// none. `problem` has its relation, its ends and, unless free, its duration; a free one is set. A coordinate
/// without a formula takes the line between its fixed ends, a constant with one of them, zero with none. In
/// phase space momenta that are not given are those of the velocities, as near as can be.
/// A state is integrated until the deadline. Throws SceneError.
void read_guess(const Scene& scene, const System& system, const Deadline& deadline, Problem& problem);

/// Whether a guess gives momenta p_x of coordinates x. They are used in phase space; elsewhere the motion
/// determines them.
bool names_momenta(const GuessTable& table, const System& system);

/// The path of a file that a scene names: it is looked up beside the scene.
std::string beside(const std::string& scene, const std::string& file);

/// The motion from the state at t = 0 that `values` give ("x" and "x'"; zero where not named), over the
/// problem's duration. Throws SceneError, at `at` where it cannot be integrated that far: until the deadline,
/// in memory there is, and in as many steps as elements can follow.
void integrate_state(const std::vector<Assignment>& values, const System& system, const Location& at,
                     const Deadline& deadline, Problem& problem);

}  // namespace extremal
