#pragma once

#include <string>
#include <string_view>

#include "problem/problem.hpp"

/// \file What may lead to an extremal where none was found.

namespace extremal {

/// "a better guess or a shorter duration": this guess, and of the numbers that the problem has others; a
/// duration that is given becomes `duration`.
std::string others_to_try(const Problem& problem, std::string_view guess, std::string_view duration);

}  // namespace extremal
