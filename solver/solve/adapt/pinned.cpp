#include "solve/adapt/pinned.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "action/momentum_jump.hpp"
#include "machine/simd.hpp"
#include "solve/adapt/element_count.hpp"
#include "solve/adapt/limits.hpp"
#include "solve/adapt/residual_homotopy.hpp"
#include "solve/adapt/stationary_phase.hpp"
#include "solve/external/external_solver.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/mesh/conservation.hpp"

namespace extremal {

using namespace limits::pinned;

PinnedSolve::PinnedSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                         const SchemeStart& start)
    : problem_(problem), options_(options), w_(workspace), scheme_(*options.scheme), start_(start) {
  w_.iteration.end_at(options.deadline);
}

void PinnedSolve::bind(int points) {
  w_.pinned_scheme = std::make_unique<SchemeTables>(scheme_, points);
  w_.pinned.bind(*w_.pinned_scheme, *problem_.lagrangian);
}

/// Newton's method on elements of `tables`, at its end where steps need pivoting and cost more than that many
/// steps without.
NewtonReport PinnedSolve::run_newton(const ElementTables& tables, Path& path, double goal, int most_steps) {
  const double step = path.batches() * batch_cost(tables, path.degree());
  const double most = std::max(most_cost, most_steps * step);
  double cost = 0;
  const NewtonReport report = converge(w_.iteration, path, tables, {goal, most_steps}, [&] {
    if (&tables == &w_.pinned) outcome_.record(w_.iteration, options_);
    cost += step * w_.iteration.burden();
    return cost < most && !options_.deadline.passed();
  });
  cost_ += cost;
  return report;
}

/// Newton's method with the phase held, as long as that is regular; then the phase is found. Of few elements
/// the phase is a coordinate like others.
NewtonReport PinnedSolve::converge_to_roundoff() {
  const auto run = [&](Path& path) {
    return run_newton(w_.pinned, path, least_correction, std::min(steps, options_.max_iterations));
  };
  if (!problem_.shifts_in_time()) return run(path_);
  const auto residual_below = [&](double part) {
    const double residual = w_.iteration.residual_at(path_);
    return residual <= part * w_.iteration.action().momentum_scale();
  };
  saved_ = path_;
  NewtonReport report = run(path_);
  if (report.reached && residual_below(limits::stationary_phase::unforced)) return report;
  StationaryPhase phase(problem_, w_.iteration, w_.pinned, [&](Path& path) { return run(path).reached; });
  if (report.reached && phase.find(path_, stationary_residual)) return report;
  if (report.reached && residual_below(stationary_residual)) return report;
  for (const bool from_orbit : {true, false}) {
    if (from_orbit && !report.reached) continue;
    if (!from_orbit) {
      path_ = saved_;
      path_.load_ends();
    }
    w_.iteration.free_phase(true);
    report = run(path_);
    if (report.reached || residual_below(stationary_residual)) break;
  }
  report.reached = report.reached || residual_below(stationary_residual);
  return report;
}

bool PinnedSolve::has_homotopy(const Problem& problem, const SolveOptions& options) {
  return problem.has_ends() && !problem.paired && !problem.lagrangian->kinks() &&
         (options.free_steps || !problem.duration.free);
}

/// The guess, bent by the noise of the seed; the default guess is bent further until L is finite on it. If
/// times are free, the seed moves the nodes.
void PinnedSolve::start_path_on(const std::vector<double>& mesh) {
  const std::vector<double> ends = starting_ends(problem_);
  const unsigned first = options_.free_steps ? 0 : start_.seed;
  for (unsigned seed = first; seed <= first + most_bends; ++seed) {
    path_.reset(w_.pinned, mesh, problem_.duration.value);
    start_path(problem_, ends, w_.pinned, path_);
    bend_path(problem_, {seed * bend_size, seed}, w_.pinned, path_);
    w_.iteration.action().evaluate_plain(path_);
    if (w_.iteration.action().finite() || problem_.guess.given()) break;
  }
  if (!options_.free_steps || start_.seed == 0) return;
  Noise noise(start_.seed);
  std::vector<double> moved(mesh.size());
  for (std::size_t k = 1; k + 1 < mesh.size(); ++k) moved[k] = node_noise * noise() * (mesh[k + 1] - mesh[k]);
  path_.slide(moved, 1 / (1 - 2 * node_noise));
}

