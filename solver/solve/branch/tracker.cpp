#include "solve/branch/tracker.hpp"

#include <cmath>
#include <utility>

#include "solve/branch/chord_steps.hpp"
#include "solve/branch/limits.hpp"
#include "solve/curve/arclength.hpp"
#include "solve/mesh/mesh.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::tracker;

void BranchState::scale(double factor) {
  tangent.scale(factor);
  rate *= factor;
  action_rate *= factor;
  if (factor < 0) orientation = -orientation;
}

Tracker::Tracker(const ProblemFamily& family, double tolerance)
    : family_(family), tolerance_(tolerance), branch_(family, path_, w_) {}

bool Tracker::begin(Path path, double coordinate, double rest) {
  rest_ = rest;
  branch_.ask_regular();
  std::swap(path_, path);
  if (!branch_.set_coordinate(coordinate)) return false;
  if (const auto node = node_off_kinks()) begin_at_node(*node);
  return fit_elements() != Fit::too_many && update_tangent(true);
}

bool Tracker::begin(const Path& path, double coordinate, const Branch::Units& units, double rest) {
  rest_ = rest;
  path_ = path;
  branch_.set_units(units);
  state.units = units;
  if (!branch_.set_coordinate(coordinate)) return false;
  branch_.bind();
  return update_tangent(true);
}

bool Tracker::begin(const BranchState& from, double rest) {
  rest_ = rest;
  state.units = from.units;
  return return_to(from) && update_tangent();
}

std::optional<double> Tracker::begin_beside(const BranchState& from, double value, double rest) {
  rest_ = rest;
  branch_.ask_regular();
  state.units = from.units;
  if (!return_to(from) || !branch_.apply(from.predicted((value - from.varied) / from.rate), 1))
    return std::nullopt;
  for (int k = 0; k < most_resolutions; ++k) {
    if (!correct(1, &value)) return std::nullopt;
    const Fit fit = fit_elements();
    if (fit == Fit::fine) break;
    if (fit == Fit::too_many) return std::nullopt;
  }
  if (!update_tangent()) return std::nullopt;
  const Move way = difference_to(from);
  return std::sqrt(branch_.dot(way, way));
}

/// The path, its units and its equations are those of a state again.
bool Tracker::return_to(const BranchState& from) {
  path_ = from.path;
  tangent_ = from.tangent;
  branch_.set_units(from.units);
  branch_.hold_family(from.family);
  if (!branch_.set_coordinate(from.coordinate)) return false;
  branch_.bind();
  branch_.close_by(from.closing);
  return true;
}

/// By a move of this length from a state, and back across its tangent.
bool Tracker::displace(const BranchState& from, const Move& by, double length, const double* landing) {
  state.units = from.units;
  landed_ = 0;
  failure_ = StepFailure::no_problem;
  if (!return_to(from)) return false;
  if (branch_.apply(by, 1)) return correct(length, landing);
  if (branch_.defined()) failure_ = StepFailure::rough;
  return false;
}

bool Tracker::reach(const BranchState& from, const Move& by) {
  const double length = std::sqrt(branch_.dot(by, by));
  return displace(from, by, length, nullptr) && update_tangent();
}

bool Tracker::reach(const BranchState& from, double length, bool same_elements, const double* landing) {
  if (!displace(from, from.predicted(length), std::abs(length), landing)) return false;
  for (int k = 0; k < most_resolutions && !same_elements; ++k) {
    const Fit fit = fit_elements();
    if (fit == Fit::too_many) {
      failure_ = StepFailure::crowded;
      return false;
    }
    if (fit == Fit::fine) break;
    if (!correct(std::abs(length), landing)) return false;
  }
  return update_tangent() && (same_elements || (resolve_forces(std::abs(length), landing) && settle()));
}

/// Where the value hardly varies while the branch runs on, a path that is near the branch is farther from the
/// extremal of its own value: by the slope of the branch over the value.
bool Tracker::settle() {
  const auto missed = [this] { return value_missed() > roundings * unit_roundoff * std::abs(state.varied); };
  state.left = 0;
  if (!missed() || !(left_at_value() > settled * tolerance_)) return true;
  const double share = std::min(std::abs(state.rate / branch_.varied_unit()), 1.0);
  correct(1, nullptr, share);
  if (!update_tangent()) return false;
  if (missed()) state.left = left_at_value();
  return true;
}

/// By how much the value is another than that of the branch where the path is nearest to it.
double Tracker::value_missed() const {
  const double along =
      branch_.dot(branch_.correction, branch_.direction) / branch_.dot(branch_.direction, branch_.direction);
  return std::abs(branch_.change(false) - along * branch_.change(true));
}

/// How far the path is from the extremal of its value, to first order.
double Tracker::left_at_value() const {
  Move left = branch_.correction;
  left.add(branch_.direction, -branch_.change(false) / branch_.change(true));
  return branch_.largest(left);
}

