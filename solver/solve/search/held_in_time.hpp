#pragma once

#include <functional>
#include <vector>

#include "solve/search/pursuit.hpp"

/// \file Paths between rests whose ends hardly hold them in time.

namespace extremal {

/// A path between equilibria that its ends hardly hold in time: converged across its shifts first, then
/// shifted to where the action of all rests is least, and tried without or, where roundoff hides their
/// energy, with its shifts held. `renew` gives each attempt its effort. Whether an extremal was found.
bool hold_in_time(Pursuit& pursuit, const std::vector<double>& ends, const char* strategy,
                  const std::function<void()>& renew);

}  // namespace extremal
