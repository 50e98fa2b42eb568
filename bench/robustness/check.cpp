#include "check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rivals/verify.hpp"

namespace bench {

namespace {

/// What is doubtful is looked at again with an integrator so much more precise.
constexpr double more_precise = 1e-3;

}  // namespace

std::string disproof(const extremal::Problem& problem, const extremal::Solution& solution, double tolerance) {
  const auto verify = [&](double precision) {
    return extremal::verify(problem, solution.trajectory,
                            {.tolerance = precision * tolerance, .margin = 10 / precision});
  };
  extremal::Verification v = verify(1);
  const double range = range_of(solution.trajectory);
  const auto error = [&](double precision) { return v.distance.value_or(0) * precision * tolerance * range; };
  if (v.verified && solution.error_estimate >= 0.01 * error(1)) return {};
  v = verify(more_precise);
  if (!v.verified) return v.message;
  if (solution.error_estimate >= 0.01 * error(more_precise)) return {};
  return fmt::format("error estimate {:.1e}, distance from the extremal {:.1e}", solution.error_estimate,
                     error(more_precise));
}

double range_of(const extremal::Trajectory& trajectory) {
  const int n = trajectory.coordinates;
  double range = 0;
  for (int a = 0; a < n; ++a) {
    double low = trajectory.nodes[a], high = low;
    for (std::size_t k = a; k < trajectory.nodes.size(); k += n) {
      low = std::min(low, trajectory.nodes[k]);
      high = std::max(high, trajectory.nodes[k]);
    }
    range = std::max(range, high - low);
  }
  return range;
}

}  // namespace bench
