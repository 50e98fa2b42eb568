#include "solve/refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

constexpr int highest_degree = 16;
/// Elements at most, or so many times those of the first mesh: a path that needs more meets a singularity.
constexpr int most_elements = 1 << 12, most_cuts = 64;
/// Coarse elements have done their work when the path is known to this, relative to its range.
constexpr double coarse_goal = 1e-3;
/// A coarse element becomes at most so many at a time.
constexpr double coarse_cut = 4;
/// Steps allowed for one run of damped Newton.
constexpr int coarse_steps = 25;
constexpr int fine_steps = 12;
/// Corrections below this (relative) are roundoff.
constexpr double roundoff = 1e-15;
/// Newton's method goes at least so far: its error is cheap to remove and hard to bound.
constexpr double loosest_newton = 1e-6;
/// A force that holds the phase of a periodic path, relative to the largest momentum, is at most so large.
constexpr double most_phase_force = 1e-7;
/// Steps that end what Newton's method began.
constexpr int most_polish = 3;
/// They use the factors there are as long as they contract so much.
constexpr double worst_chord = 0.5;
/// Times that elements are planned before all are halved.
constexpr int most_plans = 6;
/// Elements are planned for this share of the tolerance: one more round costs more than a higher degree.
constexpr double spare = 0.1;
/// An undamped step longer than this, relative to the path, casts doubt on the equations.
constexpr double suspicious_step = 1e6;
/// Of the size of the path that was started from: a path smaller than this is at rest.
constexpr double rest = 1e-12;
/// Nanoseconds, by batch_cost(), that one solve may take; or so many steps on the first mesh.
constexpr double most_cost = 1e8, most_first_steps = 200;
/// Nanoseconds of a free end or duration, for each entry of the blocks of the nodes.
constexpr double border_cost = 2;
/// Errors below this (relative) may be roundoff.
constexpr double near_roundoff = 1e-9;

}  // namespace

Refinement::Refinement(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                       Outcome& outcome)
    : problem_(problem), options_(options), w_(workspace), outcome_(outcome) {}

void Refinement::rebind() {
  w_.iteration.reset(problem_, *tables_, w_.path.elements(), &w_.levels.at(first_degree));
}

bool Refinement::count_step() {
  record();
  return !exhausted();
}

void Refinement::open(const std::vector<double>& mesh, int degree) {
  const ElementTables& tables = w_.levels.at(degree);
  w_.path.reset(tables, mesh, problem_.duration.value);
  take(tables);
}

void Refinement::take(const ElementTables& tables) {
  longest_ = 0;
  w_.iteration.forget();
  tables_ = &tables;
  rebind();
  most_elements_ = std::max(most_elements, most_cuts * w_.path.elements());
  most_cost_ = std::max({most_cost_, most_cost, most_first_steps * step_cost()});
}

double Refinement::step_cost() const {
  const double n = w_.path.coordinates(), columns = problem_.ends.free + problem_.duration.free;
  return w_.path.batches() * batch_cost(*tables_, w_.path.degree()) +
         border_cost * w_.path.elements() * n * n * columns;
}

Refinement::Result Refinement::pursue() {
  first_magnitude_ = scales(w_.path, *tables_).magnitude;
  Attempt result = attempt();
  for (double before = INFINITY; result == Attempt::refine; before = worst_) {
    // Truncation this small that finer elements do not reduce is roundoff.
    const bool hopeless = worst_ > 0.5 * before && worst_ * options_.tolerance < near_roundoff;
    if (hopeless || 2 * w_.path.elements() > most_elements_) {
      outcome_.message = fmt::format("{} elements of degree {} do not reach the tolerance {:.1e}; loosen it",
                                     w_.path.elements(), w_.path.degree(), options_.tolerance);
      return hopeless ? Result::unreachable : Result::failed;
    }
    refine();
    result = attempt();
  }
  outcome_.tables = tables_;
  if (result == Attempt::converged) return Result::converged;
  return result == Attempt::failed ? Result::failed : Result::unreachable;
}

bool Refinement::suspicious() const { return longest_ > suspicious_step; }

/// A second variation may be nearly singular only by the error of the elements: then other elements give
/// another path.
bool Refinement::confirmed() {
  if (!suspicious()) return true;
  w_.before.assign(w_.path.nodes().begin(), w_.path.nodes().end());
  raise(std::min(w_.path.degree() + 2, max_degree));
  const NewtonReport report = converge(w_.iteration, w_.path, *tables_, {loosest_newton, fine_steps},
                                       [this] { return count_step(); });
  outcome_.tables = tables_;
  double moved = 0;
  for (std::size_t k = 0; k < w_.before.size(); ++k)
    moved = std::max(moved, std::abs(w_.path.nodes()[k] - w_.before[k]));
  return report.reached && moved <= 10 * outcome_.error + loosest_newton * scales_.q;
}

