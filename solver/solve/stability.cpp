#include "solve/stability.hpp"

#include <fmt/format.h>

#include "solve/doubled.hpp"

namespace extremal {

ClosedOrbit closed_orbit(const Problem& problem, double relative_error) {
  ClosingMap map = closing_map(problem);
  return {.map = map.r.isIdentity(0) ? Eigen::MatrixXd{} : std::move(map.r),
          .relative_error = relative_error,
          .autonomous = problem.lagrangian->structure().autonomous};
}

void read_stability(const Problem& problem, const SecondVariation& variation, double size,
                    Solution& solution) {
  if (!problem.periodic) return;
  if (problem.coordinates() > most_coordinates_for_multipliers) {
    solution.message += fmt::format("; multipliers are only found for up to {} coordinates",
                                    most_coordinates_for_multipliers);
  } else if (variation.count() == 0) {
    solution.message += "; nor are multipliers found";
  } else {
    const double error = size > 0 ? solution.error_estimate / size : 0;
    solution.floquet = floquet(variation, closed_orbit(problem, error));
    if (!solution.floquet) solution.message += "; multipliers are too large for numbers";
  }
}

}  // namespace extremal
