#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

/// \file What a problem with an extension (problem/extension.hpp) was solved for beside its path.

namespace extremal {

class Lagrangian;
class Manifold;

/// Time of a waypoint and, of its fixed coordinates, the momentum after it less that before.
struct WaypointImpulse {
  double time = 0;
  std::vector<std::pair<int, double>> impulse;  ///< coordinate, jump
};

struct ExtensionValues {
  std::vector<std::pair<std::string, double>> unknowns;  ///< k
  std::vector<double> integral_multipliers;              ///< ν of L + Σ ν g
  std::vector<WaypointImpulse> waypoints;
  std::shared_ptr<const Lagrangian> lagrangian;  ///< L + Σ ν g at these values
  std::shared_ptr<const Manifold> manifold{};    ///< of constraints, at these values; null: there are none

  std::vector<double> constants() const {  ///< k, ν
    std::vector<double> all;
    for (const auto& [name, value] : unknowns) all.push_back(value);
    all.insert(all.end(), integral_multipliers.begin(), integral_multipliers.end());
    return all;
  }
};

}  // namespace extremal
