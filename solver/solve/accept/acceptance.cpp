#include "solve/accept/acceptance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "action/momentum_jump.hpp"
#include "machine/clock.hpp"
#include "problem/closing.hpp"
#include "problem/symmetry.hpp"
#include "solution/on_manifold.hpp"
#include "solve/accept/conditions.hpp"
#include "solve/accept/conjugate_ends.hpp"
#include "solve/accept/isolation.hpp"
#include "solve/accept/limits.hpp"
#include "solve/accept/minimality.hpp"
#include "solve/accept/quadrature_check.hpp"
#include "solve/accept/refuse.hpp"
#include "solve/accept/symmetries.hpp"
#include "solve/adapt/others_to_try.hpp"
#include "solve/mesh/overlooked.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/zero_eigenvalue.hpp"
#include "solve/periodic/equilibrium.hpp"
#include "solve/periodic/moving_symmetries.hpp"
#include "solve/periodic/orbit_index.hpp"
#include "solve/periodic/reconstruct_orbit.hpp"
#include "solve/periodic/stability.hpp"

namespace extremal {

using namespace limits::acceptance;

namespace {

/// Shifts in time and symmetries that steps leave out.
int held_directions(const Problem& problem) {
  return problem.shifts_in_time() + static_cast<int>(problem.symmetries.size());
}

/// Momenta, residual, index and nullity from one evaluation at the path, on the iteration's elements.
void read_equations(const Problem& problem, const SolveOptions& options, const Path& path,
                    const Outcome& outcome, NewtonIteration& newton, Solution& solution) {
  const bool factored = newton.factor(path);
  const DiscreteAction& action = newton.action();
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
  if (problem.paired) {  // the inertia of two copies tells nothing
    solution.nullity = 0;
    return;
  }
  const double size = scales(path, *outcome.tables).q;
  // Of pinned elements the equations themselves are known, to roundoff.
  const double error = options.elements > 0 ? 0 : outcome.error;
  const Inertia inertia = newton.model().inertia(zero_eigenvalue_along(size, error, path.elements()));
  solution.morse_index = inertia.negative;
  solution.nullity = inertia.zero;
  solution.minimizing =
      inertia.negative == 0 && (problem.periodic || inertia.zero == held_directions(problem));
}

void read_path(const Problem& problem, const SolveOptions& options, const Path& path, const Outcome& outcome,
               Workspace& w, Solution& solution) {
  w.iteration.reset(problem, *outcome.tables, path.elements());
  w.iteration.hold_shifts(outcome.shifts_held);
  const bool raised = outcome.recovered && recover(problem, path, w, w.raised);
  solution.trajectory = trajectory_of(raised ? w.raised : path);
  read_equations(problem, options, path, outcome, w.iteration, solution);
}

/// What a path was found to be, beside its solution: its survey where L does not depend on t.
struct Examined {
  std::optional<Survey> survey = {};
  bool hopeless = false;
  int held = 0;  ///< shifts between rests
};

Examined refused(Refusal refusal, Solution& solution) {
  solution.status = refusal.status;
  solution.message = std::move(refusal.message);
  return {.hopeless = refusal.hopeless};
}

/// A drift that is not small against the energy or the mean of L, but against what the energy is left of: as
/// in a thin layer.
void explain_drift(const Survey& survey, Solution& solution) {
  const double drift = survey.energy_drift, part = drift / survey.terms;
  const double mean = std::abs(solution.action) / solution.duration();
  if (!(drift > noticed_drift * std::max(std::abs(survey.energy), mean)) || !(part < noticed_drift)) return;
  solution.message += fmt::format(
      "; the energy is left of terms that cancel: its drift is {:.1e} of the largest ones, {:.1e}", part,
      survey.terms);
}

/// Reads a solution off a path, and refuses it where equations or elements fail.
Examined examine(const Problem& problem, const SolveOptions& options, const Path& path,
                 const Outcome& outcome, Workspace& w, Solution& solution) {
  solution.status = outcome.status;
  solution.message = outcome.message;
  solution.error_estimate = outcome.error + (outcome.shifts_held ? outcome.shift_error : 0);
  solution.degree = path.degree();
  const int inner = (path.degree() - 1) * path.elements() + path.elements() - 1;
  solution.unknowns = inner * problem.coordinates() + problem.ends.free + problem.duration.free;
  read_path(problem, options, path, outcome, w, solution);
  const int held = w.iteration.held_shifts();
  if (outcome.family > 0) {
    solution.nullity = outcome.family;
    solution.morse_index = outcome.index_across;
    solution.minimizing = outcome.index_across == 0;
  }
  if (auto fails = equations_fail(problem, options, outcome, path, w.iteration, solution))
    return refused(*std::move(fails), solution);
  if (problem.paired)
    if (auto fails = copies_differ(solution.trajectory, scales(path, *outcome.tables).q))
      return refused(*std::move(fails), solution);
  if (const auto jump = momentum_jump(problem, path))
    return refused({Status::not_converged, describe(*jump)}, solution);
  // Velocities that momenta give are the same on both sides of a node.
  if (auto fails =
          has_broken_node(problem, *problem.lagrangian,
                          outcome.recovered ? trajectory_of(path) : solution.trajectory, 0, path.elements()))
    return refused(*std::move(fails), solution);
  Examined result{.survey = observe_energy(*problem.lagrangian, solution), .held = held};
  if (result.survey && !problem.paired) explain_drift(*result.survey, solution);  // two copies have none
  if (auto fails =
          elements_fail(problem, options, outcome, path, result.survey, w.iteration.action(), solution))
    result.hopeless = refused(*std::move(fails), solution).hopeless;
  return result;
}

/// The path after more of Newton's method, where a finer quadrature moves it by more than the tolerance: that
/// may be roundoff. Nothing if it is not moved, or cannot be improved.
std::optional<Path> polished(const SolveOptions& options, const Outcome& outcome, const Path& path,
                             const QuadratureCheck& check, Workspace& w) {
  if (options.scheme || !check.missed(options, outcome)) return std::nullopt;
  Path better = path;
  if (!polish(better, w.iteration)) return std::nullopt;
  return better;
}

/// The quadrature check of an orbit by its part: along the whole it would amplify roundoff more.
struct Part {
  QuadratureCheck check;
  double residual = 0;             ///< under the finer quadrature
  std::optional<Path> whole = {};  ///< if the part was polished
};

Part examine_part(const SolveOptions& options, const Outcome& outcome, Workspace& w) {
  const Problem& problem = outcome.reduction->part;
  Solution solution;
  Part result;
  read_path(problem, options, outcome.part, outcome, w, solution);
  result.check = check_quadrature(problem, outcome.part, outcome, solution, w);
  const std::optional<Path> better = polished(options, outcome, outcome.part, result.check, w);
  const Path& path = better ? *better : outcome.part;
  if (better) {
    read_path(problem, options, path, outcome, w, solution);
    result.check = check_quadrature(problem, path, outcome, solution, w);
    reconstruct_orbit(*outcome.reduction, path, *outcome.tables, result.whole.emplace());
  }
  result.residual = residual_under_finer(problem, path, outcome, w);
  return result;
}

/// All but minimality, stability and conjugate ends; `path` becomes the path if it was polished.
Examined examine_all(const Problem& problem, const SolveOptions& options, const Outcome& outcome,
                     Workspace& w, std::optional<Path>& path, QuadratureCheck& check, Solution& solution) {
  std::optional<Part> part;
  if (outcome.reduction) part = examine_part(options, outcome, w);
  if (part) path = std::move(part->whole);
  Examined found = examine(problem, options, path ? *path : outcome.path, outcome, w, solution);
  if (!solution.converged()) return found;
  if (part) {
    check = part->check;
    const double roundoff = momentum_roundoff * w.iteration.action().momentum_scale();
    check.unlike = !(residual_under_finer(problem, path ? *path : outcome.path, outcome, w) <=
                     residual_growth * part->residual + roundoff);
  } else if (outcome.family == 0) {
    check = check_quadrature(problem, outcome.path, outcome, solution, w);
    path = polished(options, outcome, outcome.path, check, w);
    if (path) {
      solution = {};
      found = examine(problem, options, *path, outcome, w, solution);
      if (solution.converged()) check = check_quadrature(problem, *path, outcome, solution, w);
    }
  }
  const double range = found.survey ? *std::max_element(found.survey->p.begin(), found.survey->p.end())
                                    : w.iteration.action().momentum_scale();
  check.kicked = check.kicked > 0 ? check.kicked / range : 0;
  return found;
}

/// Null directions that symmetries make are none along which the action might fall. They are looked for where
/// that decides.
void explain_nullity(const Problem& problem, Solution& solution) {
  const int null = solution.nullity.value_or(0) - held_directions(problem);
  if (null <= 0 || problem.periodic || problem.infinite || problem.manifold ||
      !problem.boundary.momenta.empty())
    return;
  const int symmetric =
      moving_symmetries(symmetries_about(problem, solution.trajectory), solution.trajectory, false);
  if (symmetric < null) return;
  solution.minimizing = solution.morse_index == 0;
  solution.message += family_of_symmetries;
}

/// A shift in time is a symmetry of L. Other fields across the path may be as soft: between long rests a
/// negative sign that elimination finds may be that of roundoff. Where it finds none there is none.
void read_soft_shift(const Problem& problem, const Outcome& found, double size, SecondVariation& variation,
                     Solution& solution) {
  if (problem.ends.free == 0 && !solution.windows.empty()) {
    const double error = size > 0 ? solution.error_estimate / size : 0;
    const std::optional<OrbitIndex> by_eigenvalues =
        orbit_index(problem, variation, solution.trajectory, error);
    if (by_eigenvalues || solution.morse_index.value_or(0) > 0) tell_index(by_eigenvalues, solution);
  }
  solution.minimizing = solution.morse_index == 0;
  solution.message +=
      "; a shift in time between the rests of this path changes the action by hardly more than roundoff: of "
      "the paths that differ by it this is the one whose energies at both ends agree";
  if (found.shift_error > found.tolerance)
    solution.message +=
        fmt::format("; what is not known of the shift changes q by {:.1e}", found.shift_error);
}

/// Of conjugate ends the last conjugate time is T itself, which is not between them. The windows are then
/// those of a path that ends just before.
void leave_out_end(Solution& solution) {
  const double T = solution.duration();
  std::erase_if(solution.conjugate_times, [&](double t) { return t > (1 - conjugate_end) * T; });
  std::vector<std::array<double, 2>>& windows = solution.windows;
  while (windows.size() > 1 && windows.back()[0] > (1 - conjugate_end) * T) {
    windows.pop_back();
    windows.back()[1] = T;
  }
}

/// With free ends T itself may be conjugate to 0, as of an orbit that begins at a turning point. A time that
/// differs from T by no more than the path is known is T, which is not between the ends.
void leave_out_times_at_end(const Problem& problem, double size, Solution& solution) {
  if (problem.ends.free == 0 || !(size > 0)) return;
  const double within =
      solution.duration() * std::clamp(solution.error_estimate / size, least_blur, largest_blur);
  std::erase_if(solution.conjugate_times, [&](double t) { return t >= solution.duration() - within; });
}

/// An end that is conjugate by each null direction: at T, as of a path that rests or whose interfaces hardly
/// hold each other in time, or at infinity. The error of the path may move that to a time in the tail, where
/// fields are roundoff: times beyond the index.
void leave_out_later_times(Solution& solution) {
  if (!solution.morse_index) return;
  const auto index = static_cast<std::size_t>(*solution.morse_index);
  if (solution.nullity.value_or(0) == 0 || solution.conjugate_times.size() <= index) return;
  solution.conjugate_times.resize(index);
  std::vector<std::array<double, 2>>& windows = solution.windows;
  if (windows.size() <= index + 1) return;
  windows.resize(index + 1);
  windows.back()[1] = solution.duration();
}

/// A path that rests where no force acts is an extremal, whatever times are conjugate. Pinned elements have
/// conjugate times of their own.
bool rests_without_force(const Problem& problem, const SolveOptions& options, const Scales& size,
                         const Solution& solution) {
  return options.elements == 0 && problem.ends.free == 0 && !problem.duration.free &&
         (size.range < size.q || size.q == 0) && solution.residual <= momentum_roundoff;
}

/// A conjugate time at T itself is a null direction, and not between the ends.
void read_index_at_rest(const Problem& problem, SecondVariation& variation, Solution& solution) {
  if (solution.windows.empty()) return;
  read_index(problem, variation, 0, solution);
  leave_out_later_times(solution);
}

/// A null direction is a motion beside the orbit, which position and momentum determine: more of them say
/// that L depends on the path by roundoff alone, as where masses vanish. Shifts between rests are none.
void judge_nullity(const Problem& problem, int held, Solution& solution) {
  const int most = 2 * problem.coordinates(), null = solution.nullity.value_or(0) - held;
  if (null <= most) return;
  refused({Status::not_converged,
           fmt::format("the action hardly depends on the path: its second variation vanishes along {} "
                       "directions, and of motions there are {}; try another guess",
                       null, most)},
          solution);
}

/// The second variation whose multipliers are told: of pinned elements their own. What is indefinite has none
/// of its windows yet. It refers to `of_elements`.
void assemble_for_multipliers(const Problem& problem, const SolveOptions& options, const Outcome& found,
                              const Path& path, const Solution& solution, const Trajectory& of_elements,
                              Workspace& w) {
  if (!problem.periodic || problem.coordinates() > most_coordinates_for_multipliers) return;
  const ClosingMap closed = closing_map(problem);
  if (options.elements > 0) {
    w.variation.assemble_elements(problem.lagrangian, of_elements, path, *found.tables, &closed);
  } else if (problem.paired || problem.phase) {
    w.variation.assemble(problem.lagrangian, solution.trajectory, {}, &closed,
                         problem.paired ? Definite::paired : Definite::none);
  }
}

/// A solution that is refused has no path.
Solution without_path(const Solution& solution) {
  Solution refused;
  refused.status = solution.status;
  refused.message = solution.message;
  return refused;
}

struct Judged {
  bool hopeless;      ///< no solution, and another guess would not help
  bool not_isolated;  ///< to the error that the tolerance leaves
  /// Refused for forces that change fast within elements: τ at which they should end as well.
  std::vector<double> finer_at{};
};

/// The first and the last element, cut.
std::vector<double> shorter_ends(const Path& path) {
  const std::span<const double> mesh = path.mesh();
  return {shorter_end * mesh[1], 1 - shorter_end * (1 - mesh[mesh.size() - 2])};
}

/// Refuses a solution along which forces act that its elements do not see. Returns where they do, as τ. At
/// rest all momenta are roundoff.
std::vector<double> judge_forces(const Problem& problem, const Scales& size, Solution& solution) {
  const bool at_rest = size.range < size.q || size.q == 0;
  if (at_rest || !problem.lagrangian->structure().pulses) return {};
  const OverlookedForces overlooked = overlooked_forces(*problem.lagrangian, solution.trajectory);
  std::vector<double> ends;
  const double step = overlooked.step / solution.duration();
  for (const int k : overlooked.steps) {
    if (ends.empty() || ends.back() < (k - 0.5) * step) ends.push_back(k * step);
    ends.push_back((k + 1) * step);
  }
  if (ends.empty()) return {};
  refuse(solution, Status::not_converged,
         fmt::format("forces act about t = {:.6g} between the points of long elements; try a tighter "
                     "tolerance or a shorter duration",
                     solution.trajectory.times.front() + (overlooked.steps.front() + 0.5) * overlooked.step));
  std::erase_if(ends, [](double tau) { return !(tau > 0 && tau < 1); });
  return ends;
}

/// Sets the solution, without a deadline: the path meets the tolerance.
Judged judge_path(const Problem& problem, const SolveOptions& options, const Outcome& found, Workspace& w,
                  Solution& solution) {
  const auto start = Clock::now();
  w.iteration.end_at({});
  QuadratureCheck check;
  std::optional<Path> better;
  const Examined examined = examine_all(problem, options, found, w, better, check, solution);
  const Path& path = better ? *better : found.path;
  if (solution.converged()) {
    const bool indefinite = problem.paired || problem.phase;  // nothing is minimal
    const Trajectory of_elements = options.elements > 0 ? trajectory_of(path) : Trajectory{};
    const OwnElements own{path, *found.tables, of_elements};
    const OwnElements* const named = options.elements > 0 ? &own : nullptr;
    const double distance =
        indefinite ? INFINITY : read_minimality(problem, options, w.variation, solution, named);
    if (!indefinite && w.variation.too_many() && !named) confirm_index(problem, path, found, w, solution);
    if (!indefinite && !named) read_index_at_open_end(problem, path, found, w, solution);
    const Scales sizes = scales(path, *found.tables);
    const double size = sizes.q;
    // Pieces that minimise have windows. The index of pinned elements is their own.
    if (problem.periodic && options.elements == 0 && !solution.windows.empty())
      read_index(problem, w.variation, size > 0 ? solution.error_estimate / size : 0, solution);
    judge_nullity(problem, examined.held, solution);
    assemble_for_multipliers(problem, options, found, path, solution, of_elements, w);
    const bool one_of_many = read_stability(problem, w.variation, size, solution);
    if (one_of_many && closes_by_smallness(sizes.range, found.first_range))
      refused({Status::no_solution_near,
               fmt::format("{} without damping; try {}", shrank_to_rest,
                           others_to_try(problem, "a larger guess", "another duration"))},
              solution);
    if (found.family == 0) explain_nullity(problem, solution);
    if (found.family == 0) tell_continuum(problem, solution);
    if (found.shifts_held)
      read_soft_shift(problem, found, size, w.variation, solution);
    else if (found.family == 0 && rests_without_force(problem, options, sizes, solution))
      read_index_at_rest(problem, w.variation, solution);
    else if (found.family == 0)
      judge_conjugate_ends(problem, options, path, *found.tables, distance, w, solution);
    else
      leave_out_end(solution);
    leave_out_times_at_end(problem, size, solution);
    // Displacements that vanish at the ends are some of those that count: conjugate times in between are no
    // more than the index.
    const bool counted = (problem.ends.free == 0 || problem.periodic) && options.elements == 0 && !indefinite;
    if (problem.infinite || counted) leave_out_later_times(solution);
  }
  const bool judged = solution.converged();
  if (judged) judge_quadrature(check, options, found, solution);
  std::vector<double> finer_at;
  if (judged && !solution.converged() && !options.scheme && check.kicks(options))
    finer_at = shorter_ends(path);
  bool not_isolated = false;
  if (solution.converged() && check.softest && !options.scheme &&
      soft(problem, found, path, *check.softest, solution.error_estimate)) {
    judge_isolation(problem, path, found, *check.softest, w, solution);
    not_isolated = !solution.converged();
  }
  if (solution.converged() && !options.scheme)
    finer_at = judge_forces(problem, scales(path, *found.tables), solution);
  if (solution.converged() && problem.manifold) check_on_manifold(problem, solution);
  solution.pinned = options.scheme.has_value();
  if (solution.pinned && solution.converged() && !problem.paired) {
    const SchemeTables& scheme = found.tables->scheme();
    // Of the discrete path itself, not of what its momenta make of it.
    solution.element_energies = element_energies(*problem.lagrangian, scheme.node, scheme.weight,
                                                 found.recovered ? trajectory_of(path) : solution.trajectory);
  }
  const bool conjugate = solution.status == Status::conjugate_ends && !found.elsewhere;
  if (!solution.converged()) solution = without_path(solution);
  solution.strategy = found.strategy;
  if (options.method != Method::newton)
    solution.strategy += fmt::format(", led by {}", description(options.method));
  solution.iterations = found.iterations;
  w.iteration.forget();
  solution.seconds_analyse = seconds_since(start);
  return {examined.hopeless || conjugate, not_isolated, std::move(finer_at)};
}

}  // namespace

Solution accept(const Problem& problem, const SolveOptions& options, const Outcome& found, Workspace& w) {
  Solution solution;
  judge_path(problem, options, found, w, solution);
  return solution;
}

Acceptance::Acceptance(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem), options_(options), w_(workspace) {}

Acceptance::Verdict Acceptance::judge(const Outcome& found) {
  const bool first = !solution_;
  std::optional<Solution> later;
  Solution& solution = (first ? solution_ : later).emplace();
  Judged judged = judge_path(problem_, options_, found, w_, solution);
  seconds_ += solution.seconds_analyse;
  const bool accepted = solution.converged();
  if (accepted && !first) solution_ = std::move(later);
  too_loose_ = !accepted && (too_loose_ || (judged.not_isolated && options_.tolerance > isolating_tolerance));
  const bool hopeless = judged.hopeless || too_loose_;
  if (accepted) return Verdict::accepted;
  finer_at_ = std::move(judged.finer_at);
  return hopeless ? Verdict::hopeless : finer_at_.empty() ? Verdict::refused : Verdict::coarse;
}

Solution Acceptance::result(const Outcome& last) {
  Solution result = solution_ ? *std::move(solution_) : explain_failure(problem_, options_, last, w_);
  if (!solution_) seconds_ += result.seconds_analyse;
  solution_.reset();
  result.iterations = last.iterations;
  result.seconds_analyse = seconds_;
  return result;
}

}  // namespace extremal
