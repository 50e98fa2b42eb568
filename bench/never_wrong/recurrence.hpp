#pragma once

#include <vector>

#include "study/study.hpp"
#include "verdict.hpp"

/// \file Whether a closed path goes on as it began.

namespace bench {

/// What an integration over two durations finds wrong with a periodic orbit, run through a second time where
/// its map puts it; nothing for other paths.
std::vector<Fault> deny_recurrence(const extremal::Study& study, const extremal::Solution& solution);

}  // namespace bench
