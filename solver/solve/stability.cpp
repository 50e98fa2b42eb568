#include "solve/stability.hpp"

#include <fmt/format.h>

#include "analysis/multipliers.hpp"

namespace extremal {

namespace {

/// R of q(T) = R q(0) + c; empty for the identity.
Eigen::MatrixXd closing_map(const Problem& problem) {
  const int n = problem.coordinates();
  Eigen::MatrixXd start = Eigen::MatrixXd::Zero(n, n), end = start;
  for (const Triplet& entry : problem.boundary.matrix)
    (entry.column < n ? start : end)(entry.row, entry.column % n) += entry.value;
  if (end.isIdentity(0) && (-start).isIdentity(0)) return {};
  return -end.partialPivLu().solve(start);
}

}  // namespace

void read_stability(const Problem& problem, const SecondVariation& variation, double size,
                    Solution& solution) {
  if (!problem.periodic) return;
  if (problem.coordinates() > most_coordinates_for_multipliers) {
    solution.message += fmt::format("; multipliers are only found for up to {} coordinates",
                                    most_coordinates_for_multipliers);
  } else if (solution.windows.empty()) {
    solution.message += "; nor are multipliers found";
  } else {
    const ClosedOrbit orbit{.map = closing_map(problem),
                            .relative_error = size > 0 ? solution.error_estimate / size : 0,
                            .autonomous = problem.lagrangian->structure().autonomous};
    solution.floquet = floquet(variation, orbit);
    if (!solution.floquet) solution.message += "; multipliers are too large for numbers";
  }
}

}  // namespace extremal
