#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "solve/fit/observations.hpp"
#include "system/formula.hpp"

/// \file The observations of a [fit].

namespace extremal {

/// The file that [fit] names: columns of coordinates, velocities and formulas of `observe`, which are
/// numbered as there. Times must be in [0, duration], unless that is infinite. Throws SceneError, in the file
/// with line and column.
Observations read_observations(const FitTable& table, const std::string& scene, const System& system,
                               double duration);

/// A whole turn of an observation whose formula is atan2, or that times a number; 0: it is no angle.
double turn_of(const std::string& formula, const Vocabulary& vocabulary);

}  // namespace extremal
