#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hard_problems.hpp"

namespace bench {

/// A run of scipy.integrate.solve_bvp.
struct PeerRun {
  std::string failure = "not run";  ///< empty where it converged
  double seconds = 0;
  double action = 0;  ///< of its path
};

/// One run for each problem, by robustness/hard_peer.py; none for problems that have no counterpart. Where no
/// problem can be run, `absence` becomes the reason.
std::vector<std::optional<PeerRun>> run_peer(const std::string& python,
                                             const std::vector<HardProblem>& problems, std::string& absence);

}  // namespace bench
