#include "solve/accept/finish.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "solution/observe.hpp"
#include "solve/accept/conjugate_ends.hpp"
#include "solve/accept/minimality.hpp"
#include "solve/accept/other_quadrature.hpp"
#include "solve/external/method.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/residual_test.hpp"
#include "solve/newton/zero_eigenvalue.hpp"
#include "solve/periodic/reconstruct_orbit.hpp"
#include "solve/periodic/stability.hpp"

namespace extremal {

namespace {

using Clock = std::chrono::steady_clock;

/// Of the largest momentum.
constexpr double largest_residual = 1e-6;
/// Of the range of momenta, as momentum_tolerances: forces that closed paths are held by.
constexpr double held_tolerances = 0.1;

/// Momenta, residual, index and nullity from one evaluation at the path found, on the iteration's elements.
void read_off(const Problem& problem, const Outcome& outcome, Workspace& w, Solution& solution) {
  NewtonIteration& newton = w.iteration;
  DiscreteAction& action = newton.action();
  const bool factored = newton.factor(w.path);
  solution.action = action.action();
  solution.momentum_start.resize(problem.coordinates());
  solution.momentum_end.resize(problem.coordinates());
  for (int a = 0; a < problem.coordinates(); ++a) {
    solution.momentum_start[a] = -action.start_gradient()[a];
    solution.momentum_end[a] = action.end_gradient()[a];
  }
  const double momentum = action.momentum_scale();
  solution.residual = newton.residual() / (momentum > 0 ? momentum : 1);
  if (!factored) return;
  const double size = scales(w.path, *outcome.tables).q;
  const Inertia inertia =
      newton.model().inertia(zero_eigenvalue_along(size, outcome.error, w.path.elements()));
  solution.morse_index = inertia.negative;
  solution.nullity = inertia.zero;
  solution.minimizing = inertia.negative == 0 && (inertia.zero == 0 || problem.periodic);
}

/// Forces so strong that steps are roundoff while δS is not: atoms that overlap.
bool balanced(const Solution& solution, Workspace& w) {
  const double roundoff = 100 * force_roundoff * w.iteration.stiffness() * size_at_start(w.path);
  return solution.residual <= largest_residual || w.iteration.residual() <= roundoff;
}

/// The closing equation must hold at what is returned: a duration that runs away can look like convergence.
bool closed(const Problem& problem, const SolveOptions& options, Workspace& w) {
  const ClosingEquation* closing = w.iteration.closing(w.path);
  if (!closing) return true;
  const double slope = w.iteration.action().slope_duration();
  const double size = closing->row.empty() ? std::abs(slope) + std::abs(closing->value)
                                           : std::max(1.0, scales(w.path, *w.final_tables).magnitude);
  const double value = closing->row.empty() ? slope + closing->value : closing->value;
  const double allowed = std::max(10 * (options.elements > 0 ? 0 : options.tolerance), 1e-6);
  const double duration = w.path.duration();
  return std::abs(value) <= allowed * size && duration > 0 && duration < 1e6 * problem.duration.value;
}

/// What is left of the natural conditions must be within the error that momenta may have: where forces hardly
/// change them, that may be far below the momenta. Steps of closed paths have nothing along a family of
/// orbits: what is left there is a small part of the error, or the family is none. Nor do other steps have
/// anything along directions that count as null: there no force may be left but what an error of q explains.
bool within_momenta(const Problem& problem, const Survey& survey, double tolerance, int nullity,
                    Workspace& w) {
  const DiscreteAction& action = w.iteration.action();
  const double range = *std::max_element(survey.p.begin(), survey.p.end());
  if (nullity > 0 && !problem.periodic) {
    const double error = tolerance * *std::max_element(survey.q.begin(), survey.q.end());
    return natural_residual(problem, action, w.path, error) <=
           std::max(momentum_tolerances * tolerance * range, unit_roundoff * action.momentum_scale());
  }
  const double part = problem.periodic ? held_tolerances : momentum_tolerances;
  return natural_residual(problem, action, w.path) <=
         std::max(part * tolerance * range, momentum_roundoff * action.momentum_scale());
}

/// Whether the elements have seen all of the path, and the equations had a solution.
void judge_resolution(const Problem& problem, const SolveOptions& options, const Outcome& outcome,
                      const std::optional<Survey>& found, Workspace& w, Solution& solution) {
  const double estimate = solution.error_estimate;
  if (found) solution.error_estimate = error_behind_drift(*found, solution.trajectory, estimate);
  const bool raised = solution.error_estimate > estimate;
  const bool conserved =
      !found || options.scheme || conserves_energy(*found, solution.trajectory, options.tolerance);
  if (!conserved || (raised && options.elements == 0 && solution.error_estimate > outcome.tolerance)) {
    solution.status = Status::not_converged;
    solution.message = fmt::format(
        "the energy drifts by {:.1e}, more than the tolerance {:.1e} explains: between the points of its "
        "elements the path passes a singularity or a kink that they do not resolve; try another tolerance",
        *solution.energy_drift, options.tolerance);
  } else if (found && problem.ends.free > 0 && !options.scheme &&
             !within_momenta(problem, *found, options.tolerance, solution.nullity.value_or(0), w)) {
    solution.status = Status::not_converged;
    solution.message = fmt::format(
        "a residual of {:.1e} of the largest momentum is left, more than momenta change by within the "
        "tolerance {:.1e}: forces all but vanish along the path, and there may be no extremal near; try "
        "another guess",
        solution.residual, options.tolerance);
  } else if (outcome.elsewhere && !problem.periodic && solution.nullity.value_or(0) > 0) {
    // Far away, where forces vanish, next to nothing is left of equations that have no solution.
    solution.status = Status::conjugate_ends;
    solution.message =
        "away from the guess a path was found along which the second variation is singular: the ends may "
        "be conjugate, with a family of extremals, or forces vanish along it; move an end or the "
        "duration, or try a better guess";
  }
}

/// What is left of a solution that turned out to be none.
Solution without_path(Solution solution) {
  Solution failed;
  failed.status = solution.status;
  failed.message = std::move(solution.message);
  return failed;
}

/// Why a solve may have failed before it began; empty if nothing is found.
std::string irregularity(const Problem& problem) {
  const int n = problem.coordinates();
  if (n > 64) return {};
  std::vector<double> q(n), v(n, 0.1);
  problem.guess.given() ? problem.guess.at(0.5, q) : (void)std::fill(q.begin(), q.end(), 0.1);
  Scratch scratch;
  const PointValues at = evaluate_at(*problem.lagrangian, q, v, 0, Order::hessian, scratch);
  const Eigen::Map<const Eigen::MatrixXd> mass(at.vv.data(), n, n);
  if (!mass.allFinite() || mass.fullPivLu().rank() == n) return {};
  return "the Lagrangian is not regular: its mass matrix ∂²L/∂q'∂q' is singular";
}

void read_path(const Problem& problem, const Outcome& outcome, Workspace& w, Solution& solution) {
  w.iteration.reset(problem, *outcome.tables, w.path.elements());
  solution.trajectory = trajectory_of(outcome.recovered && recover(problem, w) ? w.recovered : w.path);
  read_off(problem, outcome, w, solution);
}

/// Reads off what was found, and refuses it where it is no solution or the elements have not seen all of it.
std::optional<Survey> examine(const Problem& problem, const SolveOptions& options, const Outcome& outcome,
                              Workspace& w, Solution& solution) {
  solution.status = outcome.status;
  solution.message = outcome.message;
  solution.error_estimate = outcome.error;
  solution.degree = w.path.degree();
  const int inner = (w.path.degree() - 1) * w.path.elements() + w.path.elements() - 1;
  solution.unknowns = inner * problem.coordinates() + problem.ends.free + problem.duration.free;
  read_path(problem, outcome, w, solution);
  w.final_tables = outcome.tables;
  if (!std::isfinite(solution.action) || !std::isfinite(solution.residual)) {
    solution.status = Status::not_converged;
    solution.message = "the path runs through a singularity of L; try another guess";
  } else if (!balanced(solution, w)) {
    solution.status = Status::not_converged;
    solution.message = fmt::format(
        "a residual of {:.1e} of the largest momentum is left: forces are too strong for what they move; "
        "try another guess",
        solution.residual);
  } else if (!closed(problem, options, w)) {
    solution.status = Status::no_solution_near;
    solution.message = "the duration ran away: no extremal near the guess meets what closes it";
  }
  if (!solution.converged()) return std::nullopt;
  const std::optional<Survey> found = observe_energy(*problem.lagrangian, solution);
  judge_resolution(problem, options, outcome, found, w, solution);
  return found;
}

/// What other points tell of a path that was read off; it is polished where they miss it. Whether it was.
bool try_others(const Problem& problem, const SolveOptions& options, Outcome& outcome, Workspace& w,
                const Solution& solution, OtherPoints& others) {
  others = try_other_points(problem, outcome, solution, w);
  if (options.scheme || outcome.polished || !others.missed(options, outcome)) return false;
  return outcome.polished = polish(w);
}

/// What other points tell of an orbit by its part: along all of it they would amplify roundoff more. The
/// workspace has the whole then.
OtherPoints examine_part(const SolveOptions& options, Outcome& outcome, Workspace& w, double& residual) {
  const Reduction& reduction = *outcome.reduction;
  Solution solution;
  OtherPoints others;
  read_path(reduction.part, outcome, w, solution);
  if (try_others(reduction.part, options, outcome, w, solution, others)) {
    read_path(reduction.part, outcome, w, solution);
    others = try_other_points(reduction.part, outcome, solution, w);
    reconstruct_orbit(reduction, w.path, *outcome.tables, w.whole);
  }
  residual = residual_under_others(reduction.part, outcome, w);
  std::swap(w.path, w.whole);
  return others;
}

/// Of what was found, all but minimality and stability.
void examine_all(const Problem& problem, const SolveOptions& options, Outcome& outcome, Workspace& w,
                 Solution& solution, OtherPoints& others) {
  double residual = 0;  // of the part
  if (outcome.reduction) others = examine_part(options, outcome, w, residual);
  std::optional<Survey> found = examine(problem, options, outcome, w, solution);
  if (!solution.converged()) return;
  if (outcome.reduction) {
    const double roundoff = momentum_roundoff * w.iteration.action().momentum_scale();
    others.unlike = !(residual_under_others(problem, outcome, w) <= 10 * residual + roundoff);
  } else if (try_others(problem, options, outcome, w, solution, others)) {
    solution = {};
    found = examine(problem, options, outcome, w, solution);
    if (solution.converged()) others = try_other_points(problem, outcome, solution, w);
  }
  const double range =
      found ? *std::max_element(found->p.begin(), found->p.end()) : w.iteration.action().momentum_scale();
  others.kicked = others.kicked > 0 ? others.kicked / range : 0;
}

}  // namespace

Solution finish(const Problem& problem, const SolveOptions& options, const Outcome& found, Workspace& w,
                SecondVariation& variation) {
  const auto start = Clock::now();
  Solution solution;
  Outcome outcome = found;
  if (outcome.status == Status::converged) {
    OtherPoints others;
    examine_all(problem, options, outcome, w, solution, others);
    if (solution.converged()) {
      const double distance = read_minimality(problem, options, variation, solution);
      read_stability(problem, variation, scales(w.path, *outcome.tables).q, solution);
      judge_conjugate_ends(problem, options, distance, w, solution);
    }
    if (solution.converged()) judge_by_other_points(others, options, outcome, solution);
    if (!solution.converged()) solution = without_path(std::move(solution));
  } else {
    solution.status = outcome.status;
    solution.message = outcome.message;
    if (const std::string reason = irregularity(problem); !reason.empty()) {
      solution.message = reason;
    } else if (outcome.status != Status::conjugate_ends &&
               failed_at_conjugate_ends(problem, trajectory_of(w.path), variation)) {
      solution.status = Status::conjugate_ends;
      solution.message =
          "the ends seem to be conjugate, with no extremal or a family of them; move an end or the "
          "duration (" +
          outcome.message + ")";
    }
  }
  solution.strategy = outcome.strategy;
  if (options.method != Method::newton)
    solution.strategy += fmt::format(", led by {}", description(options.method));
  solution.iterations = outcome.iterations;
  w.iteration.forget();
  solution.seconds_analyse = std::chrono::duration<double>(Clock::now() - start).count();
  return solution;
}

}  // namespace extremal
