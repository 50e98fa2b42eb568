#include "solve/minimality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/bounds.hpp"

namespace extremal {

namespace {

/// T within this of a conjugate time, relative, is one however accurate the trajectory is.
constexpr double least_distance = 1e-13;
/// A trajectory known no better than this does not make ends conjugate that are not.
constexpr double largest_distance = 1e-5;
/// Roundoff of the elements' lengths, which acts as one of T.
constexpr double roundoff = 0.25 * std::numeric_limits<double>::epsilon();

/// L = ½ q'ᵀMq' − V(q, t), M constant.
bool is_natural(const Structure& s) { return s.quadratic && s.velocity_free && s.gyroscopic.empty(); }

/// The longest window that the bound of M⁻¹V'' allows, also of the discrete action in use.
double longest_window(const Problem& problem, const SolveOptions& options, const Solution& solution) {
  const double unit = 1 / std::sqrt(*problem.curvature), pi = std::numbers::pi;
  if (!std::isfinite(unit)) return unit;
  if (!options.scheme) return unit * std::min(pi, window_bound(lobatto(solution.trajectory.degree), 1));
  const double elements = pi * unit / solution.duration() * solution.trajectory.elements();
  const int whole = static_cast<int>(std::clamp(elements, 1.0, 1e9));
  return unit * std::min(pi, window_bound(*options.scheme, whole));
}

/// Largest range of a coordinate over the nodes.
double range(const Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates;
  double largest = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double least = INFINITY, most = -INFINITY;
    for (std::size_t k = a; k < trajectory.nodes.size(); k += n) {
      least = std::min(least, trajectory.nodes[k]);
      most = std::max(most, trajectory.nodes[k]);
    }
    largest = std::max(largest, most - least);
  }
  return largest;
}

/// Near a conjugate time T the solution contains the Jacobi field that vanishes at both ends, as often as 1
/// over their distance.
void judge_ends(const SolveOptions& options, double distance, Solution& solution) {
  const double size = range(solution.trajectory), T = solution.duration();
  const double known = size > 0 ? solution.error_estimate / size : 0;
  if (distance <= T * std::clamp(known, least_distance, largest_distance)) {
    solution.status = Status::conjugate_ends;
    solution.message = fmt::format(
        "the ends are conjugate: within {:.1e} of T = {:.10g}, no more than the error, a Jacobi field "
        "vanishes "
        "at both; there is no extremal or a family of them; move an end or the duration",
        distance, T);
    return;
  }
  const double amplified = roundoff * T / distance;
  solution.error_estimate += amplified * size;
  if (options.elements == 0 && amplified > options.tolerance) {
    solution.status = Status::not_converged;
    solution.message = fmt::format(
        "the ends are nearly conjugate: {:.1e} from T = {:.10g} a Jacobi field vanishes at both, which "
        "amplifies "
        "roundoff to {:.1e} of the range and hides the tolerance {:.1e}; loosen it",
        distance, T, amplified, options.tolerance);
  }
}

}  // namespace

void read_minimality(const Problem& problem, const SolveOptions& options, SecondVariation& memory,
                     Solution& solution) {
  if (problem.coordinates() > SecondVariation::most_coordinates) {
    solution.message += fmt::format("; windows and conjugate times are only found for up to {} coordinates",
                                    SecondVariation::most_coordinates);
    return;
  }
  if (!memory.assemble(problem.lagrangian, solution.trajectory)) {
    solution.message += "; ∂²L/∂q'∂q' is not positive definite along it, so no part of it is a minimum";
    return;
  }
  const bool bounded = problem.curvature && is_natural(problem.lagrangian->structure());
  Minimality found =
      bounded ? minimality(memory, longest_window(problem, options, solution)) : minimality(memory);
  // A bound that the trajectory itself refutes proves nothing.
  const bool refuted = bounded && !found.within_longest;
  if (refuted) found = minimality(memory);
  solution.windows = std::move(found.windows);
  solution.conjugate_times = std::move(found.conjugate_times);
  solution.certificate = bounded && !refuted ? Certificate::global : Certificate::sampled;
  if (problem.ends.free == 0 && !problem.duration.free) judge_ends(options, found.distance, solution);
}

}  // namespace extremal
