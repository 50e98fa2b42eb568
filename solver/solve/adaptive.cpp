#include "solve/adaptive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/start.hpp"

namespace extremal {

namespace {

constexpr int first_degree = 4;
constexpr int highest_degree = 16;
/// Elements are at most this long in units of 1/ω, ω the local frequency along the guess.
constexpr double longest_element = 2.0;
/// A mesh whose elements differ less than this is not worth starting again for.
constexpr double mild_grading = 3;
constexpr int most_elements = 1 << 16;
/// Coarse elements have done their work when the path is known to this, relative to its range.
constexpr double coarse_goal = 1e-3;
/// Steps allowed for one run of damped Newton.
constexpr int coarse_steps = 25;
constexpr int fine_steps = 12;
/// Corrections below this (relative) are roundoff.
constexpr double roundoff = 1e-15;
/// Newton's method goes at least so far: its error is cheap to remove and hard to bound.
constexpr double loosest_newton = 1e-6;
/// An undamped step longer than this, relative to the path, casts doubt on the equations.
constexpr double suspicious_step = 1e6;
/// Newton steps in all, times unknowns of the first mesh: what restarts may cost.
constexpr double most_work = 1e6;
constexpr double least_steps = 100;
/// Tries to move the default guess to where L is finite.
constexpr unsigned most_bends = 8;
/// Of the guess's extent, in turn.
constexpr double noise_sizes[] = {0.1, 0.3, 0.6};
/// Errors below this (relative) may be roundoff.
constexpr double near_roundoff = 1e-9;

int first_elements(const Frequency& frequency) {
  const double wanted = std::min<double>(frequency.phase() / longest_element, most_elements / 16);
  return lanes * std::max(1, static_cast<int>(std::ceil(wanted / lanes)));
}

}  // namespace

AdaptiveSolve::AdaptiveSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem), options_(options), w_(workspace) {}

void AdaptiveSolve::start(const std::vector<double>& mesh, const Bend& bend) {
  longest_ = 0;
  tables_ = &w_.levels.at(first_degree);
  w_.iteration.reset(problem_, *tables_, static_cast<int>(mesh.size()) - 1);
  w_.path.reset(*tables_, mesh, problem_.duration.value);
  start_path(problem_, ends_, *tables_, w_.path);
  bend_path(bend, *tables_, w_.path);
}

/// Puts the guess on a mesh that follows the frequency along it. The default guess is moved aside until L
/// is finite on it; false if it never is.
bool AdaptiveSolve::begin(std::vector<double>& mesh, Bend& bend) {
  mesh = uniform_mesh(lanes);
  for (unsigned seed = 0; seed <= most_bends; ++seed) {
    bend = {0.1 * seed, seed};
    start(mesh, bend);
    measure_frequency(problem_, w_.iteration.action(), *tables_, w_.path, w_.frequency);
    if (w_.frequency.finite()) break;
    if (problem_.guess.given() || seed == most_bends) return false;
  }
  const int elements = first_elements(w_.frequency);
  const double floor = problem_.guess.given() ? 0.25 : 1.0;
  if (elements == lanes && w_.frequency.grading(floor) < mild_grading) return true;
  mesh = w_.frequency.mesh(elements, floor);
  start(mesh, bend);
  return true;
}

/// Newton on a mesh, halved while it does not resolve the path.
AdaptiveSolve::Attempt AdaptiveSolve::pursue() {
  Attempt result = attempt();
  for (double before = INFINITY; result == Attempt::refine; before = worst_) {
    // Truncation this small that halving does not reduce is roundoff.
    const bool hopeless = worst_ > 0.5 * before && worst_ * options_.tolerance < near_roundoff;
    if (hopeless || 2 * w_.path.elements() > most_elements) {
      outcome_.message = fmt::format("{} elements of degree {} do not reach the tolerance {:.1e}; loosen it",
                                     w_.path.elements(), w_.path.degree(), options_.tolerance);
      return Attempt::unreachable;
    }
    halve();
    result = attempt();
  }
  return result;
}

