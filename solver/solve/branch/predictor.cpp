#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/limits.hpp"
#include "solve/branch/tracker.hpp"

/// \file How a branch continues from a state, by its tangents and other states.

namespace extremal {

using namespace limits::predictor;

namespace {

bool same_elements(const Path& a, const Path& b) {
  return a.degree() == b.degree() && std::ranges::equal(a.mesh(), b.mesh());
}

/// Whether the elements of one are those of the other, whose ends have followed kinks of L.
bool followed_kinks(const Path& a, const Path& b) {
  if (a.degree() != b.degree() || a.elements() != b.elements()) return false;
  const std::span<const double> here = a.mesh(), there = b.mesh();
  for (int k = 0; k < a.elements(); ++k)
    if (std::max(here[k], there[k]) >= std::min(here[k + 1], there[k + 1])) return false;
  return true;
}

}  // namespace

Move BranchState::predicted(double length) const {
  Move move = tangent;
  move.scale(length);
  if (bend.step.nodes.empty()) return move;
  move.add(bend, length * length);
  if (!twist.step.nodes.empty()) move.add(twist, length * length * length);
  return move;
}

/// Tangents t here, at the state before and at the one before that give, as divided differences D and S over
/// the ways ℓ between them, t(σ) = t + σD + σ(σ + ℓ)S, and the branch as its integral. Differences of paths
/// are not used: they may differ by a shift of time that no correction takes back, and would enlarge it.
void Tracker::predict(const BranchState& before, double length) {
  const Move tangent = transferred(before.tangent, before.path);
  const double unit = std::sqrt(branch_.dot(tangent, tangent));  // of lengths before
  state.back = unit * length;
  state.earlier = {{state.back, before.crossing, before.doubling}};
  if (!before.earlier.empty()) {
    EarlierTests& first = state.earlier.emplace_back(before.earlier.front());
    first.back = state.back + unit * first.back;
  }
  Move& turning = state.turning = state.tangent;
  turning.add(tangent, -1 / branch_.dot(state.tangent, tangent));
  turning.scale(1 / state.back);
  state.bend = turning;
  if (!before.turning.step.nodes.empty()) {
    Move& twist = state.twist = turning;
    twist.add(transferred(before.turning, before.path), -1 / (unit * unit));
    twist.add(state.tangent, -branch_.dot(state.tangent, twist));
    twist.scale(1 / (state.back + unit * before.back));
    state.bend.add(twist, state.back);
    twist.scale(1.0 / 3);
  }
  state.bend.scale(0.5);
}

/// The tangent turns by at most |2σ bend + 3σ² twist|.
double Tracker::predictable_length() const {
  const auto size = [&](const Move& move) {
    return move.step.nodes.empty() ? 0 : std::sqrt(branch_.dot(move, move));
  };
  const double bend = size(state.bend), twist = size(state.twist);
  return predicted_turn / (bend + std::sqrt(bend * bend + 3 * twist * predicted_turn));
}

/// With ℓ the length of the step and y(σ) the deviation of the branch from the tangent t, y(ℓ) = Y and
/// y'(ℓ) = Z give y = σ²(3Y/ℓ − Z)/ℓ + σ³(Z − 2Y/ℓ)/ℓ².
BranchState Tracker::with_cubic(const BranchStep& step) {
  const auto& [from, to, length] = step;
  BranchState result = from;
  path_ = from.path;
  branch_.set_units(from.units);
  if (!branch_.set_coordinate(from.coordinate)) return result;
  Move off = difference_to(to);
  off.add(from.tangent, -length);
  off.scale(1 / (length * length));
  Move slope = transferred(to.tangent, to.path);
  slope.scale(1 / (branch_.dot(from.tangent, slope) * length));
  slope.add(from.tangent, -1 / length);
  result.bend = off;
  result.bend.scale(3);
  result.bend.add(slope, -1);
  result.twist = std::move(slope);
  result.twist.add(off, -2);
  result.twist.scale(1 / length);
  return result;
}

BranchState Tracker::corrected(const BranchState& from, const BranchStep& around, double at) {
  BranchState result = from;
  path_ = from.path;
  branch_.set_units(from.units);
  if (at == 0 || !branch_.set_coordinate(from.coordinate)) return result;
  Move mean = difference_to(around.from);
  mean.add(from.predicted(at - around.length), -1);
  mean.add(difference_to(around.to), 1);
  mean.add(from.predicted(at + around.length), -1);
  mean.scale(0.5 / (at * at));
  if (result.bend.step.nodes.empty())
    result.bend = std::move(mean);
  else
    result.bend.add(mean, 1);
  return result;
}

/// A move of another path on the elements of this one. Moves have kinks where paths cross those of L: with
/// the elements that end there they move, or differences of moves would be worth nothing.
Move Tracker::transferred(const Move& move, const Path& from) {
  if (move.step.nodes.empty() || same_elements(from, path_)) return move;
  if (branch_.tables().kinks() && followed_kinks(from, path_)) return move;
  Path whole;
  whole.reset(w_.levels.at(from.degree()), from.mesh(), from.duration());
  whole.add(move.step.nodes, move.step.inner, 1);
  whole.load_ends();
  w_.other.resample_from(whole, branch_.tables(), path_.mesh());
  Move result = move;
  const double duration = move.step.duration;
  result.step = values_of(w_.other);
  result.step.duration = duration;
  return result;
}

Tracker::Way Tracker::way(const BranchState& from, const BranchState& to) {
  path_ = from.path;
  branch_.set_units(from.units);
  if (!branch_.set_coordinate(from.coordinate)) return {INFINITY, NAN};
  const Move all = difference_to(to);
  return {std::sqrt(branch_.dot(all, all)), branch_.dot(from.tangent, all)};
}

Move Tracker::difference_to(const BranchState& to) {
  w_.other = to.path;
  if (!same_elements(to.path, path_)) w_.other.resample_from(to.path, branch_.tables(), path_.mesh());
  Move way{values_of(w_.other), to.coordinate - branch_.coordinate()};
  way.add({values_of(path_)}, -1);
  if (family_.varied == Varied::parameter) way.step.duration = to.path.duration() - path_.duration();
  return way;
}

}  // namespace extremal
