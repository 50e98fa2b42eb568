#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "motion/flow.hpp"
#include "problem/closing.hpp"
#include "solution/observe.hpp"
#include "solve/branch/branch_point.hpp"
#include "solve/branch/limits.hpp"
#include "solve/periodic/orbit_index.hpp"
#include "solve/periodic/stability.hpp"

/// \file All that is known of a state on a branch.

namespace extremal {

namespace {

/// The mean along the path is ∫p·q' dt by the range of q: momenta are small at both ends of a swing between
/// points of rest.
double momentum_difference(Tracker& tracker, const Solution& solution) {
  const Trajectory& trajectory = solution.trajectory;
  const std::size_t n = trajectory.coordinates;
  const double swept = std::abs(solution.action + solution.energy.value_or(0) * solution.duration());
  const double range = tracker.sizes().range;
  double worst = 0, largest = range > 0 ? swept / range : 0;
  for (const bool end : {false, true}) {
    const double t = end ? solution.duration() : 0;
    const std::size_t first = end ? trajectory.nodes.size() - n : 0;
    const PointValues at =
        evaluate_at(*tracker.branch().problem().lagrangian, {trajectory.nodes.data() + first, n},
                    {trajectory.slopes.data() + first, n}, t, Order::gradient, tracker.workspace().scratch);
    const std::vector<double>& action = end ? solution.momentum_end : solution.momentum_start;
    for (std::size_t a = 0; a < n; ++a) {
      worst = std::max(worst, std::abs(at.dv[a] - action[a]));
      largest = std::max(largest, std::abs(action[a]));
    }
  }
  return largest > 0 ? worst / largest : 0;
}

/// p·q' − L at the start of the path, with the velocities that its momenta have. Near a bound of the
/// velocities these tell more of the energy than the derivative of a polynomial does.
std::optional<double> energy_of_momenta(const Lagrangian& lagrangian, const Solution& solution,
                                        Scratch& scratch) {
  const std::size_t n = lagrangian.structure().coordinates;
  if (!lagrangian.structure().autonomous || !Flow::suits(lagrangian)) return std::nullopt;
  const std::span<const double> q(solution.trajectory.nodes.data(), n), p(solution.momentum_start);
  std::vector<double> v(n), near(n);
  solution.trajectory.at(0, near, v);
  Flow flow(lagrangian);
  if (!flow.momentum(q, v, 0, near) || !flow.velocity(q, p, 0, v)) return std::nullopt;
  const PointValues at = evaluate_at(lagrangian, q, v, 0, Order::gradient, scratch);
  const double energy = std::inner_product(p.begin(), p.end(), v.begin(), -at.value);
  return std::isfinite(energy) ? std::optional(energy) : std::nullopt;
}

/// Sets index and nullity to those that the pieces tell, if they do: the elements of the branch may be too
/// long for the fields that decide them. At events an eigenvalue is zero to the accuracy of their place
/// alone.
void count_squares(Tracker& tracker, SecondVariation& variation, BranchPoint& point) {
  const double size = tracker.sizes().q;
  Solution& solution = point.solution;
  const std::optional<OrbitIndex> found =
      orbit_index(tracker.branch().problem(), variation, solution.trajectory,
                  size > 0 ? solution.error_estimate / size : 0);
  tracker.state.index_resolved = found.has_value();
  if (!found) return;
  solution.morse_index = found->negative;
  solution.nullity = found->null;
}

BranchPoint read_state(Tracker& tracker, PointKind kind) {
  BranchState& state = tracker.state;
  state.index_resolved = false;
  const Branch& branch = tracker.branch();
  const Problem& problem = branch.problem();
  BranchPoint point;
  point.parameter = state.varied;
  point.kind = kind;
  Solution& solution = point.solution;
  solution.status = Status::converged;
  solution.message = "converged";
  solution.strategy = "continuation";
  Workspace& w = tracker.workspace();
  solution.trajectory = trajectory_of(recover(problem, state.path, w, w.raised) ? w.raised : state.path);
  solution.degree = state.path.degree();
  solution.action = state.action;
  solution.error_estimate = tracker.error();
  solution.morse_index = branch.inertia().negative;
  solution.nullity = branch.inertia().zero;
  const std::optional<Survey> survey = observe_energy(*problem.lagrangian, solution);
  const bool conserved = !problem.lagrangian->structure().autonomous || problem.paired ||
                         (survey && survey->energy_drift <= limits::continuation::unresolved * survey->terms);
  point.resolved = conserved && (kind == PointKind::branch || tracker.balanced());
  const auto middle = branch.momenta().begin() + problem.coordinates();
  solution.momentum_start.assign(branch.momenta().begin(), middle);
  solution.momentum_end.assign(middle, branch.momenta().end());
  if (const auto energy = energy_of_momenta(*problem.lagrangian, solution, w.scratch))
    solution.energy = energy;
  point.momentum_difference = momentum_difference(tracker, solution);
  if (!problem.periodic) return point;
  SecondVariation& variation = w.variation;
  if (problem.coordinates() <= most_coordinates_for_multipliers) {
    const ClosingMap closed = closing_map(problem);
    const auto assemble = [&](Definite definite) {
      return variation.assemble(problem.lagrangian, solution.trajectory, tracker.condensed(), &closed,
                                definite);
    };
    const bool assembled = assemble(problem.paired ? Definite::paired : Definite::positive);
    if (assembled && !problem.paired && kind == PointKind::regular) count_squares(tracker, variation, point);
    if (!assembled && !variation.too_many()) {
      solution.morse_index.reset();  // no part is minimising
      assemble(Definite::none);
    }
  }
  read_stability(problem, variation, tracker.sizes().q, solution, false);
  state.doubling = {solution.floquet ? doubling_tests(*solution.floquet) : std::vector<double>{NAN},
                    solution.morse_index ? doubling_index(problem, variation) : std::nullopt};
  return point;
}

}  // namespace

const char* name(PointKind kind) {
  switch (kind) {
    case PointKind::fold:
      return "fold";
    case PointKind::branch:
      return "branch";
    case PointKind::period_doubling:
      return "period-doubling";
    case PointKind::regular:
      break;
  }
  return "regular";
}

/// Steps go on from the state as it was.
BranchPoint read_point(Tracker& tracker, PointKind kind) {
  const bool singular = kind == PointKind::branch;  // what is held belongs to the elements of the path
  const auto mesh = singular ? std::nullopt : tracker.mesh_beside_closing();
  if (!mesh) return read_state(tracker, kind);
  BranchState before = tracker.state;
  const bool moved = tracker.move_to(*mesh, kind == PointKind::fold);
  BranchPoint point = read_state(tracker, kind);
  point.resolved = point.resolved && moved;
  before.doubling = tracker.state.doubling;
  before.index_resolved = tracker.state.index_resolved;
  tracker.state = std::move(before);
  return point;
}

}  // namespace extremal
