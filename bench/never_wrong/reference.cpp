#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "action/scheme.hpp"
#include "linear/dense.hpp"
#include "rivals/verify.hpp"
#include "solution/observe.hpp"
#include "study/phase.hpp"

namespace bench {
namespace {

constexpr double tightest_solve = 1e-13;
/// A range below this part of the values is none.
constexpr double negligible = 1e-12;
/// A path this small beside guess and ends has come to rest at zero.
constexpr double vanished = 1e-9;
constexpr int most_reference_coordinates = 40;
/// What an error may be by its estimate.
constexpr double honest = 10;
/// Between orbits of a family, relative, in duration.
constexpr double neighbouring = 1e-5;

/// Times within every element, ends included.
std::vector<double> times_within(const extremal::Trajectory& trajectory, int points) {
  std::vector<double> times{0};
  for (int k = 0; k < trajectory.elements(); ++k)
    for (int i = 1; i <= points; ++i)
      times.push_back(i == points ? trajectory.times[k + 1]
                                  : trajectory.times[k] +
                                        (trajectory.times[k + 1] - trajectory.times[k]) * i / points);
  return times;
}

extremal::Guess as_guess(const extremal::Trajectory& trajectory) {
  extremal::Guess guess;
  std::vector<double> q(trajectory.coordinates), v(trajectory.coordinates);
  const double duration = trajectory.duration();
  for (const double t : times_within(trajectory, 4 * trajectory.degree)) {
    trajectory.at(t, q, v);
    guess.tau.push_back(t / duration);
    guess.q.insert(guess.q.end(), q.begin(), q.end());
  }
  return guess;
}

/// Phase points of a trajectory at times relative to its duration.
struct Points {
  std::vector<double> q, v, p;
};

Points points_at(const extremal::Problem& problem, const extremal::Trajectory& trajectory,
                 const std::vector<double>& tau) {
  const std::size_t n = problem.coordinates();
  Points points{std::vector<double>(tau.size() * n), std::vector<double>(tau.size() * n),
                std::vector<double>(tau.size() * n)};
  extremal::Scratch scratch;
  for (std::size_t k = 0; k < tau.size(); ++k) {
    const auto row = [&](std::vector<double>& x) { return std::span(x).subspan(k * n, n); };
    phase_point(problem, trajectory, std::min(tau[k] * trajectory.duration(), trajectory.duration()),
                row(points.q), row(points.v), row(points.p), scratch);
  }
  return points;
}

double largest_difference(const std::vector<double>& x, const std::vector<double>& y) {
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) largest = std::max(largest, std::abs(x[i] - y[i]));
  return largest;
}

/// To the tightest tolerance that is met.
extremal::Solution most_accurate(extremal::Study& study) {
  extremal::Solution solution;
  for (double tolerance = tightest_solve; tolerance < 1e-10 && !solution.converged(); tolerance *= 10) {
    study.options.tolerance = tolerance;
    solution = run(study);
  }
  return solution;
}

bool from_guess(const extremal::Solution& solution) {
  return solution.converged() && solution.strategy == "newton from the guess";
}

/// Moves an orbit along directions in which its neighbours are extremals, too, to where it is nearest to `x`,
/// to first order.
void move_to(const std::vector<double>& x, const std::vector<std::vector<double>>& directions,
             Points& right) {
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
  };
  Eigen::MatrixXd along(std::ssize(x), std::ssize(directions));
  for (std::size_t k = 0; k < directions.size(); ++k) along.col(k) = vector(directions[k]);
  const Eigen::VectorXd moved = along * extremal::least_norm(along, vector(x) - vector(right.q));
  for (std::size_t i = 0; i < x.size(); ++i) right.q[i] += moved[i];
}

