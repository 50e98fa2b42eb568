#include "solve/guess/starting_ends.hpp"

#include <algorithm>
#include <cmath>

#include "solve/guess/first_path.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

std::vector<double> starting_ends(const Problem& problem) {
  if (problem.ends.free == 0) return problem.ends.offset;
  const std::size_t n = problem.coordinates();
  std::vector<double> target(2 * n, 0);
  if (problem.guess.given()) {
    problem.guess.at(0, {target.data(), n});
    problem.guess.at(1, {target.data() + n, n});
  } else {
    for (std::size_t a = 0; a < n; ++a) {
      const bool start = problem.ends.fixed[a], end = problem.ends.fixed[n + a];
      if (start && !end) target[n + a] = problem.ends.offset[a];
      if (end && !start) target[a] = problem.ends.offset[n + a];
    }
  }
  return nearest_ends(problem.ends, target);
}

std::vector<double> moved_ends(const Problem& problem, std::vector<double> ends, double size, unsigned seed) {
  double extent = 0;
  for (double x : ends) extent = std::max(extent, std::abs(x));
  Noise noise(seed);
  std::vector<double> free(problem.ends.free);
  for (double& y : free) y = size * (extent > 0 ? extent : 1) * noise();
  for (const Triplet& z : problem.ends.z) ends[z.row] += z.value * free[z.column];
  return ends;
}

}  // namespace extremal
