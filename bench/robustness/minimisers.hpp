#pragma once

#include <vector>

#include "rows.hpp"

namespace bench {

/// Minimisers of the action, and layers, in intervals that motions cannot be followed through: neighbours
/// separate by more than e^30. Straight lines as guesses.
void add_minimisers(std::vector<Row>& rows);

}  // namespace bench
