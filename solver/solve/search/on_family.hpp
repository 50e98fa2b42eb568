#pragma once

#include "solve/search/continuum.hpp"
#include "solve/search/guess_mesh.hpp"

/// \file From a path to the nearest of a family of extremals.

namespace extremal {

/// Where the second variation is singular: the path becomes the member nearest to the guess, if there is a
/// family. The path may be `resolved` by its elements, as it is an extremal. `steps_left` are counted down;
/// unless a member is found the outcome is as before.
FamilySearch reach_nearest_member(Pursuit& pursuit, const GuessMesh& guess, bool resolved, int& steps_left);

/// The path that was accepted may be one of a family, and another member nearer to the guess: the path
/// becomes that.
void come_nearest_to_guess(Pursuit& pursuit, const GuessMesh& guess);

/// Whether steps from the path leave open more than a shift in time. The eigenvalues of such a path on a part
/// of the time axis are roundoff, of either sign.
bool leaves_open(Pursuit& pursuit);

}  // namespace extremal
