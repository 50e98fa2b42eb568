#pragma once

#include "records.hpp"
#include "reference.hpp"
#include "study/study.hpp"

/// \file Shooting coded by hand for one system, on the problem of a scene.

namespace bench {

/// Single and multiple shooting (shooting/) from the guess of the scene, at many settings; why not, where no
/// equations are written for it.
void measure_by_hand(const extremal::Study& study, const Reference& reference, double budget,
                     SceneRecord& record);

}  // namespace bench
