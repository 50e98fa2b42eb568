#include "solve/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/orbit_form.hpp"
#include "problem/closing.hpp"
#include "solve/repetition.hpp"

namespace extremal {

namespace {

void add_vectors(const SecondVariation& variation, const ClosedOrbit& orbit, Floquet& floquet) {
  const auto form = OrbitForm::make(variation, orbit.map);
  if (!form) return;
  for (const std::complex<double>& value : floquet.multipliers) {
    const Eigen::VectorXcd vector = form->eigenvector(value);
    floquet.vectors.emplace_back(vector.begin(), vector.end());
  }
}

}  // namespace

double told_apart(const Solution& solution, double size) {
  constexpr double distinct = 1e-6;
  return std::max(10 * solution.error_estimate, distinct * size);
}

ClosedOrbit closed_orbit(const Problem& problem, double relative_error) {
  ClosingMap map = closing_map(problem);
  return {.map = map.r.isIdentity(0) ? Eigen::MatrixXd{} : std::move(map.r),
          .relative_error = relative_error,
          .autonomous = problem.lagrangian->structure().autonomous,
          .symmetries = static_cast<int>(problem.symmetries.size())};
}

void read_stability(const Problem& problem, const SecondVariation& variation, double size, Solution& solution,
                    bool vectors) {
  if (!problem.periodic) return;
  const double told = told_apart(solution, size);
  if (const ClosingMap map = closing_map(problem); map.identity() && size > 0)
    if (const int parts = repetitions(solution.trajectory, map, 1, told); parts > 0)
      solution.minimal_period = solution.duration() / parts;
  if (problem.coordinates() > most_coordinates_for_multipliers) {
    solution.message += fmt::format("; multipliers are only found for up to {} coordinates",
                                    most_coordinates_for_multipliers);
  } else if (variation.count() == 0) {
    solution.message += "; nor are multipliers found";
  } else {
    const double error = size > 0 ? solution.error_estimate / size : 0;
    const ClosedOrbit orbit = closed_orbit(problem, error);
    solution.floquet = floquet(variation, orbit);
    if (!solution.floquet) solution.message += "; multipliers are too large for numbers";
    if (solution.floquet && vectors) add_vectors(variation, orbit, *solution.floquet);
  }
}

std::vector<int> iterate_indices(const Problem& problem, const Solution& solution, int most) {
  if (!problem.periodic || most < 0)
    throw std::invalid_argument(fmt::format("indices of {} iterates; need a periodic problem", most));
  SecondVariation variation;
  if (!variation.assemble(problem.lagrangian, solution.trajectory)) return {};
  const auto form = OrbitForm::make(variation, closed_orbit(problem, 0).map);
  return form ? form->iterates(most) : std::vector<int>{};
}

}  // namespace extremal
