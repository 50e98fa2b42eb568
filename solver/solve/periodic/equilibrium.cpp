#include "solve/periodic/equilibrium.hpp"

#include "solve/periodic/limits.hpp"

namespace extremal {

using namespace limits::equilibrium;

bool shrank(const Problem& problem, double range, double first_range) {
  const bool autonomous = problem.lagrangian->structure().autonomous;
  return first_range > 0 && range <= (autonomous ? at_rest : at_driven_rest) * first_range;
}

}  // namespace extremal
