#include "solve/accept/quadrature_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solve/accept/limits.hpp"
#include "solve/accept/refuse.hpp"
#include "solve/accept/symmetries.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/least_eigenvalue.hpp"
#include "solve/newton/zero_eigenvalue.hpp"
#include "system/open_ends.hpp"

namespace extremal {

using namespace limits::quadrature_check;

namespace {

/// |∂²L/∂q'²| at the start times the largest speed, of which roundoff of momenta is a part: they vanish along
/// a motion that constraints alone drive. Zero where L is not finite there.
double momentum_of_speed(const Lagrangian& lagrangian, const Solution& solution) {
  const Trajectory& path = solution.trajectory;
  const std::size_t n = path.coordinates;
  if (path.slopes.size() < n) return 0;
  Scratch scratch;
  const std::vector<double> mass = evaluate_at(lagrangian, {path.nodes.data(), n}, {path.slopes.data(), n},
                                               path.times.front(), Order::hessian, scratch)
                                       .vv;
  double heavy = 0, speed = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double row = 0;
    for (std::size_t b = 0; b < n; ++b) row += std::abs(mass[a * n + b]);
    heavy = std::max(heavy, row);
  }
  for (const double v : path.slopes) speed = std::max(speed, std::abs(v));
  return std::isfinite(heavy * speed) ? heavy * speed : 0;
}

/// By how much momenta at the ends of a solution are others where the action was evaluated last.
double kick(const DiscreteAction& action, const Lagrangian& lagrangian, const Solution& solution) {
  double largest = 0;
  const auto* const open = dynamic_cast<const OpenEnds*>(&lagrangian);
  for (std::size_t a = 0; a < solution.momentum_start.size(); ++a) {
    if (!open || !open->open_start())
      largest = std::max(largest, std::abs(action.start_gradient()[a] + solution.momentum_start[a]));
    if (!open || !open->open_end())
      largest = std::max(largest, std::abs(action.end_gradient()[a] - solution.momentum_end[a]));
  }
  if (!(largest > momentum_roundoff * action.momentum_scale())) return 0;
  return largest > momentum_roundoff * momentum_of_speed(lagrangian, solution) ? largest : 0;
}

/// Refuses a solution of which `what`, relative to its range, is more than a tolerance allows.
void refuse(Solution& solution, const char* what, double much, double tolerance, const char* why) {
  refuse(solution, Status::not_converged,
         fmt::format("a finer quadrature changes {} by {:.1e} of their range, more than the tolerance {:.1e} "
                     "allows: {}; try another tolerance",
                     what, much, tolerance, why));
}

}  // namespace

QuadratureCheck check_quadrature(const Problem& problem, const Path& path, const Outcome& outcome,
                                 const Solution& solution, Workspace& w) {
  const Scales size = scales(path, *outcome.tables);
  const bool factored = solution.nullity.has_value(), at_rest = size.range < size.q || size.q == 0;
  if (!factored || at_rest) return {};
  w.iteration.set_scale(size.q);
  AlignedDoubles explained;
  if (outcome.recovered) w.recovery.misplaced(path, explained);
  const auto moved = [&](double error) {
    if (!problem.periodic)
      w.iteration.model().set_null_below(largest_null_eigenvalue(size.magnitude, error, path));
    return size.q * w.iteration.step_under(w.levels.finer(outcome.tables->scheme()), path, explained);
  };
  QuadratureCheck check;
  check.moved = moved(outcome.error);
  const QuadraticModel& model = w.iteration.model();
  const bool orbit = problem.periodic || outcome.reduction;  // or a part of one: they come in families
  if (!orbit && model.left_out() > 0 && problem.coordinates() <= most_coordinates) {
    // Directions that are null because symmetries move the ends belong to a family of extremals. Others may
    // be soft: weak forces fix the path, if to the last digit. Where forces vanish nothing does.
    const int family = static_cast<int>(symmetries_about(problem, solution.trajectory).size());
    if (model.left_out() > family) {
      check.moved = std::max(check.moved, moved(0));
      check.isolated = model.left_out() <= family && check.moved <= outcome.tolerance;
    }
  }
  check.turned = size.v > 0 ? w.iteration.steepness(path) / size.v : 0;
  check.kicked = kick(w.iteration.action(), *problem.lagrangian, solution);
  check.softest = least_eigenvalue(w.iteration, path);
  return check;
}

bool QuadratureCheck::missed(const SolveOptions& options, const Outcome& outcome) const {
  return moved > outcome.tolerance || turned > most_turned * options.tolerance;
}

bool QuadratureCheck::kicks(const SolveOptions& options) const {
  return !(kicked <= momentum_tolerances * options.tolerance);
}

double residual_under_finer(const Problem& problem, const Path& path, const Outcome& outcome, Workspace& w) {
  w.iteration.action().substitute(*problem.lagrangian, w.levels.finer(outcome.tables->scheme()));
  return w.iteration.residual_at(path);
}

bool polish(Path& path, NewtonIteration& newton) {
  if (!newton.extended() && !newton.extend()) return false;
  constexpr int most_steps = 10;
  double before = INFINITY;
  const auto take = [&](StepResult step) {
    if (step != StepResult::ok) return Progress::failed;
    const double last = std::exchange(before, newton.norm());
    if (before < 0.5 * last) return Progress::more;
    // What is left may be roundoff of the factors.
    before = INFINITY;
    newton.double_digits();
    return newton.extend() ? Progress::more : Progress::arrived;
  };
  return newton_loop(NewtonSteps{newton, path}, most_steps, take, Progress::arrived) == Progress::arrived;
}

void judge_quadrature(const QuadratureCheck& check, const SolveOptions& options, const Outcome& outcome,
                      Solution& solution) {
  if (!check.isolated)
    return refuse(
        solution, Status::conjugate_ends,
        "the second variation of the path found is singular, and not by a symmetry: forces vanish along "
        "the path, or the ends are conjugate; move an end, change the duration, or try a better guess");
  if (check.unlike)
    return refuse(solution, Status::not_converged,
                  "the forces along the orbit do not have the symmetries of the guess; try another guess");
  if (!std::isfinite(check.moved))
    return refuse(
        solution, Status::not_converged,
        "the action is not finite with a finer quadrature: the path runs through a singularity of L; "
        "try another guess");
  if (!options.scheme && !(check.turned <= most_turned * options.tolerance))
    return refuse(solution, "velocities", check.turned, options.tolerance,
                  "the path turns sharply, and roundoff is amplified");
  if (!options.scheme && check.kicks(options))
    return refuse(solution, "the momenta at the ends", check.kicked, options.tolerance,
                  "forces change fast within the first or the last element");
  // What a finer quadrature moves is a part of the error: up to the tolerance where the estimate explains it.
  const bool explained = check.moved <= honest * solution.error_estimate;
  const double told = explained ? std::min(check.moved, outcome.tolerance) : check.moved;
  solution.error_estimate = std::max(solution.error_estimate, told);
  if (explained || options.elements > 0 || check.moved <= outcome.tolerance) return;
  refuse(solution, Status::not_converged,
         fmt::format(
             "a finer quadrature moves the path by {:.1e}, {:.0f} times what the tolerance {:.1e} allows: "
             "forces vary fast within an element, or roundoff is amplified; try another tolerance",
             check.moved, check.moved / outcome.tolerance, options.tolerance));
}

}  // namespace extremal
