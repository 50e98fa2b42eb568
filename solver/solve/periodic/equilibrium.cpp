#include "solve/periodic/equilibrium.hpp"

#include "solve/periodic/limits.hpp"

namespace extremal {

using namespace limits::equilibrium;

bool shrank(const Problem& problem, double range, double first_range) {
  // Beside a hyperbolic equilibrium at infinity there are no small orbits.
  const bool autonomous = problem.infinite || problem.lagrangian->structure().autonomous;
  const double smallest = !autonomous ? at_driven_rest : problem.paired ? at_forced_rest : at_rest;
  return first_range > 0 && range <= smallest * first_range;
}

}  // namespace extremal
