#include "solve/contact/junctions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "linear/dense.hpp"
#include "solve/contact/constraint_sets.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Points of a guess of an arc.
constexpr int guess_points = 48;

/// What holds at the ends as long as these are free: constraints, what the first and the last arc hold, and
/// what the path touches there.
std::vector<EndContact> end_contacts(const Problem& problem, const std::vector<Interval>& intervals) {
  std::vector<EndContact> contacts;
  const int constraints = problem.manifold ? problem.manifold->constraints() : 0;
  for (const bool at_end : {false, true}) {
    for (int j = 0; j < constraints; ++j) contacts.push_back({j, at_end, true});
    const std::vector<int> held = at_end ? sorted_union(intervals.back().held, intervals.back().at_end)
                                         : sorted_union(intervals.front().held, intervals.front().at_start);
    for (const int k : held) contacts.push_back({k, at_end, false});
  }
  return contacts;
}

/// Those of an arc between two times; free times as its parts.
std::vector<WaypointCondition> waypoints_in(const Problem& problem, double from, double to) {
  std::vector<WaypointCondition> found;
  if (!problem.extension) return found;
  for (WaypointCondition waypoint : problem.extension->waypoints) {
    const double t = waypoint.at(problem.duration.value);
    if (!(t >= from && t < to)) continue;
    if (waypoint.free) waypoint.time = (t - from) / (to - from);
    found.push_back(std::move(waypoint));
  }
  return found;
}

}  // namespace

Junctions::Junctions(Arcs& arcs, const std::vector<Interval>& intervals, const PathPoints& path,
                     const std::vector<double>& constants)
    : arcs_(arcs),
      problem_(arcs.problem()),
      n_(problem_.coordinates()),
      ends_(problem_, extremal::end_contacts(problem_, intervals)),
      duration_(problem_.duration.value),
      phase_held_(problem_.periodic && problem_.shifts_in_time() &&
                  problem_.inequalities->all->autonomous()) {
  const auto point = [&](double t) {
    VectorXd q(n_);
    path(t, {q.data(), static_cast<std::size_t>(n_)});
    return q;
  };
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const Interval& interval = intervals[i];
    PathArc arc{interval.held, interval.from, interval.to, {}, {}, {}, constants};
    arc.waypoints = waypoints_in(problem_, interval.from, interval.to);
    for (int k = 0; k <= guess_points; ++k) {
      const double tau = static_cast<double>(k) / guess_points;
      const VectorXd q = point(interval.from + tau * (interval.to - interval.from));
      arc.guess.tau.push_back(tau);
      arc.guess.q.insert(arc.guess.q.end(), q.begin(), q.end());
    }
    parts_.push_back(std::move(arc));
    if (i == 0) continue;
    held_.push_back(sorted_union(intervals[i - 1].held, interval.held));
    touched_.push_back(interval.touched);
    if (interval.touched >= 0) held_.back() = sorted_union(held_.back(), {interval.touched});
    state_.q.push_back(point(interval.from));
    state_.t.push_back(interval.from);
  }
  std::vector<double> ends(2 * static_cast<std::size_t>(n_));
  path(0, {ends.data(), static_cast<std::size_t>(n_)});
  path(duration_, {ends.data() + n_, static_cast<std::size_t>(n_)});
  state_.ends = ends_.at(ends, duration_);
  state_.constants = Eigen::Map<const VectorXd>(constants.data(), static_cast<Index>(constants.size()));
}

Index Junctions::directions(int junction) const {
  return n_ - arcs_.constraints() - static_cast<Index>(held_[junction].size());
}

int Junctions::unknowns() const {
  Index sum = first_of_junctions();
  for (int j = 0; j < count(); ++j) sum += directions(j) + (timed(j) ? 1 : 0);
  return static_cast<int>(sum);
}

/// Arcs with the ends that a state gives them; its points are moved onto what they must satisfy.
bool Junctions::place(State& state, std::vector<PathArc>& parts) const {
  const VectorXd ends = ends_.ends(state.ends);
  const double duration = ends_.duration(state.ends);
  parts.front().from = 0;
  parts.back().to = duration;
  const std::vector<double> constants(state.constants.begin(), state.constants.end());
  for (PathArc& part : parts) part.constants = constants;
  if (!(duration > parts.back().from) && parts.size() == 1) return false;
  parts.front().start = ends.head(n_);
  parts.back().end = ends.tail(n_);
  if (!arcs_.project(parts.front().held, constants, 0, parts.front().start)) return false;
  if (!arcs_.project(parts.back().held, constants, duration, parts.back().end)) return false;
  for (std::size_t j = 0; j < state.t.size(); ++j) {
    if (!arcs_.project(held_[j], constants, state.t[j], state.q[j])) return false;
    parts[j].to = parts[j + 1].from = state.t[j];
    parts[j].end = parts[j + 1].start = state.q[j];
  }
  return true;
}

/// Arcs with these numbers.
bool Junctions::solve(Trial& trial, int first, int last) {
  for (int i = std::max(first, 0); i <= std::min<int>(last, static_cast<int>(trial.parts.size()) - 1); ++i) {
    trial.solved[i] = arcs_.solve(trial.parts[i]);
    if (!trial.solved[i].found) {
      message_ = fmt::format("the arc from t = {:.6g} to {:.6g} was not found: {}", trial.parts[i].from,
                             trial.parts[i].to, trial.solved[i].message);
      return false;
    }
    put_guess(trial.solved[i], trial.parts[i]);
  }
  return true;
}