/// From the path there is, to roundoff.
bool PinnedSolve::solve_equations() {
  if (start_.homotopy && options_.free_steps) return trace_residual(true);
  const Path start = path_;
  NewtonReport report = converge_to_roundoff();
  outcome_.message = report.failure;
  if (!report.reached && start_.homotopy) {
    path_ = start;
    if (trace_residual(false)) {
      report = converge_to_roundoff();
      outcome_.message = report.failure;
    }
  }
  if (!report.reached) return false;
  ResidualTest test;
  w_.iteration.residual_at(path_);
  if (!test.passed(problem_, w_.iteration, path_)) {
    outcome_.message = test.message();
    return false;
  }
  return !options_.free_steps || trace_residual(true);
}

/// With more points for the quadrature, as long as it is not exact, from the path there is.
bool PinnedSolve::solve_discrete(int elements) {
  std::vector<double> mesh(elements + 1);
  for (int k = 0; k <= elements; ++k) mesh[k] = static_cast<double>(k) / elements;
  bool again = false;
  for (int points = scheme_.points;; points = std::min(points < 8 ? points + 2 : points + 4, most_points)) {
    bind(points);
    w_.iteration.reset(problem_, w_.pinned, elements);
    if (!std::exchange(again, true)) {
      start_path_on(mesh);
      const Scales first = scales(path_, w_.pinned);
      magnitude_ = first.magnitude;
      if (problem_.periodic) outcome_.first_range = first.range;
      run_external_solver(options_.method, problem_, w_.pinned, path_, options_.deadline,
                          [this] { return ++outcome_.iterations < options_.max_iterations; });
    }
    if (!solve_equations()) return false;
    const bool more = scheme_.quadrature == Quadrature::exact && points < most_points;
    if (!more || quadrature_is_exact()) return true;
  }
}

/// From equal steps to those that leave all elements the same energy; or, with times held, from a path near
/// which Newton's method finds no extremal to one.
bool PinnedSolve::trace_residual(bool free_times) {
  ResidualHomotopy homotopy(problem_, w_.pinned, path_.elements(), free_times, [this] {
    return ++outcome_.iterations < options_.max_iterations && !options_.deadline.passed();
  });
  const ResidualHomotopy::Report report = homotopy.find(path_);
  outcome_.message = report.failure;
  return report.reached;
}

/// Whether two more points leave S_h as it is.
bool PinnedSolve::quadrature_is_exact() {
  w_.iteration.action().evaluate_plain(path_);
  const double action = w_.iteration.action().action();
  const int points = std::min(w_.pinned_scheme->points + 2, most_points);
  const SchemeTables finer(scheme_, points);
  ElementTables tables;
  tables.bind(finer, *problem_.lagrangian);
  DiscreteAction check;
  check.reset(*problem_.lagrangian, tables, path_.elements(), false);
  check.evaluate_plain(path_);
  return std::abs(check.action() - action) <= 1e-15 * std::abs(action);
}

/// Whether the companion's energy drifts no more than its elements explain.
bool PinnedSolve::holds_energy(const Resolution::Error& left_out) {
  if (!problem_.lagrangian->structure().autonomous) return true;
  const Trajectory companion = trajectory_of(w_.other);
  const Survey found = survey(*problem_.lagrangian, companion);
  return found.finite && conserves_energy(found, companion, left_out);
}

