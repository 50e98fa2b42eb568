#include "solve/newton/residual_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "machine/largest.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/limits.hpp"

namespace extremal {

using namespace limits::residual_test;

namespace {

/// Largest |q| of each coordinate.
std::vector<double> magnitudes(const Path& path) {
  const std::size_t n = path.coordinates();
  std::vector<double> largest(n, 0);
  for (std::size_t i = 0; i < path.nodes().size(); ++i)
    largest[i % n] = std::max(largest[i % n], std::abs(path.nodes()[i]));
  return largest;
}

}  // namespace

double largest_coordinate(const Path& path) { return largest(path.nodes()); }

double natural_residual(const Problem& problem, const DiscreteAction& action, const Path& path,
                        double displacement) {
  const int n = path.coordinates();
  const std::vector<double> q = magnitudes(path);
  std::vector<double> left(problem.ends.free, 0), rounding(problem.ends.free, 0);
  for (const Triplet& z : problem.ends.z) {
    const bool start = z.row < n;
    const int a = start ? z.row : z.row - n;
    left[z.column] += z.value * action.imbalance(z.row);
    const NodeEquations& nodes = action.nodes;
    if (nodes.first.empty()) continue;  // a sparse matrix
    const std::vector<double>& block = start ? nodes.first : nodes.last;
    // Differences of neighbours are exact: with their coupling inertia drops out.
    const std::vector<double>& beside = start || path.elements() == 1 ? nodes.first_lower : nodes.last_lower;
    for (int b = 0; b < n; ++b) {
      const double stiffness = block[a * n + b] + beside[start ? b * n + a : a * n + b];
      rounding[z.column] += std::abs(z.value * stiffness) * (force_roundoff * q[b] + displacement);
    }
  }
  double largest = 0;
  for (std::size_t c = 0; c < left.size(); ++c) largest = std::max(largest, std::abs(left[c]) - rounding[c]);
  return largest;
}

bool ResidualTest::passed(const Problem& problem, const NewtonIteration& newton, const Path& path,
                          double allowed) {
  if (problem.ends.free == 0) return true;
  const double left = newton.residual(), momentum = newton.action().momentum_scale(),
               part = std::max(least, allowed) * momentum;
  share_ = left / momentum;
  return natural_residual(problem, newton.action(), path) <= part &&
         left <= std::max(part, force_roundoff * newton.stiffness() * largest_coordinate(path));
}

std::string ResidualTest::message() const {
  if (!std::isfinite(share_))
    return "the iteration came to rest where all momenta vanish and the natural conditions do not hold: "
           "there is no "
           "extremal near; try another guess";
  return fmt::format(
      "Newton's method stopped with a residual of {:.1e} of the largest momentum: there is no extremal near, "
      "or the second variation is nearly singular; try another guess",
      share_);
}

}  // namespace extremal
