#pragma once

#include <span>
#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"

/// \file The phase of a periodic orbit: where on it time begins.

namespace extremal {

/// Directions along which the action of a closed path does not change, at the mesh nodes, each (N + 1) × n:
/// δq = q' for a shift of time, times the length of the time around each node. A bordered system takes no
/// step along them, and allows a force along them in return: elements prefer a phase by as much as they err,
/// so that force vanishes with their error.
struct PhaseConditions {
  int count = 0;
  std::vector<double> directions;

  void add(std::span<const double> direction) {
    directions.insert(directions.end(), direction.begin(), direction.end());
    ++count;
  }
  std::span<const double> direction(int j) const {
    const std::size_t size = directions.size() / count;
    return {directions.data() + j * size, size};
  }
};

/// The direction of a step of the nodes, (N + 1) × n: its values times the times around them.
std::vector<double> direction_of(std::vector<double> nodes, const Path& path);

/// Those of `problem` at `path`, with or without the shift of time; none unless it is periodic, or goes from
/// equilibrium to equilibrium.
void measure_phases(const Problem& problem, const Path& path, const SchemeTables& scheme, bool with_time,
                    PhaseConditions& phases);

/// The shift of time alone, added to `direction`, (N + 1) × n: half of q'·h of every element to each of its
/// ends.
void add_shift_of_time(const Path& path, const SchemeTables& scheme, double* direction);

/// As many of them as are independent, orthonormal.
PhaseConditions independent(const PhaseConditions& phases);

}  // namespace extremal
