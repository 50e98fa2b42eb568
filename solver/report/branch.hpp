#pragma once

#include <iosfwd>
#include <string>

#include "study/annotation.hpp"
#include "study/continued.hpp"
#include "study/quantity.hpp"

/// \file A branch of extremals as JSON, as a table, as CSV and as a picture.

namespace extremal {

/// {"status", "message", "branches": [{"origin", "status", "message", "points", "action_defect",
/// "momentum_defect"}], "points": [{"branch", "parameter", "duration", "energy", "action", "morse_index",
/// "nullity", "multipliers", "krein", "kind", "start"}]}; what is not known of a point is null. Status and
/// message are those of the branch that was asked for, number 0; "origin" is the number of the point, counted
/// from 0, that another one begins next to.
///
/// With samples each point has "samples": {"t", coordinates, velocities} at equal steps' ends, from which the
/// page of the file draws its orbit, and "about" has what the system's [about] says for pictures.
struct SavedOrbits {
  int samples = 0;  ///< of each orbit, both ends included; 0: none
  Annotation annotation = {};
};
void write_json(std::ostream& out, const FollowedBranch& branch, const SavedOrbits& orbits = {});

/// A line for each point: branch, parameter, duration, energy, action, morse_index, nullity, kind, then
/// coordinates and velocities at the start; for periodic orbits real and imaginary parts of the multipliers.
/// Cells that are not known stay empty.
void write_csv(std::ostream& out, const FollowedBranch& branch);

/// A table of the points, why each branch ended, and how well the derivatives of the action are met.
std::string summary(const FollowedBranch& branch);

/// What a picture of a branch shows.
struct BranchPicture {
  const FollowedBranch& branch;
  BranchQuantity quantity;  ///< drawn upwards, over the number that varies
  Annotation annotation = {};
};

/// A bifurcation diagram: periodic orbits coloured by their stability, others by whether their index is zero,
/// with folds, crossings and period doublings marked. Between the points that were found, which are dots, the
/// curve is interpolated. Beside it some solutions of each branch, coloured by the number that varies: paths
/// in the plane or in space, else the coordinate that moves most against time. Throws as plot_image of a
/// trajectory does, and std::invalid_argument without points.
std::string plot_image(const std::string& path, const BranchPicture& picture);

}  // namespace extremal
