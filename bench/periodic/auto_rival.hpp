#pragma once

#include <optional>
#include <string>
#include <vector>

#include "auto_program.hpp"

/// \file AUTO-07p with the setting that is best in hindsight.

namespace bench {

/// How it reached an error.
struct AutoResult {
  AutoSetting setting;
  int solves = 0;
  int repeats = 1;
  double seconds = 0;   ///< median
  double distance = 0;  ///< as distance_from_orbit
};

struct AutoRival {
  std::string absence;                             ///< why there are no results
  std::vector<std::optional<AutoResult>> results;  ///< one an error; none: no setting reaches it
};

/// The fastest that comes at least as near to the first state of the CSV, for each of `errors`. Where no
/// equations are written for `scene`, or AUTO-07p is not installed, `absence` says so.
AutoRival measure_auto(const AutoInstallation& installation, const std::string& scene,
                       const extremal::Study& study, const std::string& csv,
                       const std::vector<double>& errors);

}  // namespace bench
