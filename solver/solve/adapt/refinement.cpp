#include "solve/adapt/refinement.hpp"
#include "solve/adapt/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "action/momentum_jump.hpp"
#include "solve/mesh/kink_nodes.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/periodic/equilibrium.hpp"

namespace extremal {

using namespace limits::refinement;

Refinement::Refinement(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                       Outcome& outcome)
    : problem_(problem), options_(options), w_(workspace), outcome_(outcome), path_(outcome.path) {}

void Refinement::rebind() {
  w_.iteration.reset(problem_, *tables_, path_.elements(), &w_.levels.at(first_degree));
  w_.iteration.end_at(options_.deadline);
  w_.iteration.hold_shifts(outcome_.shifts_held);
  w_.iteration.move_nodes(nodes_move_);
}

bool Refinement::count_step() {
  record();
  return !exhausted();
}

void Refinement::open(const std::vector<double>& mesh, int degree) {
  const ElementTables& tables = w_.levels.at(degree);
  path_.reset(tables, mesh, problem_.duration.value);
  take(tables);
  cost_ += filling * step_cost();
}

void Refinement::take(const ElementTables& tables) {
  longest_ = 0;
  beside_ = 1;
  mesh_kept_ = nodes_move_ = false;
  digits_ = Digits::of_double;
  outcome_.shifts_held = false;
  w_.iteration.forget();
  tables_ = &tables;
  rebind();
  most_elements_ = std::max(most_elements, most_cuts * path_.elements());
  const double wanted = std::max(most_cost, most_first_steps * step_cost());
  if (first_cost_ == 0) first_cost_ = wanted;
  most_cost_ = std::max(most_cost_, std::min(wanted, most_cost_growth * first_cost_));
}

bool Refinement::loses_digits() {
  const bool factored = w_.iteration.factor_quickly(path_);
  const Chain& chain = w_.iteration.action().nodes.chain;
  return w_.iteration.condensed() && (!factored || chain.pivoted() || !chain.deflated().empty());
}

double Refinement::step_cost() const {
  const double n = path_.coordinates(), columns = problem_.ends.free + problem_.duration.free;
  // Effort does not depend on how many elements go together: it is that of batches of the widest level.
  const double batches = static_cast<double>(path_.batches()) * path_.lanes() / most_lanes;
  const double cost =
      batches * batch_cost(*tables_, path_.degree()) + border_cost * path_.elements() * n * n * columns;
  return mesh_kept_ ? cost / extended_growth : cost;
}

Refinement::Result Refinement::pursue() {
  const double first_range = scales(path_, *tables_).range;
  const double shrinking_from = problem_.periodic ? first_range : 0;
  first_magnitude_ = scales(path_, *tables_).magnitude;
  varied_mass_ = !problem_.lagrangian->structure().quadratic;
  inertia_ = inertia();
  momentum_range_ = 0;
  held_ = INFINITY;
  if (mesh_kept_) {
    w_.iteration.action().evaluate_plain(path_);
    measure_momenta();
    if (digits_ != Digits::of_double) w_.iteration.double_digits();
    w_.iteration.extend();
    if (digits_ == Digits::doubled) w_.iteration.extend();
  }
  Attempt result = attempt();
  for (double before = INFINITY; result == Attempt::refine; before = worst_) {
    // Truncation this small that finer elements do not reduce is roundoff.
    const bool hopeless = worst_ > 0.5 * before && worst_ * options_.tolerance < amplified_roundoff;
    // Nor do they help an orbit that has shrunk onto an equilibrium: its range has no digits.
    const bool shrunk = shrank(problem_, scales(path_, *tables_).range, shrinking_from);
    if (options_.deadline.passed()) return Result::failed;
    if (hopeless || shrunk || 2 * path_.elements() > most_elements_) {
      outcome_.message = fmt::format("{} elements of degree {} do not reach the tolerance {:.1e}; loosen it",
                                     path_.elements(), path_.degree(), options_.tolerance);
      return hopeless ? Result::unreachable : Result::failed;
    }
    refine();
    result = attempt();
  }
  outcome_.tables = tables_;
  if (result == Attempt::converged) return Result::converged;
  return result == Attempt::failed ? Result::failed : Result::unreachable;
}

Refinement::Result Refinement::pursue_with_ends_at(const std::vector<double>& ends) {
  std::vector<double> mesh(path_.mesh().begin(), path_.mesh().end());
  const auto middle = mesh.insert(mesh.end(), ends.begin(), ends.end());
  std::inplace_merge(mesh.begin(), middle, mesh.end());
  mesh.erase(std::unique(mesh.begin(), mesh.end()), mesh.end());
  move_to(*tables_, mesh);
  return pursue();
}

bool Refinement::suspicious() const { return longest_ > suspicious_step; }

/// A second variation may be nearly singular only by the error of the elements: then other elements give
/// another path.
bool Refinement::confirmed() {
  if (!suspicious()) return true;
  w_.before.assign(path_.nodes().begin(), path_.nodes().end());
  raise(std::min(path_.degree() + 2, max_degree));
  const NewtonReport report =
      converge(w_.iteration, path_, *tables_, {loosest_newton, fine_steps}, [this] { return count_step(); });
  outcome_.tables = tables_;
  double moved = 0;
  for (std::size_t k = 0; k < w_.before.size(); ++k)
    moved = std::max(moved, std::abs(path_.nodes()[k] - w_.before[k]));
  return report.reached && moved <= 10 * outcome_.error + loosest_newton * scales_.q;
}

/// Finer elements may miss the same forces between their points, others less so.
bool Refinement::holds_on_other_elements() {
  const std::span<const double> mesh = path_.mesh();
  std::vector<double> other{0};
  for (std::size_t k = 0; k + 1 < mesh.size(); ++k) other.push_back(0.5 * (mesh[k] + mesh[k + 1]));
  other.push_back(1);
  w_.other.resample_from(path_, *tables_,
                         with_nodes(other, kink_times(*tables_, path_, problem_.periodic, beside_)));
  w_.before.assign(w_.other.nodes().begin(), w_.other.nodes().end());
  w_.iteration.reset(problem_, *tables_, w_.other.elements());
  w_.iteration.hold_shifts(outcome_.shifts_held);
  w_.iteration.set_scale(scales_.q);
  const NewtonReport report =
      converge(w_.iteration, w_.other, *tables_,
               {std::clamp(0.5 * options_.tolerance, least_correction, loosest_newton), fine_steps},
               [this] { return count_step(); });
  double moved = 0;
  for (std::size_t k = 0; k < w_.before.size(); ++k)
    moved = std::max(moved, std::abs(w_.other.nodes()[k] - w_.before[k]));
  rebind();
  outcome_.error = std::max(outcome_.error, moved);
  const bool holds = report.reached && moved <= options_.tolerance * scales_.q;
  if (!holds) outcome_.message = "other elements converge to another path";
  return holds;
}

void Refinement::record() {
  longest_ = std::max(longest_, w_.iteration.undamped());
  cost_ += step_cost() * w_.iteration.burden();
  outcome_.record(w_.iteration, options_);
}

/// Elements for an error of `aim`, relative; of degree 0 if it takes too many.
Plan Refinement::plan(double aim) {
  // Other elements bend a path where they begin.
  if (mesh_kept_) return {std::min(path_.degree() + 2, highest_degree), {}};
  const bool last = aim <= options_.tolerance;
  const auto error = [&](double share) {
    return Resolution::Error{share * scales_.q, last ? planned_slopes * share * scales_.v : INFINITY};
  };
  return w_.planner.plan(w_.resolution, path_.mesh(), *tables_,
                         {.aim = error(aim),
                          .tolerated = error(std::max(aim, 0.7 * options_.tolerance)),
                          .raised_degree = std::min(path_.degree() + 1, highest_degree),
                          .least_degree = first_degree + 1,
                          .highest_degree = highest_degree,
                          .most_elements = std::min(16 * path_.elements(), most_elements_),
                          .strongest_cut = 16});
}

void Refinement::raise(int degree) {
  const std::vector<double>& matrix = w_.levels.raise(path_.degree(), degree);
  tables_ = &w_.levels.at(degree);
  w_.other.interpolate_from(path_, *tables_, matrix);
  std::swap(path_, w_.other);
  rebind();
  w_.iteration.set_scale(scales_.q);
}

void Refinement::adopt(const Plan& plan) {
  if (plan.mesh.empty()) {
    if (plan.degree > path_.degree()) raise(plan.degree);
    return;
  }
  const std::vector<double> times = kink_times(*tables_, path_, problem_.periodic, beside_);
  move_to(w_.levels.at(plan.degree), times.empty() ? plan.mesh : with_nodes(plan.mesh, times));
}

/// Puts the path on other elements.
void Refinement::move_to(const ElementTables& tables, std::span<const double> mesh) {
  tables_ = &tables;
  w_.other.resample_from(path_, tables, mesh);
  std::swap(path_, w_.other);
  rebind();
  w_.iteration.set_scale(scales_.q);
}

/// Once a closed path is known it no longer crosses kinks now before and now after T: from then on elements
/// end also where it crosses them beside T.
void Refinement::end_beside_closing() { beside_ = least_beside_closing(path_.degree(), options_.tolerance); }

/// Whether a closed path crosses no kink beside t = 0, unless it does so at t = 0 itself.
bool Refinement::closes_beside_kinks() const {
  const DiscreteAction& action = w_.iteration.action();
  return std::ranges::all_of(action.corners(), [&](const Corner& corner) {
    const double away = std::abs(corner.u / corner.rate) / path_.duration();
    return corner.node < path_.elements() ||
           away <= std::max(options_.tolerance, limits::kinks::least_misplacement);
  });
}

/// Puts the path on elements that end where it crosses kinks of L, unless they do to the tolerance.
bool Refinement::end_at_kinks() {
  const auto mesh = mesh_to_kinks(*tables_, path_, problem_.periodic, options_.tolerance, beside_);
  if (mesh) move_to(*tables_, *mesh);
  return mesh.has_value();
}

/// Newton's method again, as long as the path that it found crosses kinks elsewhere than where elements end.
NewtonReport Refinement::converge_with_kinks(NewtonReport newton) {
  if (!tables_->kinks()) return newton;
  const auto on_step = [this] { return count_step(); };
  bool at_nodes = false;
  std::optional<MomentumJump> jump;
  for (int k = 0; k < most_realignments && !at_nodes && !exhausted(); ++k) {
    if (newton.reached) jump = momentum_jump(problem_, path_);
    if (jump) break;
    at_nodes = !end_at_kinks();
    if (!at_nodes)
      newton = converge(w_.iteration, path_, *tables_, {coarse_goal, steps_left(coarse_steps)}, on_step);
  }
  if (at_nodes && newton.reached) return newton;
  if (newton.reached) newton.failure = "the path crosses kinks of the Lagrangian at ever other times";
  newton.reached = false;
  if (!jump) jump = momentum_jump(problem_, path_);
  if (jump) newton.failure = describe(*jump);
  return newton;
}

/// Elements of the present degree that should know the path to a few digits, if those are more; else halves.
void Refinement::refine() {
  const int elements = path_.elements(), degree = path_.degree();
  if (degree == first_degree) {
    const Resolution::Error aim{coarse_goal * scales_.q, INFINITY, INFINITY};
    const Plan finer = w_.planner.plan(w_.resolution, path_.mesh(), *tables_,
                                       {aim, aim, degree, degree, degree, most_elements_, coarse_cut});
    if (static_cast<int>(finer.mesh.size()) > elements + 1) return adopt(finer);
  }
  w_.other.split_from(path_, *tables_, w_.levels.halve(path_.degree()));
  std::swap(path_, w_.other);
  rebind();
}

int Refinement::steps_left(int wanted) const {
  const double more = std::min((affordable() - cost_) / step_cost(), 1e6);
  return std::max(0, std::min({wanted, steps_left(), static_cast<int>(more)}));
}

/// From a path that is known, on the elements that it asks for. Where equations are as good as linear along
/// the whole path, the effort for paths that may lead nowhere does not bound its steps, unless one costs as
/// much.
NewtonReport Refinement::converge_to(double error, bool reuse) {
  const double spent = cost_;
  const bool linear = w_.iteration.expected(1) < options_.tolerance && step_cost() < affordable();
  const int steps = linear ? std::clamp(steps_left(), 0, fine_steps) : steps_left(fine_steps);
  const NewtonGoal goal{std::clamp(0.5 * error, least_correction, loosest_newton), steps, reuse,
                        std::max(options_.tolerance, error)};
  const NewtonReport report = converge(w_.iteration, path_, *tables_, goal, [&] {
    record();
    return linear ? steps_left() > 0 && !options_.deadline.passed() : !exhausted();
  });
  if (linear && report.reached) cost_ = spent;
  measure();
  return report;
}

Refinement::Attempt Refinement::attempt() {
  const auto on_step = [this] { return count_step(); };
  end_at_kinks();
  NewtonReport newton =
      approach(w_.iteration, path_, *tables_, {coarse_goal, steps_left(coarse_steps)}, saved_, on_step);
  if (newton.held) {
    const ElementTables* const coarse = tables_;
    const Attempt result = refine_from(newton);
    if (result != Attempt::failed || exhausted()) return result;
    // Steps that fail on finer elements may succeed on the coarse ones, and are cheaper there.
    path_ = saved_;
    tables_ = coarse;
    rebind();
    newton = converge(w_.iteration, path_, *coarse, {coarse_goal, steps_left(coarse_steps)}, on_step);
  }
  newton = converge_with_kinks(newton);
  outcome_.message = newton.failure;
  return newton.reached ? refine_from(newton) : Attempt::failed;
}

/// From a path that coarse elements know, to elements that meet the tolerance.
Refinement::Attempt Refinement::refine_from(NewtonReport newton) {
  measure();
  const double finest = spare * options_.tolerance;
  for (int plans = 0;; ++plans) {
    if (options_.deadline.passed()) return Attempt::failed;
    const bool risen = mesh_kept_ && path_.degree() == highest_degree;
    if (plans == most_plans || (plans > 0 && risen)) return Attempt::refine;
    // Finer elements than one more step makes use of would be wasted.
    NodeError nodes{w_.resolution.at(path_.degree()), 0, plans > 0};
    const double known = nodes.left_out.q / scales_.q + newton.remaining;
    const double aim = std::max(finest, std::min(w_.iteration.expected(known), 0.1 * known));
    const Plan next = plan(aim);
    if (next.degree == 0) {
      worst_ = INFINITY;  // not measured yet
      return Attempt::refine;
    }
    const double unfinished = 2 * newton.remaining * scales_.q;
    adopt(next);
    w_.before.assign(path_.nodes().begin(), path_.nodes().end());
    newton = converge_to(aim, false);
    if (newton.reached && aim > finest && excess(w_.resolution.at(path_.degree())) <= 1)
      newton = converge_to(finest, true);
    for (std::size_t k = 0; k < w_.before.size(); ++k)
      nodes.moved = std::max(nodes.moved, std::abs(path_.nodes()[k] - w_.before[k]));
    // The remainder of Newton's method is no error of the elements, or not all of it.
    nodes.moved = std::max(0.1 * nodes.moved, nodes.moved - unfinished);
    Attempt result = judge(newton, aim, nodes);
    // With gradients that have digits to spare, steps shrink as long as the factors allow.
    for (double before = w_.iteration.extended() ? INFINITY : 0;
         result == Attempt::unreachable && (w_.iteration.extend() || newton.remaining < 0.5 * before);) {
      before = newton.remaining;
      newton = converge_to(aim, false);
      // Where steps fail that have digits to spare, it is the equations that hide the path.
      if (!newton.reached && !options_.deadline.passed()) break;
      result = judge(newton, aim, nodes);
    }
    if (result == Attempt::converged && problem_.periodic) end_beside_closing();
    if (result == Attempt::converged && end_at_kinks()) {
      newton = converge_with_kinks(converge_to(aim, false));
      measure();
      result = newton.reached ? Attempt::refine : Attempt::failed;
      outcome_.message = newton.failure;
      worst_ = INFINITY;
    }
    if (result == Attempt::converged && !closes_beside_kinks()) {
      outcome_.message = "the orbit crosses a kink of the Lagrangian beside t = 0; shift the guess in time";
      return Attempt::failed;
    }
    if (result == Attempt::converged) {
      const Attempt satisfied = satisfy_natural_conditions(newton);
      if (satisfied == Attempt::refine) worst_ = INFINITY;
      return satisfied;
    }
    if (result != Attempt::refine) return result;
  }
}

}  // namespace extremal
