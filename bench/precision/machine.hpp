#pragma once

#include <string>

/// \file Where figures come from.

namespace bench {

struct Machine {
  std::string processor;  ///< its model, as the kernel names it
  int cores = 0;
  std::string compiler, simd;
  double load = 0;  ///< processes that want to run, mean of the last minute; other programs disturb above 1
};

Machine this_machine();

}  // namespace bench
