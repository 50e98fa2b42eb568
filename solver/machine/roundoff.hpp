#pragma once

namespace extremal {

/// From 1 to the next double.
inline constexpr double machine_epsilon = 0x1p-52;

/// The largest relative error of one operation, which rounds to the nearest double.
inline constexpr double unit_roundoff = machine_epsilon / 2;

}  // namespace extremal