/// The elements of the companion end where it crosses kinks of L: Newton's method again as long as they do
/// not.
NewtonReport PinnedSolve::converge_with_kinks(const ElementTables& tables, NewtonReport report) {
  for (int k = 0; tables.kinks() && k < companion_steps; ++k) {
    const std::vector<double> times = crossings(*tables.kinks(), w_.other);
    if (distance_to_nodes(w_.other.mesh(), times) <= companion_misplacement) return report;
    w_.raised.resample_from(w_.other, tables, with_nodes(w_.other.mesh(), times));
    std::swap(w_.other, w_.raised);
    w_.iteration.reset(problem_, tables, w_.other.elements());
    report = run_newton(tables, w_.other, 1e-12, companion_steps);
  }
  report.reached = report.reached && !tables.kinks();
  return report;
}

/// Elements of the path inside which it crosses kinks of L.
int PinnedSolve::kinked_elements() const {
  if (!problem_.lagrangian->kinks()) return 0;
  int count = 0, last = -1;
  const std::span<const double> mesh = path_.mesh();
  for (const double t : crossings(*problem_.lagrangian->kinks(), path_)) {
    const auto after = std::upper_bound(mesh.begin(), mesh.end(), t);
    const int element = static_cast<int>(after - mesh.begin()) - 1;
    const double within = std::min(t - *(after - 1), *after - t);
    if (within > companion_misplacement && element != last) {
      ++count;
      last = element;
    }
  }
  return count;
}

/// Largest distance of the path from the extremal of elements of higher degree on the same mesh, or of halved
/// elements where there is no higher degree, started from it; the companion's own truncation is added, and
/// its movement under a finer quadrature. Infinite if it does not converge or does not hold its
/// energy.
double PinnedSolve::distance_to_companion() {
  const int n = problem_.coordinates();
  const bool halved = scheme_.degree + 3 > max_degree;
  const int degree = halved ? scheme_.degree : std::max(scheme_.degree + 3, 6);
  const ElementTables& tables = w_.levels.at(degree);
  if (halved)
    w_.other.split_from(path_, tables, w_.levels.halve(degree));
  else
    w_.other.interpolate_from(path_, tables, w_.levels.raise(path_.degree(), degree));
  const Path start = w_.other;
  w_.iteration.reset(problem_, tables, w_.other.elements());
  const NewtonReport report =
      converge_with_kinks(tables, run_newton(tables, w_.other, 1e-12, companion_steps));
  if (!report.reached) return INFINITY;
  w_.resolution.measure(w_.other, tables);
  const Scales size = scales(w_.other, tables);
  const double range = size.q;
  w_.iteration.set_scale(range);
  const double unseen = w_.iteration.step_under(w_.levels.finer(tables.scheme()), w_.other);
  const Resolution::Error left_out = w_.resolution.at(degree);
  if (!std::isfinite(unseen) || !holds_energy(left_out)) return INFINITY;
  double distance =
      std::max(left_out.q + (report.remaining + unseen) * range, unit_roundoff * size.magnitude);
  if (tables.kinks()) {
    w_.raised.resample_from(w_.other, tables, start.mesh());
    std::swap(w_.raised, w_.other);
  }
  std::vector<double> a(static_cast<std::size_t>(degree + 1) * n), b(a.size());
  for (int k = 0; k < start.elements(); ++k) {
    start.element(k, a.data());
    w_.other.element(k, b.data());
    for (std::size_t i = 0; i < a.size(); ++i) distance = std::max(distance, std::abs(a[i] - b[i]));
  }
  return distance;
}

