#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "verdict.hpp"

/// \file Scenes solved in processes of their own, so that a crash or a hang is one verdict more.

namespace bench {

struct Campaign {
  std::uint64_t seed = 1, first = 0, scenes = 1000;
  std::vector<std::string> kept;  ///< scene files, instead of random scenes: `first` counts among them
  std::string only;               ///< a system; empty: all
  int jobs = 1;
  int limit = 60;  ///< seconds of processor time for one scene, verification included
};

/// Calls `report` with each verdict, in no particular order. Throws std::runtime_error where processes cannot
/// be started.
void run_campaign(const Campaign& campaign, const std::function<void(const Verdict&)>& report);

}  // namespace bench
