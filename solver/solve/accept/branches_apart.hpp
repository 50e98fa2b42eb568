#pragma once

#include <string>

#include "problem/problem.hpp"

/// \file Ends that constraints keep apart.

namespace extremal {

/// Where constraints leave a curve, and the part of it on which the start lies does not lead to the end: says
/// so. Empty where it does, or where that is not known.
std::string branches_apart(const Problem& problem);

}  // namespace extremal
