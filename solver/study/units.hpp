#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "scene/scene.hpp"

/// \file [units]: what lengths and times of a scene are in space.

namespace extremal {

/// An instant of a uniform time.
using Epoch = std::chrono::sys_time<std::chrono::nanoseconds>;

struct Units {
  double length = 1;  ///< km
  double time = 1;    ///< s
  std::string frame, centre;
  Epoch epoch;  ///< of t = 0
};

/// Throws SceneError for what is missing, not positive, not one line of ASCII, or no date from 1700 to 2200.
Units read_units(const UnitsTable& table);

/// Room that a date needs.
inline constexpr std::size_t epoch_size = 30;

/// "2025-01-31T12:00:00.000000000"; returns the end.
char* write_epoch(Epoch epoch, char* to);
std::string epoch_text(Epoch epoch);

}  // namespace extremal
