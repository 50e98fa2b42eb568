#pragma once

#include <optional>
#include <vector>

#include "reference.hpp"
#include "verdict.hpp"

/// \file A trajectory against its own equations of motion, integrated by another method.

namespace bench {

/// What an integration finds wrong, by ten times what the tolerance allows. `reference` excuses a distance
/// that its own error does not confirm. Nothing where only the roundoff of the values q shows: in q' it is
/// amplified by degree²/h.
std::vector<Fault> refute(const extremal::Study& study, const extremal::Solution& solution,
                          const std::optional<TrueError>& reference);

/// Error that the roundoff of q leaves in q'.
double velocity_roundoff(const extremal::Trajectory& trajectory);

}  // namespace bench
