#include "solve/periodic/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "action/corners.hpp"
#include "analysis/orbit_form.hpp"
#include "linear/dense.hpp"
#include "problem/closing.hpp"
#include "problem/phase_space.hpp"
#include "solve/periodic/moving_symmetries.hpp"
#include "solve/periodic/repetition.hpp"

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

/// R, empty for the identity.
Eigen::MatrixXd map_of(const Problem& problem) {
  const ClosingMap map = closing_map(problem);
  return map.r.isIdentity(0) ? Eigen::MatrixXd{} : map.r;
}

/// Of the flow of a scheme: its own, exact as its equations are, with the symmetries that it shares with L. A
/// shift in time is none.
ClosedOrbit orbit_of_scheme(const Problem& problem, const Trajectory& trajectory) {
  return {.map = map_of(problem), .symmetries = moving_symmetries(problem.symmetries, trajectory, false)};
}

/// Whether orbits beside one with forces, which are no images of it, close as well: more multipliers are 1
/// than the shift in time and symmetries explain.
bool one_of_a_family(const Problem& problem, const ClosedOrbit& orbit, const Floquet& floquet) {
  constexpr double told_apart = 1e-6;
  const auto ones = std::ranges::count_if(floquet.multipliers,
                                          [](const auto& x) { return std::abs(x - 1.0) < told_apart; });
  return ones > problem.lagrangian->structure().autonomous + orbit.symmetries;
}

/// Whether a path crosses kinks inside its elements: their second variation is that of one side. `error`: of
/// the path, relative.
bool kinks_between_nodes(const Lagrangian& lagrangian, const Trajectory& path, double error) {
  constexpr double least_misplacement = 1e-8, errors = 100;
  if (!lagrangian.kinks()) return false;
  const double allowed = std::max(least_misplacement, errors * error) * path.duration();
  const std::vector<double> times =
      crossings(*lagrangian.kinks(), {path.coordinates, path.degree, path.times, path.nodes});
  return std::ranges::any_of(times, [&](double t) {
    const auto after = std::ranges::lower_bound(path.times, t);
    const double away = std::min(*after - t, after == path.times.begin() ? t : t - *(after - 1));
    return away > allowed;
  });
}

}  // namespace

double distinct_distance(const Solution& solution, double size) {
  constexpr double distinct = 1e-6;
  return std::max(10 * solution.error_estimate, distinct * size);
}

ClosedOrbit closed_orbit(const Problem& problem, const Trajectory& trajectory, double relative_error) {
  return {.map = map_of(problem),
          .relative_error = relative_error,
          .autonomous = problem.lagrangian->structure().autonomous,
          .symmetries =
              moving_symmetries(problem.symmetries, trajectory, problem.lagrangian->structure().autonomous)};
}

std::optional<Floquet> multipliers_of(const Problem& problem, const SecondVariation& variation,
                                      const ClosedOrbit& orbit) {
  if (problem.phase) return floquet_in_phase_space(variation, orbit, problem.phase->weights);
  return problem.paired ? floquet_with_forces(variation, orbit) : floquet(variation, orbit);
}

bool read_stability(const Problem& problem, const SecondVariation& variation, double size, Solution& solution,
                    bool vectors) {
  if (!problem.periodic) return false;
  bool one_of_many = false;
  const double distinct = distinct_distance(solution, size);
  if (const ClosingMap map = closing_map(problem); map.identity() && size > 0)
    if (const int parts = repetitions(solution.trajectory, map, 1, distinct); parts > 0)
      solution.minimal_period = solution.duration() / parts;
  if (problem.coordinates() > most_coordinates_for_multipliers) {
    solution.message +=
        fmt::format("; multipliers are only found for up to {} coordinates",
                    most_coordinates_for_multipliers / (problem.paired || problem.phase ? 2 : 1));
  } else if (variation.count() == 0) {
    solution.message += "; multipliers are not found";
  } else if (!variation.of_scheme() && kinks_between_nodes(*problem.lagrangian, solution.trajectory,
                                                           size > 0 ? solution.error_estimate / size : 0)) {
    solution.message +=
        "; multipliers are not known: the orbit crosses a kink of the Lagrangian beside t = 0; let it begin "
        "elsewhere";
  } else {
    const double error = size > 0 ? solution.error_estimate / size : 0;
    const ClosedOrbit orbit = variation.of_scheme() ? orbit_of_scheme(problem, solution.trajectory)
                                                    : closed_orbit(problem, solution.trajectory, error);
    solution.floquet = multipliers_of(problem, variation, orbit);
    if (!solution.floquet)
      solution.message +=
          "; multipliers are not known: they are too large, or the orbit passes too near to a point of rest";
    one_of_many = solution.floquet && problem.paired && problem.duration.free &&
                  one_of_a_family(problem, orbit, *solution.floquet);
    if (one_of_many)
      solution.message +=
          "; a multiplier beside that of the shift in time is 1: the orbit is one of a family, near the "
          "guess, and its period is not isolated";
    if (solution.floquet && vectors && !problem.paired && !problem.phase)
      add_vectors(variation, orbit, *solution.floquet);
  }
  return one_of_many;
}

std::string one_of_a_continuum(int directions) {
  return fmt::format(
      "; orbits beside this one close as well, to first order, in {} direction{} that no symmetry explains: "
      "it is one of a continuum, near the guess, or at a bifurcation",
      directions, directions > 1 ? "s" : "");
}

void tell_continuum(const Problem& problem, Solution& solution) {
  if (!problem.periodic || problem.paired || problem.duration.free || !solution.nullity) return;
  const bool autonomous = problem.lagrangian->structure().autonomous;
  const Trajectory& path = solution.trajectory;
  const auto moves = [](double v) { return v != 0; };
  const bool shifts = autonomous && std::ranges::any_of(path.slopes, moves);
  const int beside = *solution.nullity - shifts - moving_symmetries(problem.symmetries, path, shifts);
  if (beside > 0) solution.message += one_of_a_continuum(beside);
}

std::vector<int> iterate_indices(const Problem& problem, const Solution& solution, int most) {
  if (!problem.periodic || most < 0)
    throw std::invalid_argument(fmt::format("indices of {} iterates; need a periodic problem", most));
  SecondVariation variation;
  const ClosingMap closed = closing_map(problem);
  if (!variation.assemble(problem.lagrangian, solution.trajectory, {}, &closed)) return {};
  const auto form = OrbitForm::make(variation, map_of(problem));
  return form ? form->iterates(most) : std::vector<int>{};
}

}  // namespace extremal