Outcome AdaptiveSolve::run() {
  ends_ = starting_ends(problem_);
  outcome_.message = "the action is not finite along the guess";
  std::vector<double> mesh;
  Bend bend;
  if (!begin(mesh, bend)) return outcome_;
  const double unknowns = static_cast<double>(tables_->unknowns()) * w_.path.elements();
  most_steps_ =
      std::min(options_.max_iterations, static_cast<int>(std::max(least_steps, most_work / unknowns)));
  Attempt result = pursue();
  const std::string first_failure = outcome_.message;
  // Finer elements first, then other guesses, while the steps allowed last.
  if (result == Attempt::failed) {
    start(halved(mesh), bend);
    result = pursue();
  }
  for (unsigned k = 0; result == Attempt::failed && outcome_.iterations < most_steps_; ++k) {
    outcome_.strategy = "newton from the guess plus smooth noise";
    start(mesh, {noise_sizes[k % std::size(noise_sizes)], k});
    result = pursue();
  }
  if (result == Attempt::failed && outcome_.iterations >= most_steps_) {
    outcome_.status = Status::iteration_limit;
    outcome_.message = fmt::format(
        "{} Newton steps from the guess and others found no extremal (from the guess: {}); "
        "try a better guess or a shorter duration",
        outcome_.iterations, first_failure);
  }
  if (outcome_.status != Status::converged ? longest_ > suspicious_step : !confirmed()) {
    outcome_.status = Status::conjugate_ends;
    outcome_.message =
        "the second variation is singular or nearly so: the ends may be conjugate, with no extremal or a "
        "family of them; move an end or the duration";
  }
  outcome_.tables = tables_;
  return outcome_;
}

/// A step much longer than the path means a second variation that is nearly singular, and perhaps only by
/// the error of the elements: then other elements give another path.
bool AdaptiveSolve::confirmed() {
  if (longest_ < suspicious_step) return true;
  w_.before.assign(w_.path.nodes().begin(), w_.path.nodes().end());
  raise(std::min(w_.path.degree() + 2, max_degree));
  const NewtonReport report =
      converge(w_.iteration, w_.path, *tables_, {loosest_newton, fine_steps}, [this] { report_step(); });
  double moved = 0;
  for (std::size_t k = 0; k < w_.before.size(); ++k)
    moved = std::max(moved, std::abs(w_.path.nodes()[k] - w_.before[k]));
  return report.reached && moved <= 10 * outcome_.error + loosest_newton * scales_.q;
}

void AdaptiveSolve::report_step() {
  ++outcome_.iterations;
  longest_ = std::max(longest_, w_.iteration.undamped());
  if (options_.progress)
    options_.progress({.elements = w_.path.elements(),
                       .degree = w_.path.degree(),
                       .residual = w_.iteration.action().residual(),
                       .step = w_.iteration.norm(),
                       .damping = w_.iteration.damping()});
}

/// In units of what the tolerance allows.
double AdaptiveSolve::excess(const Resolution::Error& error) const {
  if (error.q == 0 && error.v == 0) return 0;  // at rest
  return std::max(error.q / scales_.q, 0.1 * error.v / scales_.v) / options_.tolerance;
}

/// The least degree that resolves the path to the tolerance, or one above the highest.
int AdaptiveSolve::needed_degree() const {
  const Resolution::Error allowed{options_.tolerance * scales_.q, 10 * options_.tolerance * scales_.v};
  const int degree = w_.resolution.degree_for({0.5 * allowed.q, 0.5 * allowed.v}, highest_degree);
  return degree > highest_degree ? w_.resolution.degree_for(allowed, highest_degree) : degree;
}

void AdaptiveSolve::raise(int degree) {
  const std::vector<double>& matrix = w_.levels.raise(w_.path.degree(), degree);
  tables_ = &w_.levels.at(degree);
  w_.other.interpolate_from(w_.path, *tables_, matrix);
  std::swap(w_.path, w_.other);
  w_.iteration.reset(problem_, *tables_, w_.path.elements());
  w_.iteration.set_scale(scales_.q);
}

