#pragma once

#include "records.hpp"
#include "reference.hpp"
#include "study/study.hpp"

/// \file A scene solved, and its error measured.

namespace bench {

/// Solves at this tolerance, all else as the study says, as often as `budget` seconds allow.
Cell measure(extremal::Study study, double tolerance, const Reference& reference, double budget);

/// Single and multiple shooting on the same problem from the same guess, at one tolerance a decade and with
/// several numbers of segments; why, where that would take too long.
void measure_shooting(const extremal::Problem& problem, const Reference& reference, double budget,
                      SceneRecord& record);

}  // namespace bench
