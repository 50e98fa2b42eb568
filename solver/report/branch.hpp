#pragma once

#include <iosfwd>
#include <string>

#include "study/continued.hpp"

/// \file A branch of extremals as JSON, as a table, as CSV and as a picture.

namespace extremal {

/// {"status", "message", "points": [{"parameter", "duration", "energy", "action", "morse_index",
/// "multipliers", "kind", "start"}]}; what is not known of a point is null.
void write_json(std::ostream& out, const FollowedBranch& branch);
/// The same into a file. Throws std::runtime_error with the path if it cannot be written.
void write_json(const std::string& path, const FollowedBranch& branch);

/// A line for each point: parameter, duration, energy, action, morse_index, kind, then coordinates and
/// velocities at the start. Cells that are not known stay empty.
void write_csv(std::ostream& out, const FollowedBranch& branch);
void write_csv(const std::string& path, const FollowedBranch& branch);

/// A table of the points, why the branch ended, and how well the derivatives of the action are met.
std::string summary(const FollowedBranch& branch);

/// What varies against the action, or, where the energy varies, the duration; folds and crossings are marked.
/// Throws as write_plot of a trajectory does, and std::invalid_argument without points.
void write_plot(const std::string& path, const FollowedBranch& branch);

}  // namespace extremal