/// From the extremal that is found from it, by elements of a scheme or those that the tolerance asks for.
/// A condition that periodic orbits of every energy meet, each at its own phase, leaves a `family` of them,
/// one for each duration.
std::optional<TrueError> distance_by(const extremal::Study& study, const extremal::Solution& solution,
                                     std::optional<extremal::Scheme> scheme, bool family = false) {
  extremal::Study again = study;
  again.problem.guess = as_guess(solution.trajectory);
  extremal::Duration& duration = again.problem.duration;
  if (duration.free) duration.value = solution.duration();
  if (family) duration = {solution.duration(), false, {}, {}};
  again.options = {};
  again.options.scheme = scheme;
  const extremal::Solution reference = most_accurate(again);
  if (!from_guess(reference)) return std::nullopt;

  std::vector<double> tau = times_within(solution.trajectory, 2 * solution.trajectory.degree);
  for (double& t : tau) t /= solution.duration();
  const Points found = points_at(study.problem, solution.trajectory, tau);
  Points right = points_at(study.problem, reference.trajectory, tau);
  if (study.problem.periodic && study.problem.lagrangian->structure().autonomous) {
    std::vector<std::vector<double>> directions{right.v};
    if (family) {
      again.problem.guess = as_guess(reference.trajectory);
      duration.value *= 1 + neighbouring;
      const extremal::Solution neighbour = run(again);
      if (neighbour.converged()) {
        directions.push_back(points_at(study.problem, neighbour.trajectory, tau).q);
        for (std::size_t i = 0; i < right.q.size(); ++i) directions.back()[i] -= right.q[i];
      }
    }
    move_to(found.q, directions, right);
  }
  const extremal::Survey ranges = survey(*study.problem.lagrangian, reference.trajectory);
  return TrueError{.q = largest_difference(found.q, right.q),
                   .v = largest_difference(found.v, right.v),
                   .p = largest_difference(found.p, right.p),
                   .q_unknown = reference.error_estimate,
                   .q_range = largest_of(ranges.q),
                   .v_range = largest_of(ranges.v),
                   .p_range = largest_of(ranges.p),
                   .reference = reference.trajectory};
}

}  // namespace

double largest_of(const std::vector<double>& values) {
  double largest = 0;
  for (const double x : values) largest = std::max(largest, std::abs(x));
  return largest;
}

double magnitude(const extremal::Problem& problem, const extremal::Trajectory& trajectory) {
  return std::max(
      {largest_of(trajectory.nodes), largest_of(problem.guess.q), largest_of(problem.ends.offset)});
}

bool rests(const extremal::Problem& problem, const extremal::Trajectory& trajectory) {
  const double given = std::max(largest_of(problem.guess.q), largest_of(problem.ends.offset));
  const double range = largest_of(survey(*problem.lagrangian, trajectory).q);
  return range <= std::max(negligible * largest_of(trajectory.nodes), vanished * given);
}

double size_of(const extremal::Study& study, const extremal::Trajectory& trajectory) {
  const double range = largest_of(survey(*study.problem.lagrangian, trajectory).q),
               magnitude = largest_of(trajectory.nodes);
  return range > negligible * magnitude ? range : magnitude;
}

std::optional<TrueError> error_by_reference(const extremal::Study& study,
                                            const extremal::Solution& solution) {
  if (study.problem.periodic || solution.nullity.value_or(1) != 0) return std::nullopt;
  return distance_from_nearest(study, solution);
}

std::optional<TrueError> distance_from_nearest(const extremal::Study& study,
                                               const extremal::Solution& solution) {
  if (rests(study.problem, solution.trajectory)) return std::nullopt;
  if (study.problem.coordinates() > most_reference_coordinates) return std::nullopt;
  std::optional<TrueError> nearest;
  const auto near = [&](const std::optional<TrueError>& found) {
    if (found && (!nearest || found->q < nearest->q)) nearest = found;
    return nearest && nearest->q <= honest * solution.error_estimate;
  };
  // Another extremal may be close. Along a family of orbits, or in time, coarse elements would move on the
  // way to the tolerance; where all orbits last equally long, the duration tells none of them.
  const extremal::Scheme fine = extremal::lobatto(12);
  const bool periodic = study.problem.periodic, family = periodic && study.problem.duration.where;
  (!periodic && near(distance_by(study, solution, std::nullopt))) ||
      (family && near(distance_by(study, solution, fine, true))) || near(distance_by(study, solution, fine));
  return nearest;
}

std::optional<double> error_by_shooting(const extremal::Study& study, const extremal::Solution& solution) {
  const extremal::Verification found =
      verify(study.problem, solution.trajectory,
             {.tolerance = tightest_solve, .margin = std::numeric_limits<double>::max()});
  if (!found.distance) return std::nullopt;
  return *found.distance * tightest_solve * size_of(study, solution.trajectory);
}

}  // namespace bench