/// Forces between the points of the quadrature show in another one. Elements are halved as long as it moves
/// the path by more than the tolerance and that helps: what remains is roundoff.
bool Tracker::resolve_forces(double length, const double* landing) {
  for (double before = INFINITY;;) {
    const Scales size = sizes();
    const double moved = branch_.step_under(w_.levels.finer(branch_.tables().scheme())) * state.units.extent;
    error_ = std::max(error_, moved);
    if (size.q == 0 || moved <= tolerance_ * size.q || moved > halving_helps * before) return true;
    if (2 * path_.elements() > limits::elements::most_elements) {
      failure_ = StepFailure::crowded;
      return false;
    }
    before = moved;
    change_elements(path_.degree(), halved({path_.mesh().begin(), path_.mesh().end()}));
    if (!correct(length, landing) || !update_tangent()) return false;
  }
}

bool Tracker::reach_smoothly(const BranchState& from, double length, bool same_elements) {
  return reach(from, length, same_elements) && turn_is_small();
}

/// The chord is the mean of the tangents in between. Unless these turn back and forth, none differs from the
/// mean of the first and the last by more than half of their difference. A chord that does leads from one
/// branch onto another: beyond a fold the tangent may be nearly the same. Predictions move paths along what
/// is held, too, which no correction takes back.
bool Tracker::turns_one_way(const BranchState& from) {
  const auto unit = [&](Move move) {
    move.scale(1 / std::sqrt(branch_.dot(move, move)));
    return move;
  };
  Move chord = difference_to(from);
  chord.scale(-1);
  const Move first = unit(tangent_), last = unit(state.tangent);
  Move turn = last, off = unit(std::move(chord));
  turn.add(first, -1);
  off.add(first, -0.5);
  off.add(last, -0.5);
  branch_.take_across_phases(off);
  const double between = std::sqrt(branch_.dot(off, off)), ends = std::sqrt(branch_.dot(turn, turn));
  return between <= 0.5 * ends + waviness;
}

bool Tracker::land(double value) { return correct(1, &value) && update_tangent(); }

/// Newton's method across the tangent, to a share of what is enough; or to where the number that varies has
/// the value `landing`.
bool Tracker::correct(double length, const double* landing, double share) {
  const double enough = std::max(unfinished * tolerance_, least_goal);
  ChordSteps policy(branch_, tangent_, length, landing ? least_goal : std::max(share * enough, least_goal),
                    enough);
  const Progress progress = landing ? newton_loop(to_value(branch_, *landing), policy)
                                    : newton_loop(across(branch_, tangent_), policy);
  factorisations_ = policy.factorisations();
  if (landing) landed_ += policy.along();
  failure_ = policy.left_problem() ? StepFailure::no_problem
             : policy.roundoff()   ? StepFailure::hidden
                                   : StepFailure::rough;
  return progress == Progress::arrived;
}

/// The next tangent, onward, and the state there.
bool Tracker::update_tangent(bool first) {
  if (!branch_.linearise()) {
    failure_ = branch_.defined() ? StepFailure::rough : StepFailure::no_problem;
    return false;
  }
  failure_ = StepFailure::rough;
  // A path with nothing left to correct: a long correction is the roundoff of nearly singular factors.
  if (!first && branch_.dot(branch_.correction, branch_.correction) > 1) return false;
  const auto [onward, cosine] = tangent_scale(branch_, first ? nullptr : &tangent_, 1);
  cosine_ = cosine;
  state.path = path_;
  state.coordinate = branch_.coordinate();
  state.varied = branch_.varied();
  state.action = branch_.action();
  state.tangent = branch_.direction;
  state.tangent.scale(onward);
  state.closing = branch_.closing(state.tangent);
  state.family = branch_.held_family();
  state.rate = onward * branch_.change(true);
  state.turning = state.bend = state.twist = {};
  state.action_rate = onward * branch_.action_slope();
  state.energy_time = std::abs(branch_.energy() * path_.duration());
  state.orientation = branch_.orientation(onward);
  state.index = branch_.inertia().negative;
  state.nullity = branch_.inertia().zero;
  state.open = branch_.open();
  state.crossing = crossing_test();
  return true;
}

/// The response to a load grows without bound towards a branch point. Its sign is that of the orientation,
/// which changes there. Lengths are divided by the extent, since units change from state to state.
double Tracker::crossing_test() {
  Move response;
  branch_.respond(state.tangent, response);
  return state.orientation / (state.units.extent * std::sqrt(branch_.dot(response, response)));
}

bool Tracker::respond(Move& response, int which) {
  if (!branch_.linearise()) return false;
  branch_.respond(state.tangent, response, which);
  return true;
}

void Tracker::measure_anew() {
  const double extent = sizes().q;
  largest_extent_ = std::max(largest_extent_, extent);
  const double unit = std::max(extent, least_extent * largest_extent_);
  state.units = {unit > 0 ? unit : 1, path_.duration()};
  branch_.set_units(state.units);
  state.varied_error = extent > 0 ? 2 * error_ / extent * branch_.varied_unit() : 0;
  state.scale(1 / std::sqrt(branch_.dot(state.tangent, state.tangent)));
}

bool Tracker::balanced() const {
  using namespace limits::branch_points;
  return branch_.residual() <= std::max(momentum_tolerances * tolerance_, least_momentum);
}

Scales Tracker::sizes() const {
  Scales size = scales(path_, branch_.tables());
  if (size.q <= rest_) size.q = 0;
  return size;
}

}  // namespace extremal
