#pragma once

#include <map>
#include <string>
#include <vector>

/// \file What the [about] of a system file says for pictures.

namespace extremal {

struct Study;

/// A fixed centre of force.
struct Centre {
  std::string name;        ///< may be empty
  std::vector<double> at;  ///< one number for each declared coordinate
};

struct Annotation {
  /// Unit of each axis: of declared coordinates, parameters, "t", "energy", "action".
  std::map<std::string, std::string> units;
  std::vector<Centre> centres;  ///< without those that move with a continued parameter
};

/// Reads `axes` ("x, y: km") and `centres` ("Earth: -mu, 0"; formulas of parameters). Throws SceneError with
/// the place in the system file.
Annotation annotation(const Study& study);

}  // namespace extremal
