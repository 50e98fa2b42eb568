#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "analysis/jacobi.hpp"

/// \file Where a trajectory is minimising: the times conjugate to its start, and windows.

namespace extremal {

/// Both follow from the second variation with fixed ends along the trajectory as it is returned.
struct Minimality {
  /// In (0, T), ascending, each as often as its multiplicity; nothing if they are too many to be found.
  std::optional<std::vector<double>> conjugate_times;
  std::vector<std::array<double, 2>> windows;  ///< from and to; abutting, from 0 to T
  /// From T to the nearest conjugate time, about; infinite where none is near or they were not found.
  double distance = std::numeric_limits<double>::infinity();
  /// Whether no window needed to be shorter than `longest` (see below).
  bool within_longest = true;
};

/// Windows are the longest there are from the left, less one part in a million: in each the second variation
/// is positive definite, and in the union of two neighbours it is not. `longest`: windows are also shorter
/// than this, and the union of two neighbours is not. Conjugate times of many
/// coordinates are given up where they are so many that they would take too long.
Minimality minimality(SecondVariation& variation, double longest = std::numeric_limits<double>::infinity());

}  // namespace extremal