/// By how much velocities of the result differ from those of the companion, of which distance_to_companion()
/// was measured last, in the tolerance that they have. Where momenta give none they are the path's own.
double PinnedSolve::velocity_excess() {
  w_.iteration.reset(problem_, w_.pinned, path_.elements());
  outcome_.recovered = recover(problem_, path_, w_, w_.raised);
  const Trajectory found = trajectory_of(outcome_.recovered ? w_.raised : path_),
                   exact = trajectory_of(w_.other);
  const int n = problem_.coordinates();
  std::vector<double> q(n), v(n), exact_v(n);
  double difference = 0;
  for (int k = 0; k < found.elements(); ++k)
    for (const double tau : {0.0, 0.25, 0.5, 1.0}) {
      found.in_element(k, tau, q, v);
      // A free duration differs by its error.
      const double t = found.times[k] + tau * (found.times[k + 1] - found.times[k]);
      exact.at(std::min(t / found.duration(), 1.0) * exact.duration(), q, exact_v);
      for (int a = 0; a < n; ++a) difference = std::max(difference, std::abs(v[a] - exact_v[a]));
    }
  const double range = scales(w_.other, w_.levels.at(w_.other.degree())).v;
  const double allowed = velocity_tolerances * options_.tolerance * range;
  return allowed > 0 ? difference / allowed : 0;
}

/// Elements.
int PinnedSolve::most_affordable() {
  bind(scheme_.points);
  return static_cast<int>(
      std::min<double>(most_elements, most_lanes * most_cost / batch_cost(w_.pinned, scheme_.degree)));
}

void PinnedSolve::spend_budget(int elements) {
  outcome_.status = Status::iteration_limit;
  outcome_.message =
      fmt::format("{} (solve.budget) is spent at {} elements; raise it, or loosen the tolerance",
                  options_.deadline.budget_text(), elements);
}

void PinnedSolve::accept(const Scales& size) {
  outcome_.status = Status::converged;
  outcome_.message = "converged";
  if (const int kinked = kinked_elements(); kinked > 0)
    outcome_.message += fmt::format(
        "; the path crosses kinks of the Lagrangian inside {} of its elements, which lowers the order",
        kinked);
  outcome_.elsewhere = ran_away(problem_, magnitude_, size.magnitude);
}

Outcome PinnedSolve::run() {
  outcome_.message = "the action is not finite along the guess";
  const bool adaptive = options_.elements == 0;
  ElementCount count(scheme_, options_.tolerance, adaptive ? 16 : options_.elements, most_affordable());
  for (;;) {
    if (options_.deadline.passed()) {
      spend_budget(count.now());
      break;
    }
    if (!solve_discrete(count.now())) {
      if (options_.deadline.passed()) continue;
      outcome_.astray = !adaptive || count.now() >= 256 || cost_ > most_cost;
      if (outcome_.astray) break;
      count.multiply(4);
      continue;
    }
    const Scales size = scales(path_, w_.pinned);
    outcome_.error = distance_to_companion();
    outcome_.tolerance = options_.tolerance * size.q;
    outcome_.tables = &w_.pinned;
    if (!std::isfinite(outcome_.error)) {
      if (adaptive && count.now() < count.most() && cost_ < most_cost) {
        count.multiply(2);
        continue;
      }
      if (adaptive) {
        outcome_.message = no_companion(count.now());
        break;
      }
      // No better extremal is near: the discrete one may be an artefact of the mesh.
      outcome_.error = size.q;
    }
    // A path at rest in the origin has no extent, and no error.
    double excess = outcome_.error > 0 ? outcome_.error / outcome_.tolerance : 0;
    if (adaptive && excess <= 1) excess = std::max(excess, velocity_excess());
    if (!adaptive || excess <= 1) {
      accept(size);
      break;
    }
    if (!count.grow(excess, size, {cost_ > most_cost, kinked_elements() > 0})) {
      outcome_.message = count.failure();
      break;
    }
  }
  if (outcome_.status == Status::not_converged && outcome_.path.elements() > 0)
    if (const auto jump = momentum_jump(problem_, path_)) outcome_.message = describe(*jump);
  outcome_.astray = outcome_.status == Status::not_converged && (outcome_.astray || !count.any());
  return std::move(outcome_);
}

}  // namespace extremal
