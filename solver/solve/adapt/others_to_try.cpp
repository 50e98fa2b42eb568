#include "solve/adapt/others_to_try.hpp"

#include <fmt/format.h>

namespace extremal {

std::string others_to_try(const Problem& problem, std::string_view guess, std::string_view duration) {
  // The period of a drive is none to choose.
  if (problem.infinite || (problem.periodic && !problem.lagrangian->structure().autonomous))
    return std::string(guess);
  if (!problem.duration.free) return fmt::format("{} or {}", guess, duration);
  // Two copies close their duration by an energy that is no number of the problem.
  if (!problem.duration.energy || problem.paired)
    return fmt::format("{} or another guess of the duration", guess);
  return fmt::format("{}, another guess of the duration or another energy", guess);
}

}  // namespace extremal
