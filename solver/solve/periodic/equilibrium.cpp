#include "solve/periodic/equilibrium.hpp"

#include "solve/periodic/limits.hpp"

namespace extremal {

using namespace limits::equilibrium;

bool shrank(const Problem& problem, double range, double first_range) {
  // Beside a hyperbolic equilibrium at infinity there are no small orbits.
  const bool autonomous = problem.infinite || problem.lagrangian->structure().autonomous;
  return first_range > 0 && range <= (autonomous ? at_rest : at_driven_rest) * first_range;
}

bool closes_by_smallness(double range, double first_range) {
  return first_range > 0 && range <= at_undamped_rest * first_range;
}

}  // namespace extremal
