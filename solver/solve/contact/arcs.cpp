#include "solve/contact/arcs.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "action/rule.hpp"
#include "problem/shift.hpp"
#include "solution/guessed_by.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::VectorXd;

std::vector<double> values_of(const VectorXd& v) { return {v.begin(), v.end()}; }

VectorXd vector_of(const std::vector<double>& v) {
  return Eigen::Map<const VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Of the first attempt.
double arc_tolerance(const SolveOptions& options) {
  return std::max(arc_share * options.tolerance, std::min(least_arc_tolerance, options.tolerance));
}

/// What roundoff of q allows, relative to the largest range of a coordinate: little in a short arc.
double attainable(const Guess& guess, std::size_t n) {
  double range = 0, largest = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double low = guess.q[a], high = low;
    for (std::size_t i = a; i < guess.q.size(); i += n) {
      low = std::min(low, guess.q[i]);
      high = std::max(high, guess.q[i]);
    }
    range = std::max(range, high - low);
    largest = std::max({largest, std::abs(low), std::abs(high)});
  }
  const double relative = arc_roundoff * largest / range;
  return relative < most_arc_tolerance ? relative : most_arc_tolerance;
}

/// A guess whose ends are moved to those of the arc, all of it in proportion.
Guess fitted(const PathArc& arc) {
  const std::size_t n = arc.start.size();
  Guess guess = arc.guess;
  if (!guess.given()) {
    guess.tau = {0, 1};
    guess.q = values_of(arc.start);
    guess.q.insert(guess.q.end(), arc.end.begin(), arc.end.end());
    return guess;
  }
  std::vector<double> first(n), last(n);
  guess.at(0, first);
  guess.at(1, last);
  for (std::size_t k = 0; k < guess.tau.size(); ++k)
    for (std::size_t a = 0; a < n; ++a)
      guess.q[k * n + a] +=
          (1 - guess.tau[k]) * (arc.start[a] - first[a]) + guess.tau[k] * (arc.end[a] - last[a]);
  return guess;
}

}  // namespace

void put_guess(const SolvedArc& solved, PathArc& arc) {
  arc.guess = guess_of(solved.trajectory);
  for (std::size_t w = 0; w < arc.waypoints.size(); ++w)
    if (arc.waypoints[w].free)
      arc.waypoints[w].time = (solved.waypoints[w].time - arc.from) / (arc.to - arc.from);
}

Arcs::Arcs(const Problem& problem, const SolveOptions& options, const ArcSolve& solve)
    : problem_(problem), options_(options), solve_(solve) {}

HeldSystem Arcs::build(const std::vector<int>& held, const std::vector<double>& constants) const {
  if (!held.empty()) return problem_.inequalities->hold(held, constants);
  if (constants.empty()) return {problem_.lagrangian, problem_.manifold};
  const Extension& extension = *problem_.extension;
  return {extension.at(constants), problem_.manifold ? extension.manifold_at(constants) : nullptr};
}

const HeldSystem& Arcs::system(const std::vector<int>& held, const std::vector<double>& constants) {
  const auto found = systems_.find(held);
  if (found != systems_.end() && found->second.constants == constants) return found->second.system;
  return (systems_[held] = {constants, build(held, constants)}).system;
}

std::shared_ptr<const Manifold> Arcs::inequalities(const std::vector<double>& constants) {
  if (!problem_.inequalities->at) return problem_.inequalities->all;
  if (!inequalities_ || constants != constants_) {
    constants_ = constants;
    inequalities_ = problem_.inequalities->at(constants);
  }
  return inequalities_;
}

bool Arcs::project(const std::vector<int>& held, const std::vector<double>& constants, double t,
                   VectorXd& q) {
  const std::shared_ptr<const Manifold> onto = manifold(held, constants);
  return !onto || onto->project({q.data(), static_cast<std::size_t>(q.size())}, t);
}

/// Whether constraints and inequalities alone determine the path.
bool Arcs::determined(const std::vector<int>& held) const {
  return static_cast<int>(held.size()) + constraints() == problem_.coordinates();
}

