#pragma once

#include <string>
#include <vector>

/// \file What random scenes of each system are drawn from.

namespace bench {

/// Values of a parameter, a coordinate or its velocity, in the system's own units.
struct Span {
  std::string name;
  double low = 0, high = 0;
  bool list = false;  ///< a parameter that is a list of n values
};

/// A random start of a motion lies in the box of the coordinates and velocities. Of a system with a size n,
/// each span of a coordinate stands for an array of n.
struct Recipe {
  std::string system;
  std::vector<Span> parameters;  ///< other than the file's, now and then; logarithmic where low > 0
  std::vector<Span> positions, velocities;
  double time = 1;                     ///< what the motion takes to turn round, roughly
  int least = 0, most = 0;             ///< sizes n; 0: the system has none
  std::vector<std::string> maps = {};  ///< symmetries, as they are written in a boundary
  bool autonomous = true;
  bool forced = false;          ///< by forces that no Lagrangian has
  std::string lagrangian = {};  ///< a formula written in the scene; empty: `system` is a file
  std::string period = {};      ///< of L in t, a formula; empty: it has none
};

/// Systems whose Lagrangian stands in the scene: driven, with kinks, with many extremals.
std::vector<Recipe> written_recipes();

/// Every system of problems/systems, and these.
const std::vector<Recipe>& catalogue();

}  // namespace bench
