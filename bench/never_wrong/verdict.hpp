#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "random_scene.hpp"

/// \file What became of one random scene.

namespace bench {

/// A way to be wrong.
struct Fault {
  std::string
      kind;  ///< "exception", "invalid", "false", "error", "estimate", "velocity", "index", "crash", "hang"
  std::string detail;
};

struct Verdict {
  std::uint64_t seed = 0, index = 0;
  RandomScene scene = {};
  std::string status = {};   ///< of the solution; "refused" for a scene that was
  std::string message = {};  ///< of the refusal or the failure
  std::vector<Fault> faults = {};
  double tolerance = 0;  ///< 0 where the elements are pinned
  double residual = 0;
  double seconds = 0;  ///< of processor time: read, solve and analysis
  /// Found against a reference, where there is one.
  std::optional<double> error = {};                    ///< in tolerances
  std::optional<double> estimate_over = {};            ///< error_estimate over the true error
  std::optional<double> velocity = {}, momentum = {};  ///< in what the contract allows
  bool referred = false;                               ///< a reference was found
};

std::string to_line(const Verdict& verdict);  ///< JSON, one line
Verdict from_line(const std::string& line);

}  // namespace bench
