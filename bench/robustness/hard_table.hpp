#pragma once

#include <string>
#include <vector>

namespace bench {

/// Solves the problems whose titles hold one of `parts` (all where there are none), and prints a table:
/// whether each was found, the time, the verified error, and the same of scipy.integrate.solve_bvp from the
/// same guess. Whether everything was found and withstood.
bool run_hard(const std::string& python, const std::vector<std::string>& parts);

}  // namespace bench
