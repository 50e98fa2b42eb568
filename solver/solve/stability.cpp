#include "solve/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/orbit_form.hpp"
#include "problem/closing.hpp"

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

/// T/m with the most m for which q(t + T/m) = q(t), within the error. A period that is a multiple of T/m
/// shows by its prime factors, one after the other. Nothing where it never moves.
std::optional<double> minimal_period(const Trajectory& path, double error) {
  constexpr int samples = 64, most = 1 << 16;
  constexpr int primes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31};
  const double T = path.duration();
  const std::size_t n = path.coordinates;
  std::vector<double> here(n), there(n), v(n);
  const auto repeats = [&](double period) {
    for (int k = 0; k < samples; ++k) {
      const double t = T * k / samples, later = t + period;
      path.at(t, here, v);
      path.at(std::min(later < T ? later : later - T, T), there, v);
      for (std::size_t a = 0; a < n; ++a)
        if (!(std::abs(here[a] - there[a]) <= error)) return false;
    }
    return true;
  };
  int parts = 1;
  for (const int prime : primes)
    while (parts < most && repeats(T / (parts * prime))) parts *= prime;
  return parts < most ? std::optional(T / parts) : std::nullopt;
}

/// Of the size of the path: distances that are told from none.
constexpr double distinct = 1e-6;

}  // namespace

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
  const double told = std::max(10 * solution.error_estimate, distinct * size);
  if (closing_map(problem).identity() && size > 0)
    solution.minimal_period = minimal_period(solution.trajectory, told);
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