SolvedArc Arcs::solve(const PathArc& arc) {
  SolvedArc none;
  if (!(arc.to > arc.from)) {
    none.message = "an arc has no length";
    return none;
  }
  for (const WaypointCondition& waypoint : arc.waypoints) {
    // Of a point that is fixed in part, impulses across the surface would act on the coordinates left free.
    if (determined(arc.held)) {
      none.message = "a waypoint lies within a contact that determines the path; leave the waypoint out";
      return none;
    }
    if (!arc.held.empty() && std::ssize(waypoint.fixed) < arc.start.size()) {
      none.message = "a waypoint that leaves coordinates free lies within a contact";
      return none;
    }
    if (!waypoint.free && !(waypoint.time > arc.from && waypoint.time < arc.to)) {
      none.message = "a contact begins or ends at a waypoint";
      return none;
    }
  }
  if (determined(arc.held)) return solve_determined(arc);
  const double least = attainable(fitted(arc), arc.start.size());
  SolvedArc solved = solve_extremal(arc, std::max(arc_tolerance(options_), least));
  if (!solved.found) solved = solve_extremal(arc, std::max(arc_share_again * options_.tolerance, 2 * least));
  if (!solved.found) {  // what is left of a path that rests may be no guess
    PathArc line = arc;
    line.guess = {};
    const double coarse = 2 * attainable(fitted(line), arc.start.size());
    solved = solve_extremal(line, std::max(arc_share_again * options_.tolerance, coarse));
  }
  return solved;
}

SolvedArc Arcs::solve_extremal(const PathArc& arc, double tolerance) {
  const HeldSystem& system = this->system(arc.held, arc.constants);
  const int n = problem_.coordinates();
  Problem problem;
  problem.lagrangian = shift_time(system.lagrangian, arc.from);
  if (system.manifold) problem.manifold = shift_time(system.manifold, arc.from);
  problem.names = problem_.names;
  problem.boundary.coordinates = n;
  for (int a = 0; a < n; ++a) problem.boundary.fix(a, false, arc.start[a]);
  for (int a = 0; a < n; ++a) problem.boundary.fix(a, true, arc.end[a]);
  problem.duration.value = arc.to - arc.from;
  problem.guess = fitted(arc);
  if (!arc.waypoints.empty()) {
    auto extension = std::make_shared<Extension>();
    extension->lagrangian = problem.lagrangian;
    extension->waypoints = arc.waypoints;
    for (WaypointCondition& waypoint : extension->waypoints)
      if (!waypoint.free) waypoint.time -= arc.from;
    extension->at = [l = problem.lagrangian](const std::vector<double>&) { return l; };
    extension->manifold_at = [m = problem.manifold](const std::vector<double>&) { return m; };
    problem.extension = std::move(extension);
  }
  return solve_problem(arc, std::move(problem), tolerance);
}

SolvedArc Arcs::solve_closed(const PathArc& arc) {
  if (determined(arc.held)) {
    if (!problem_.duration.free) return solve_determined(arc);
    SolvedArc none;
    none.message = "a path that is held throughout has no duration of its own";
    return none;
  }
  const HeldSystem& system = this->system(arc.held, arc.constants);
  Problem problem = problem_;
  problem.inequalities = nullptr;
  problem.lagrangian = system.lagrangian;
  problem.manifold = system.manifold;
  problem.guess = arc.guess;
  return solve_problem(arc, std::move(problem), arc_tolerance(options_));
}

SolvedArc Arcs::solve_problem(const PathArc& arc, Problem problem, double tolerance) {
  const auto n = static_cast<std::size_t>(problem_.coordinates());
  if (problem.manifold)
    for (std::size_t k = 0; k < problem.guess.tau.size(); ++k)
      problem.manifold->project({problem.guess.q.data() + k * n, n},
                                problem.guess.tau[k] * problem.duration.value);
  SolveOptions options = options_;
  options.tolerance = tolerance;
  options.method = Method::newton;
  SolvedArc result;
  try {
    problem = make_problem(std::move(problem));
  } catch (const std::exception& e) {
    result.message = e.what();
    return result;
  }
  Solution solution = solve_(problem, options);
  iterations_ += solution.iterations;
  result.found = solution.converged();
  result.message = std::move(solution.message);
  if (!result.found) return result;
  result.trajectory = std::move(solution.trajectory);
  result.action = solution.action;
  result.error = solution.error_estimate;
  result.residual = solution.residual;
  result.iterations = solution.iterations;
  result.degree = solution.degree;
  result.minimizing = !solution.morse_index || *solution.morse_index == 0;
  if (solution.extension) result.waypoints = solution.extension->waypoints;
  for (WaypointImpulse& waypoint : result.waypoints) waypoint.time += arc.from;
  measure(arc, result);
  result.p_start = vector_of(solution.momentum_start);
  result.p_end = vector_of(solution.momentum_end);
  // By these, which are more accurate than velocities, the energy is right to second order.
  const double later = arc.from + result.trajectory.duration();
  std::vector<double> q(n), v(n);
  result.trajectory.at(result.trajectory.duration(), q, v);
  Scratch scratch;
  result.energy_end =
      result.p_end.dot(result.v_end) -
      evaluate_at(motion(arc.constants), q, values_of(result.v_end), later, Order::value, scratch).value;
  integrate(arc, result);
  return result;
}

