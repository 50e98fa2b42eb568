#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "report/result.hpp"
#include "study/units.hpp"

/// \file Trajectories in space as Orbit Ephemeris Messages: CCSDS 502.0-B-2, section 5.

namespace extremal {

/// Throws std::invalid_argument, with what to do, unless the coordinates are positions x, y (and z) of
/// bodies.
void check_oem(const std::vector<std::string>& names);

/// One segment for each body: km and km/s, z = 0 in a plane, times in TDB. The date of creation is that of t
/// = 0, so that equal results are equal files. Throws as check_oem(), and where dates leave 1677 to 2262 or
/// numbers are out of range.
void write_oem(std::ostream& out, const Units& units, const std::string& title,
               const std::vector<std::string>& names, const Samples& samples);

}  // namespace extremal