void AdaptiveSolve::halve() {
  w_.other.split_from(w_.path, *tables_, w_.levels.halve(w_.path.degree()));
  std::swap(w_.path, w_.other);
  w_.iteration.reset(problem_, *tables_, w_.path.elements());
}

int AdaptiveSolve::steps_left(int wanted) const {
  return std::max(0, std::min(wanted, most_steps_ - outcome_.iterations));
}

AdaptiveSolve::Attempt AdaptiveSolve::attempt() {
  const auto on_step = [this] { report_step(); };
  const NewtonReport coarse =
      converge(w_.iteration, w_.path, *tables_, {coarse_goal, steps_left(coarse_steps)}, on_step);
  outcome_.message = coarse.failure;
  if (!coarse.reached) return Attempt::failed;
  NodeError nodes;
  for (bool again = false;;) {
    scales_ = scales(w_.path, *tables_);
    w_.resolution.measure(w_.path, *tables_);
    // At least one more, which tells how far off the nodes are.
    const int degree = std::max(needed_degree(), std::min(w_.path.degree() + 1, highest_degree));
    if (degree > highest_degree) {
      worst_ = INFINITY;  // not measured yet
      return Attempt::refine;
    }
    nodes = {w_.resolution.at(w_.path.degree()).q, 0, again};
    again = true;
    if (degree > w_.path.degree()) raise(degree);
    w_.before.assign(w_.path.nodes().begin(), w_.path.nodes().end());
    const NewtonGoal goal{std::clamp(0.05 * options_.tolerance, roundoff, loosest_newton),
                          steps_left(fine_steps)};
    const NewtonReport fine = converge(w_.iteration, w_.path, *tables_, goal, on_step);
    for (std::size_t k = 0; k < w_.before.size(); ++k)
      nodes.moved = std::max(nodes.moved, std::abs(w_.path.nodes()[k] - w_.before[k]));
    // What Newton's method had left to do is no error of the elements.
    nodes.moved = std::max(0.0, nodes.moved - 2 * coarse.remaining * scales_.q);
    const Attempt result = judge(fine, nodes);
    if (result != Attempt::refine || w_.path.degree() == highest_degree) return result;
  }
}

/// What a converged iteration has reached: coefficients that its elements leave out; the error of the nodes,
/// which falls with the square of those (order 2s against s + 1) from what the nodes moved when the
/// degree rose; corrections not made; roundoff, a random walk over the points.
AdaptiveSolve::Attempt AdaptiveSolve::judge(const NewtonReport& newton, const NodeError& nodes) {
  outcome_.message = newton.failure;
  if (!newton.reached) return Attempt::failed;
  scales_ = scales(w_.path, *tables_);
  w_.resolution.measure(w_.path, *tables_);
  Resolution::Error error = w_.resolution.at(w_.path.degree());
  const double fall = nodes.truncation > 0 ? std::min(1.0, error.q / nodes.truncation) : 0;
  const double points = static_cast<double>(w_.path.elements()) * w_.path.degree();
  const double truncation = error.q + 0x1p-53 * scales_.magnitude * std::sqrt(points);
  const double at_nodes = nodes.moved * fall * fall;
  error.q = truncation + at_nodes;
  outcome_.tolerance = options_.tolerance * scales_.q;
  outcome_.error = error.q + newton.remaining * scales_.q;
  if (newton.remaining > options_.tolerance) {
    outcome_.message =
        fmt::format("roundoff, amplified to {:.1e} of the range, hides the tolerance {:.1e}; loosen it",
                    newton.remaining, options_.tolerance);
    return Attempt::unreachable;
  }
  worst_ = excess(error);
  if (!(worst_ <= 1)) return Attempt::refine;
  // Much movement may have been Newton's, not the elements': from this converged path it is not.
  if (at_nodes > 3 * truncation && !nodes.from_converged && w_.path.degree() < highest_degree)
    return Attempt::refine;
  outcome_.status = Status::converged;
  outcome_.message = "converged";
  return Attempt::converged;
}

}  // namespace extremal
