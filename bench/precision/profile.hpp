#pragma once

#include <string>

/// \file Where the time of a solve goes.

namespace bench {

/// Solves a scene and times the pieces of its Newton steps one by one, on the path found, for each number of
/// elements and degree that the solve went through.
void print_profile(const std::string& name, const std::string& scene, double tolerance);

}  // namespace bench
