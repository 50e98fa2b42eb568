#pragma once

#include <string>

/// \file The same measurements at each SIMD level of this processor.

namespace bench {

/// Runs `command`, this program with options, once for each level in a process of its own, and prints times
/// and ratios side by side. All records go into the file `json` unless that is empty. Throws
/// std::runtime_error where a process fails.
void compare_levels(const std::string& command, const std::string& json);

}  // namespace bench