/// Finer elements would not see what happens between the points of those there are, others may.
bool Refinement::holds_on_other_elements() {
  const std::span<const double> mesh = w_.path.mesh();
  std::vector<double> other{0};
  for (std::size_t k = 0; k + 1 < mesh.size(); ++k) other.push_back(0.5 * (mesh[k] + mesh[k + 1]));
  other.push_back(1);
  w_.other.resample_from(w_.path, *tables_, other);
  w_.before.assign(w_.other.nodes().begin(), w_.other.nodes().end());
  w_.iteration.reset(problem_, *tables_, w_.other.elements());
  w_.iteration.set_scale(scales_.q);
  const NewtonReport report =
      converge(w_.iteration, w_.other, *tables_,
               {std::clamp(0.5 * options_.tolerance, roundoff, loosest_newton), fine_steps},
               [this] { return count_step(); });
  double moved = 0;
  for (std::size_t k = 0; k < w_.before.size(); ++k)
    moved = std::max(moved, std::abs(w_.other.nodes()[k] - w_.before[k]));
  rebind();
  outcome_.error = std::max(outcome_.error, moved);
  const bool holds = report.reached && moved <= options_.tolerance * scales_.q;
  if (!holds) outcome_.message = "other elements told another path";
  return holds;
}

void Refinement::record() {
  longest_ = std::max(longest_, w_.iteration.undamped());
  cost_ += step_cost() * w_.iteration.burden();
  outcome_.record(w_, options_);
}

/// In units of what the tolerance allows.
double Refinement::excess(const Resolution::Error& error) const {
  if (error.q == 0 && error.v == 0) return 0;  // at rest
  return std::max(error.q / scales_.q, 0.1 * error.v / scales_.v) / options_.tolerance;
}

/// Elements for an error of `aim`, relative; of degree 0 if it takes too many.
Plan Refinement::plan(double aim) {
  const bool last = aim <= options_.tolerance;
  const auto error = [&](double share) {
    return Resolution::Error{share * scales_.q, last ? 10 * share * scales_.v : INFINITY};
  };
  return w_.planner.plan(w_.resolution, w_.path.mesh(), *tables_,
                         {.aim = error(aim),
                          .tolerated = error(std::max(aim, 0.7 * options_.tolerance)),
                          .raised_degree = std::min(w_.path.degree() + 1, highest_degree),
                          .least_degree = first_degree + 1,
                          .highest_degree = highest_degree,
                          .most_elements = std::min(16 * w_.path.elements(), most_elements_),
                          .strongest_cut = 16});
}

void Refinement::raise(int degree) {
  const std::vector<double>& matrix = w_.levels.raise(w_.path.degree(), degree);
  tables_ = &w_.levels.at(degree);
  w_.other.interpolate_from(w_.path, *tables_, matrix);
  std::swap(w_.path, w_.other);
  rebind();
  w_.iteration.set_scale(scales_.q);
}

void Refinement::adopt(const Plan& plan) {
  if (plan.mesh.empty()) {
    if (plan.degree > w_.path.degree()) raise(plan.degree);
    return;
  }
  tables_ = &w_.levels.at(plan.degree);
  w_.other.resample_from(w_.path, *tables_, plan.mesh);
  std::swap(w_.path, w_.other);
  rebind();
  w_.iteration.set_scale(scales_.q);
}

/// Elements of the present degree that should know the path to a few digits, if those are more; else halves.
void Refinement::refine() {
  const int elements = w_.path.elements(), degree = w_.path.degree();
  if (degree == first_degree) {
    const Resolution::Error aim{coarse_goal * scales_.q, INFINITY, INFINITY};
    const Plan finer = w_.planner.plan(w_.resolution, w_.path.mesh(), *tables_,
                                       {aim, aim, degree, degree, degree, most_elements_, coarse_cut});
    if (static_cast<int>(finer.mesh.size()) > elements + 1) return adopt(finer);
  }
  w_.other.split_from(w_.path, *tables_, w_.levels.halve(w_.path.degree()));
  std::swap(w_.path, w_.other);
  rebind();
}

int Refinement::steps_left(int wanted) const {
  const double affordable = std::min((share_ * most_cost_ - cost_) / step_cost(), 1e6);
  return std::max(0, std::min({wanted, steps_left(), static_cast<int>(affordable)}));
}

void Refinement::measure() {
  scales_ = scales(w_.path, *tables_);
  scales_.q = std::max(scales_.q, rest * first_magnitude_);
  scales_.v = std::max(scales_.v, rest * first_magnitude_ / w_.path.duration());
  w_.resolution.measure(w_.path, *tables_);
}

NewtonReport Refinement::converge_to(double error, bool reuse) {
  const NewtonGoal goal{std::clamp(0.5 * error, roundoff, loosest_newton), steps_left(fine_steps), reuse,
                        std::max(options_.tolerance, error)};
  const NewtonReport report =
      converge(w_.iteration, w_.path, *tables_, goal, [this] { return count_step(); });
  measure();
  return report;
}

