#include "solve/other_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "solve/conservation.hpp"
#include "solve/refinement.hpp"

namespace extremal {

namespace {

/// What an error may be by its estimate.
constexpr double honest = 10;
/// Symmetries of more take too long to find.
constexpr int most_coordinates = 18;
/// Where symmetries are looked for: at some of these forces count.
const std::vector<double> nearness{1, 0.25, 0.0625, 1 / 64.0, 1 / 256.0, 1 / 1024.0, 1 / 4096.0};
/// That tell where a path is.
constexpr int guess_points = 32;
/// Of momenta, relative to the largest.
constexpr double roundoff = 1e-13;

/// Directions that are null because symmetries of the problem move its ends belong to a family of extremals.
/// Others, or what looks null beside stronger forces or where forces vanish, tell nothing of the path found
/// from those beside it.
bool told_apart(const Problem& problem, const Trajectory& found, int null) {
  const int n = problem.coordinates();
  if (problem.periodic || null == 0 || n > most_coordinates) return true;
  Problem about = problem;
  about.guess = {};
  std::vector<double> v(n);
  for (int i = 0; i <= guess_points; ++i) {
    about.guess.tau.push_back(static_cast<double>(i) / guess_points);
    about.guess.q.resize(about.guess.q.size() + n);
    found.at(about.guess.tau.back() * found.duration(), {&*about.guess.q.end() - n, std::size_t(n)}, v);
  }
  return null <= std::ssize(continuous_symmetries(about, {most_coordinates, nearness}));
}

/// By how much momenta at the ends of a solution are others where the action was evaluated last, relative.
double kick(const DiscreteAction& action, const std::optional<Survey>& survey, const Solution& solution) {
  double largest = 0;
  for (std::size_t a = 0; a < solution.momentum_start.size(); ++a)
    largest = std::max({largest, std::abs(action.start_gradient()[a] + solution.momentum_start[a]),
                        std::abs(action.end_gradient()[a] - solution.momentum_end[a])});
  const double size = action.momentum_scale();
  const double range = survey ? *std::max_element(survey->p.begin(), survey->p.end()) : size;
  return largest > roundoff * size ? largest / range : 0;
}

void refuse(Solution& solution, Status status, std::string message) {
  solution.status = status;
  solution.message = std::move(message);
}

}  // namespace

OtherPoints try_other_points(const Problem& problem, const Outcome& outcome,
                             const std::optional<Survey>& survey, const Solution& solution, Workspace& w) {
  const Scales size = scales(w.path, *outcome.tables);
  const bool factored = solution.nullity.has_value(), at_rest = size.range < size.q || size.q == 0;
  if (!factored || at_rest) return {};
  w.iteration.set_scale(size.q);
  const auto moved = [&](double error) {
    if (!problem.periodic)
      w.iteration.model().set_null_below(Refinement::softest(error, w.path, size.magnitude));
    return size.q * w.iteration.step_under(w.levels.finer(outcome.tables->scheme()), w.path);
  };
  OtherPoints others;
  others.moved = moved(outcome.error);
  const int null = w.iteration.model().left_out();
  others.told_apart = told_apart(problem, solution.trajectory, null);
  if (!others.told_apart) {
    // Soft, but not null to the last digit: forces may be weak and tell all the same.
    others.moved = std::max(others.moved, moved(0));
    others.told_apart = w.iteration.model().left_out() < null && others.moved <= outcome.tolerance;
  }
  others.turned = size.v > 0 ? w.iteration.steepness(w.path) / size.v : 0;
  others.kicked = kick(w.iteration.action(), survey, solution);
  return others;
}

bool OtherPoints::missed(const SolveOptions& options, const Outcome& outcome) const {
  return moved > outcome.tolerance || turned > honest * momentum_tolerances * options.tolerance;
}

bool polish(Workspace& w) {
  constexpr int most_steps = 5;
  if (!w.iteration.extend()) return false;
  double before = INFINITY;
  for (int step = 0; step < most_steps; ++step) {
    if (w.iteration.full_step(w.path, 0) != StepResult::ok) return false;
    if (!(w.iteration.norm() < 0.5 * before)) break;
    before = w.iteration.norm();
  }
  return true;
}

void judge_by_other_points(const OtherPoints& others, const SolveOptions& options, const Outcome& outcome,
                           Solution& solution) {
  if (!others.told_apart)
    return refuse(solution, Status::conjugate_ends,
                  "the second variation is singular along the path found, though no symmetry makes it so: "
                  "forces vanish along it, or the ends are conjugate, with a family of extremals; move an "
                  "end or the duration, or try a better guess");
  if (!std::isfinite(others.moved))
    return refuse(solution, Status::not_converged,
                  "with other points in each element the action is not finite: the path runs through a "
                  "singularity of L; try another guess");
  if (!options.scheme && !(others.turned <= honest * momentum_tolerances * options.tolerance))
    return refuse(
        solution, Status::not_converged,
        fmt::format("with other points in each element velocities differ by {:.1e} of their range, more than "
                    "the tolerance {:.1e} allows: bodies all but collide, and roundoff is amplified; try "
                    "another tolerance",
                    others.turned, options.tolerance));
  if (!options.scheme && !(others.kicked <= momentum_tolerances * options.tolerance))
    return refuse(
        solution, Status::not_converged,
        fmt::format("with other points in each element the momenta at the ends differ by {:.1e} of their "
                    "range, more than the tolerance {:.1e} allows: forces rise within the first element or "
                    "the last; try another tolerance",
                    others.kicked, options.tolerance));
  if (others.moved <= honest * solution.error_estimate) return;
  solution.error_estimate = others.moved;
  if (options.elements > 0 || others.moved <= outcome.tolerance) return;
  refuse(solution, Status::not_converged,
         fmt::format("with other points in each element the path moves by {:.1e}, {:.0f} times what the "
                     "tolerance {:.1e} allows: they see other forces, or amplify roundoff; try another "
                     "tolerance",
                     others.moved, others.moved / outcome.tolerance, options.tolerance));
}

}  // namespace extremal