/// What integrals miss, in units of momentum.
VectorXd Junctions::integral_residual(const Trial& trial) const {
  VectorXd missed(integrals());
  for (int j = 0; j < integrals(); ++j) {
    const double given = problem_.extension->integrals[j];
    double sum = 0, size = std::abs(given);
    for (const SolvedArc& arc : trial.solved) {
      sum += arc.integrals[j];
      size += std::abs(arc.integrals[j]);
    }
    missed[j] = (sum - given) / (size > 0 ? size : 1) * momentum_;
  }
  return missed;
}

/// Equations of the ends and of the constants, then jumps of the momentum.
VectorXd Junctions::residual(const Trial& trial) const {
  const std::vector<SolvedArc>& solved = trial.solved;
  const int ends = ends_.unknowns(), first = first_of_junctions();
  VectorXd r(first + count() * n_);
  const EndLaws laws = this->laws(trial.parts.front().constants);
  r.head(ends) = ends_.residual(
      trial.state.ends, {solved.front().p_start, solved.back().p_end, solved.back().energy_end}, laws);
  r.segment(ends, unknown_constants()) = ends_.where_residual(trial.state.ends, laws);
  r.segment(ends + unknown_constants(), integrals()) = integral_residual(trial);
  for (int j = 0; j < count(); ++j) r.segment(first + j * n_, n_) = jump(trial, j);
  return r;
}

/// Of the momentum. At a touch, in place of its part across the surface, the mean velocity across it, by the
/// metric in units of momentum.
VectorXd Junctions::jump(const Trial& trial, int junction) const {
  const SolvedArc &before = trial.solved[junction], &after = trial.solved[junction + 1];
  VectorXd jump = before.p_end - after.p_start;
  if (touched_[junction] < 0) return jump;
  const VectorXd& q = trial.parts[junction].end;
  const std::shared_ptr<const Manifold> all = arcs_.inequalities(trial.parts[junction].constants);
  const ConstraintValues values = all->at({q.data(), static_cast<std::size_t>(n_)}, trial.parts[junction].to);
  const VectorXd slope = values.slopes.row(touched_[junction]), across = all->metric() * slope;
  const double square = slope.dot(across);
  const double rate = 0.5 * slope.dot(before.v_end + after.v_start) + values.rates[touched_[junction]];
  return jump + (rate - across.dot(jump)) / square * slope;
}

double Junctions::impulse(int junction) const {
  const VectorXd& q = parts_[junction].end;
  const std::shared_ptr<const Manifold> all = arcs_.inequalities(constants());
  const VectorXd slope =
      all->at({q.data(), static_cast<std::size_t>(n_)}, parts_[junction].to).slopes.row(touched_[junction]);
  const VectorXd across = all->metric() * slope;
  return across.dot(solved_[junction].p_end - solved_[junction + 1].p_start) / slope.dot(across);
}

/// Displacements of the point of a junction that keep what is held there.
MatrixXd Junctions::basis(int junction) const {
  const Index columns = directions(junction);
  if (columns == n_) return MatrixXd::Identity(n_, n_);
  if (columns <= 0) return MatrixXd(n_, 0);
  const VectorXd& q = state_.q[junction];
  return complement(arcs_.manifold(held_[junction], parts_[junction].constants)
                        ->at({q.data(), static_cast<std::size_t>(n_)}, state_.t[junction])
                        .slopes.transpose());
}

/// Sizes of path, momenta and velocities.
void Junctions::measure() {
  VectorXd low = parts_.front().start, high = low;
  momentum_ = speed_ = 0;
  for (const SolvedArc& solved : solved_) {
    const Trajectory& path = solved.trajectory;
    for (std::size_t i = 0; i < path.nodes.size(); ++i) {
      low[i % n_] = std::min(low[i % n_], path.nodes[i]);
      high[i % n_] = std::max(high[i % n_], path.nodes[i]);
    }
    momentum_ = std::max({momentum_, solved.p_start.norm(), solved.p_end.norm()});
    speed_ = std::max({speed_, solved.v_start.norm(), solved.v_end.norm()});
  }
  size_ = (high - low).maxCoeff();
  const double largest = std::max(low.lpNorm<Eigen::Infinity>(), high.lpNorm<Eigen::Infinity>());
  if (!(size_ > 1e-12 * largest)) size_ = largest > 0 ? largest : 1;
  if (!(momentum_ > 0)) momentum_ = size_ / duration_;
  ends_.set_units(size_, momentum_, duration_);
  // A multiplier counts by the action that it makes.
  constant_units_ = state_.constants.cwiseAbs();
  for (int j = 0; j < integrals(); ++j) {
    double size = std::abs(problem_.extension->integrals[j]);
    for (const SolvedArc& solved : solved_) size += std::abs(solved.integrals[j]);
    double& unit = constant_units_[unknown_constants() + j];
    if (size > 0) unit = std::max(unit, momentum_ * size_ / size);
  }
  for (double& unit : constant_units_)
    if (unit == 0) unit = 1;
}

}  // namespace extremal
