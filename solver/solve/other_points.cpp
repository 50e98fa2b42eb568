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
/// Of momenta, relative to the largest.
constexpr double roundoff = 1e-13;

/// Directions that are null because symmetries of the problem move its ends belong to a family of extremals.
/// Others, or what looks null beside stronger forces, tell nothing of the path found from those beside it.
bool told_apart(const Problem& problem, int null) {
  return problem.periodic || null == 0 || problem.coordinates() > most_coordinates_for_rotations ||
         null <= std::ssize(continuous_symmetries(problem));
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
  QuadraticModel& model = w.iteration.model();
  if (!problem.periodic) model.set_null_below(Refinement::softest(outcome.error, w.path, size.magnitude));
  const double moved = size.q * w.iteration.step_under(w.levels.finer(outcome.tables->scheme()), w.path);
  return {moved, size.v > 0 ? w.iteration.steepness(w.path) / size.v : 0,
          kick(w.iteration.action(), survey, solution), told_apart(problem, model.left_out())};
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
