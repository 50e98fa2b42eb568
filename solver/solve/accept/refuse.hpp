#pragma once

#include <string>
#include <utility>

#include "solution/solution.hpp"

namespace extremal {

/// Makes a solution that a check does not pass no result.
inline void refuse(Solution& solution, Status status, std::string message) {
  solution.status = status;
  solution.message = std::move(message);
}

}  // namespace extremal
