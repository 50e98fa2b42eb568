#include "solve/newton/resolve.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solution/solution.hpp"
#include "solve/newton/least_eigenvalue.hpp"
#include "solve/newton/limits.hpp"

namespace extremal {

using namespace limits::resolve;

double largest_change(const Path& path, const Path& finer) {
  const Trajectory there = trajectory_of(finer);
  std::vector<double> q(path.coordinates()), v(q);
  double most = 0;
  for (int k = 0; k <= path.elements(); ++k) {
    there.at(path.mesh()[k] * path.duration(), q, v);
    for (int a = 0; a < path.coordinates(); ++a) most = std::max(most, std::abs(q[a] - path.node(k)[a]));
  }
  return most;
}

std::optional<Stepped> take_step(NewtonIteration& newton, Path& path) {
  if (newton.full_step(path, 0) != StepResult::ok) return std::nullopt;
  const bool contracted = newton.contraction() <= most_change || newton.norm() <= last_step;
  if (!newton.factor(path)) return std::nullopt;
  const std::optional<double> eigenvalue = least_eigenvalue(newton, path);
  return eigenvalue ? std::optional(Stepped{contracted, *eigenvalue}) : std::nullopt;
}

bool same_eigenvalue(double eigenvalue, double next) {
  return std::abs(next - eigenvalue) < most_change * std::abs(next);
}

/// The first steps mend what doubles have made of the path; they need not contract.
std::optional<Resolved> resolve(NewtonIteration& newton, Path& path) {
  newton.double_digits();
  newton.extend();                                            // of the gradient
  newton.extend();                                            // of the factors
  if (!newton.in_twice_the_precision()) return std::nullopt;  // the system has no such factors
  std::optional<double> before;
  for (int k = 0; k < most_steps; ++k) {
    const std::optional<Stepped> next = take_step(newton, path);
    if (!next) return std::nullopt;
    if (next->contracted && before && same_eigenvalue(*before, next->eigenvalue))
      return Resolved{path.degree(), next->eigenvalue, newton.model().inertia(0).negative};
    before = next->eigenvalue;
  }
  return std::nullopt;
}

}  // namespace extremal