/// The derivatives of L + Σ ν g by ν.
void Arcs::integrate(const PathArc& arc, SolvedArc& solved) const {
  if (!problem_.extension) return;
  const Extension& extension = *problem_.extension;
  const std::size_t n = problem_.coordinates(), m = extension.multipliers(), first = n + extension.unknowns();
  const Rule rule = gauss_rule(std::min(solved.trajectory.degree + 2, max_points));
  solved.integrals.assign(m, 0);
  if (m == 0) return;
  std::vector<double> q(first + m), v(first + m, 0);
  std::ranges::copy(arc.constants, q.begin() + static_cast<std::ptrdiff_t>(n));
  Scratch scratch;
  for (int k = 0; k < solved.trajectory.elements(); ++k)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double h = solved.trajectory.length(k);
      solved.trajectory.in_element(k, rule.nodes[i], std::span(q).first(n), std::span(v).first(n));
      const double t = arc.from + solved.trajectory.times[k] + rule.nodes[i] * h;
      const PointValues l = evaluate_at(*extension.lagrangian, q, v, t, Order::gradient, scratch);
      for (std::size_t j = 0; j < m; ++j) solved.integrals[j] += rule.weights[i] * h * l.dq[first + j];
    }
}

/// Velocities at the ends, and momenta by them.
void Arcs::measure(const PathArc& arc, SolvedArc& solved) {
  const int n = problem_.coordinates();
  const std::shared_ptr<const Manifold> onto = manifold(arc);
  Scratch scratch;
  for (const bool at_end : {false, true}) {
    std::vector<double> q(n), v(n);
    const double t = arc.from + (at_end ? solved.trajectory.duration() : 0);
    solved.trajectory.at(at_end ? solved.trajectory.duration() : 0, q, v);
    if (onto) onto->make_tangent(q, t, v);
    const PointValues l = evaluate_at(motion(arc.constants), q, v, t, Order::gradient, scratch);
    (at_end ? solved.v_end : solved.v_start) = vector_of(v);
    (at_end ? solved.p_end : solved.p_start) = vector_of(l.dv);
    if (at_end) solved.energy_end = solved.p_end.dot(solved.v_end) - l.value;
  }
}

/// As many constraints as coordinates: they alone determine the path.
SolvedArc Arcs::solve_determined(const PathArc& arc) {
  const std::size_t n = problem_.coordinates();
  const std::shared_ptr<const Manifold> onto = manifold(arc);
  const double duration = arc.to - arc.from;
  const Guess guess = fitted(arc);
  SolvedArc result;
  const auto state = [&](double tau, std::span<double> q, std::span<double> v) {
    guess.at(tau, q);
    std::ranges::fill(v, 0.0);
    if (!onto->project(q, arc.from + tau * duration)) return false;
    onto->make_tangent(q, arc.from + tau * duration, v);
    return true;
  };
  const std::size_t s = held_degree;
  const Basis& basis = lobatto_nodal_basis(held_degree);
  const Rule rule = gauss_rule(held_degree + 2);
  std::vector<double> q(n), v(n), between(n), slope(n);
  Scratch scratch;
  for (int elements = 1; elements <= most_held_elements; elements *= 2) {
    Trajectory path{static_cast<int>(n), held_degree, {}, {}};
    for (int k = 0; k <= elements; ++k)
      path.times.push_back(k == elements ? duration : duration * k / elements);
    double size = 0, error = 0;
    for (int k = 0; k < elements; ++k)
      for (std::size_t j = 0; j <= s; ++j) {
        if (!state((path.times[k] + basis.points[j] * path.length(k)) / duration, q, v)) {
          result.message = "the inequalities that are held do not determine the path";
          return result;
        }
        path.nodes.insert(path.nodes.end(), q.begin(), q.end());
        path.slopes.insert(path.slopes.end(), v.begin(), v.end());
        for (const double x : q) size = std::max(size, std::abs(x));
      }
    result.action = 0;
    for (int k = 0; k < elements; ++k)
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double t = path.times[k] + rule.nodes[i] * path.length(k);
        if (!state(t / duration, q, v)) return result;
        path.in_element(k, rule.nodes[i], between, slope);
        for (std::size_t a = 0; a < n; ++a)
          error = std::max({error, std::abs(q[a] - between[a]), 0.1 * duration * std::abs(v[a] - slope[a])});
        result.action += rule.weights[i] * path.length(k) *
                         evaluate_at(motion(arc.constants), q, v, arc.from + t, Order::value, scratch).value;
      }
    result.error = error;
    result.trajectory = std::move(path);
    if (error <= std::max(arc_share * options_.tolerance, least_arc_tolerance) * size) break;
  }
  result.degree = held_degree;
  result.found = std::isfinite(result.action);
  measure(arc, result);
  integrate(arc, result);
  return result;
}

}  // namespace extremal
