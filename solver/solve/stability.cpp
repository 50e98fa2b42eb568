#include "solve/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/orbit_form.hpp"
#include "linear/dense.hpp"
#include "problem/closing.hpp"
#include "solve/repetition.hpp"

namespace extremal {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMajor> matrix(const Generator& symmetry) {
  const Eigen::Index n = std::ssize(symmetry.shift);
  return {symmetry.matrix.data(), n, n};
}

Eigen::Map<const Eigen::VectorXd> shift(const Generator& symmetry) {
  return {symmetry.shift.data(), std::ssize(symmetry.shift)};
}

void add_vectors(const SecondVariation& variation, const ClosedOrbit& orbit, Floquet& floquet) {
  const auto form = OrbitForm::make(variation, orbit.map);
  if (!form) return;
  for (const std::complex<double>& value : floquet.multipliers) {
    const Eigen::VectorXcd vector = form->eigenvector(value);
    floquet.vectors.emplace_back(vector.begin(), vector.end());
  }
}

/// How many symmetries move the orbit, and not only along itself: one that does not, as a rotation of a
/// centre of mass that rests at the origin, has no multipliers 1 of its own.
int moving_symmetries(const Problem& problem, const Trajectory& orbit) {
  constexpr double independent = 1e-8;  // the square of a sine
  const auto n = static_cast<Eigen::Index>(problem.coordinates()), points = std::ssize(orbit.times),
             count = std::ssize(problem.symmetries);
  if (count == 0) return 0;
  Eigen::MatrixXd fields(points * n, count + 1);
  Eigen::VectorXd q(n), v(n);
  double size = 0;
  for (Eigen::Index p = 0; p < points; ++p) {
    orbit.at(orbit.times[p], {q.data(), q.data() + n}, {v.data(), v.data() + n});
    size = std::max(size, q.norm());
    for (Eigen::Index s = 0; s < count; ++s)
      fields.col(s).segment(p * n, n) = matrix(problem.symmetries[s]) * q + shift(problem.symmetries[s]);
    fields.col(count).segment(p * n, n) = v;
  }
  for (Eigen::Index s = 0; s < count; ++s) {
    const Generator& symmetry = problem.symmetries[s];
    fields.col(s) /= (matrix(symmetry).norm() * size + shift(symmetry).norm()) * std::sqrt(points);
  }
  const bool shifts = problem.lagrangian->structure().autonomous && fields.col(count).norm() > 0;
  if (shifts)
    fields.col(count).normalize();
  else
    fields.col(count).setZero();
  const Eigen::VectorXd squares = symmetric_eigenvalues(fields.transpose() * fields);
  return static_cast<int>((squares.array() > independent).count()) - shifts;
}

}  // namespace

double told_apart(const Solution& solution, double size) {
  constexpr double distinct = 1e-6;
  return std::max(10 * solution.error_estimate, distinct * size);
}

ClosedOrbit closed_orbit(const Problem& problem, const Trajectory& trajectory, double relative_error) {
  ClosingMap map = closing_map(problem);
  return {.map = map.r.isIdentity(0) ? Eigen::MatrixXd{} : std::move(map.r),
          .relative_error = relative_error,
          .autonomous = problem.lagrangian->structure().autonomous,
          .symmetries = moving_symmetries(problem, trajectory)};
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
    const ClosedOrbit orbit = closed_orbit(problem, solution.trajectory, error);
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
  const auto form = OrbitForm::make(variation, closed_orbit(problem, solution.trajectory, 0).map);
  return form ? form->iterates(most) : std::vector<int>{};
}

}  // namespace extremal