Refinement::Attempt Refinement::attempt() {
  NewtonReport newton = approach(w_.iteration, w_.path, *tables_, {coarse_goal, steps_left(coarse_steps)},
                                 w_.saved, [this] { return count_step(); });
  outcome_.message = newton.failure;
  if (!newton.reached) return Attempt::failed;
  measure();
  const double finest = spare * options_.tolerance;
  for (int plans = 0;; ++plans) {
    // Finer elements than one more step makes use of would be wasted.
    NodeError nodes{w_.resolution.at(w_.path.degree()), 0, plans > 0};
    const double known = nodes.left_out.q / scales_.q + newton.remaining;
    const double reach = std::min(w_.iteration.expected(known), 0.1 * known);
    const double aim = std::max(finest, reach);
    const Plan next = plan(aim);
    if (next.degree == 0) worst_ = INFINITY;  // not measured yet
    if (next.degree == 0 || plans == most_plans) return Attempt::refine;
    const double unfinished = 2 * newton.remaining * scales_.q;
    adopt(next);
    w_.before.assign(w_.path.nodes().begin(), w_.path.nodes().end());
    newton = converge_to(aim, false);
    if (newton.reached && aim > finest && excess(w_.resolution.at(w_.path.degree())) <= 1)
      newton = converge_to(finest, true);
    for (std::size_t k = 0; k < w_.before.size(); ++k)
      nodes.moved = std::max(nodes.moved, std::abs(w_.path.nodes()[k] - w_.before[k]));
    // What Newton's method had left to do is no error of the elements, or not all of it.
    nodes.moved = std::max(0.1 * nodes.moved, nodes.moved - unfinished);
    const Attempt result = judge(newton, aim, nodes);
    if (result == Attempt::converged) {
      const Attempt settled = settle();
      if (settled == Attempt::refine) worst_ = INFINITY;
      return settled;
    }
    if (result != Attempt::refine) return result;
  }
}

/// One more step of a path whose ends are free: natural conditions ask more of momenta than q may need, and
/// along directions that are nearly null its length is roundoff amplified, an error that nothing else shows.
/// A residual that was left within the tolerance becomes roundoff in a few.
Refinement::Attempt Refinement::settle() {
  if (problem_.ends.free == 0) return Attempt::converged;
  const double phase = problem_.periodic ? std::min(spare * options_.tolerance, most_phase_force) : 0;
  NewtonIteration& newton = w_.iteration;
  bool passed = false;
  for (int step = 0; step <= most_polish; ++step) {
    const bool again = step == 0 || newton.contraction() <= worst_chord;
    const StepResult result = again ? newton.chord_step(w_.path) : newton.full_step(w_.path, 0);
    record();
    passed = result == StepResult::ok && test_.passed(problem_, newton, w_.path, phase);
    if (passed && newton.norm() <= options_.tolerance) {
      outcome_.error += newton.norm() * scales_.q;
      return Attempt::converged;
    }
    const double allowed = std::min(10 * options_.tolerance, loosest_newton);
    if (result != StepResult::ok || test_.share() > allowed || exhausted()) break;
  }
  outcome_.message = passed ? hidden(newton.norm()) : test_.message();
  if (passed) return Attempt::unreachable;
  // What holds the phase is an error of the elements.
  return problem_.periodic && test_.share() <= options_.tolerance ? Attempt::refine : Attempt::failed;
}

/// A tolerance, by what roundoff became.
std::string Refinement::hidden(double amplified) const {
  return fmt::format("roundoff, amplified to {:.1e} of the range, hides the tolerance {:.1e}; loosen it",
                     amplified, options_.tolerance);
}

/// What a converged iteration has reached: coefficients that its elements leave out; the error of the nodes,
/// which comes from the forces and velocities left out and falls with their product (order 2s) from what
/// the nodes moved when the elements changed; corrections not made; roundoff, a random walk over the points.
Refinement::Attempt Refinement::judge(const NewtonReport& newton, double aim, const NodeError& nodes) {
  outcome_.message = newton.failure;
  if (!newton.reached) return Attempt::failed;
  Resolution::Error error = w_.resolution.at(w_.path.degree());
  const Resolution::Error& before = nodes.left_out;
  const double fall = before.v > 0 ? (error.a / before.a) * (error.v / before.v) : 0;
  const double points = static_cast<double>(w_.path.elements()) * w_.path.degree();
  const double roundoff = 0x1p-53 * scales_.magnitude * std::sqrt(points);
  const double truncation = error.q + roundoff;
  const double at_nodes = nodes.moved * std::min(1.0, fall);
  error.q = truncation + at_nodes;
  outcome_.tolerance = options_.tolerance * scales_.q;
  outcome_.error = error.q + newton.most_remaining * scales_.q;
  if (newton.remaining > std::max(options_.tolerance, aim)) {
    outcome_.message = hidden(newton.remaining);
    return Attempt::unreachable;
  }
  // Of so many walks the longest is expected to be this much longer than one.
  error.q += roundoff * (std::sqrt(2 * std::log(points * w_.path.coordinates())) - 1);
  worst_ = excess(error);
  if (!(worst_ <= 1)) return Attempt::refine;
  // Much movement may have been Newton's, not the elements': from this converged path it is not.
  if (at_nodes > truncation && !nodes.from_converged && w_.path.degree() < highest_degree)
    return Attempt::refine;
  outcome_.message = "converged";
  return Attempt::converged;
}

}  // namespace extremal
