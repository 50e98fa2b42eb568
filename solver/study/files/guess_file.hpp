#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

/// \file Files of other programs, and of this one, as guesses.

namespace extremal {

/// A path, or the state from which a motion begins.
struct GuessFile {
  std::vector<double> t;           ///< increasing; empty where the file gives a state
  std::vector<double> q;           ///< row by row: q[k*n + a]
  std::vector<double> start_q;     ///< q(0); empty where the file gives a path
  std::vector<double> start_v;     ///< q'(0)
  std::optional<double> duration;  ///< where the file tells it
};

/// Reads what the file is, by its ending and by its content:
/// - a result in JSON with samples; CSV with a column t and one for each coordinate; NumPy's .npz with such
///   arrays: a path;
/// - JSON or CSV of JPL's catalogue of periodic orbits, and other CSV without t and with velocities: rows
/// with
///   initial states;
/// - AUTO's fort.8 (also called s.NAME), whose first variables are the coordinates in their order: a path;
/// - NumPy's .npy of real numbers of the shape (bodies, dimension, samples) over a period, as choreo writes
/// with
///   a .json beside it: a path of the arrays of coordinates, one for each dimension.
/// `orbit` is the row, from 1, of several orbits, or AUTO's label. Throws SceneError, with line and column in
/// a text.
GuessFile read_guess_file(const std::string& path, const std::vector<std::string>& names,
                          const std::optional<Number>& orbit);

}  // namespace extremal
