#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/dense.hpp"
#include "problem/phase_space.hpp"
#include "solve/branch/branch_point.hpp"
#include "solve/branch/limits.hpp"
#include "solve/branch/root.hpp"

/// \file Points of a step where other branches cross.

namespace extremal {

using namespace limits::branch_points;

namespace {

/// One end of the interval that holds a branch point.
struct Side {
  double at = 0, weight = 1;
  Move response = {};
  double size = 0;                  ///< of the response; 0: not known
  std::vector<Move> singular = {};  ///< directions, on that side where they are next to singular
};

/// How many eigenvalues of the second variation pass zero between two states, the one of a turning parameter
/// left out.
int passing(const BranchState& a, const BranchState& b) {
  const int change = std::abs(a.index - b.index);
  const bool turns = (change % 2 != 0) == (a.orientation == b.orientation);
  return std::max(std::abs(change - turns), 1);
}

/// The null directions of the second variation, duration and parameter held, at a branch point: the equations
/// of the branch are singular along these directions and along its tangent, which change both numbers or not.
std::vector<Move> null_directions(const Tracker& tracker, const ProblemFamily& family,
                                  const std::vector<Move>& singular) {
  const BranchState& state = tracker.state;
  const bool by_duration = family.varied != Varied::parameter;
  const double unit = by_duration ? state.units.duration : std::abs(family.to - family.from);
  std::vector<Move> kernel = singular;
  kernel.push_back(state.tangent);
  const Eigen::Index count = std::ssize(kernel);
  Eigen::MatrixXd changes(2, count);
  for (Eigen::Index j = 0; j < count; ++j)
    changes.col(j) << kernel[j].parameter / unit, kernel[j].step.duration / state.units.duration;
  const auto [u, sizes, v] = singular_value_decomposition(changes);
  const auto rank = (sizes.array() > hardly_changed).count();
  std::vector<Move> found;
  for (Eigen::Index k = rank; k < count; ++k) {
    found.push_back(kernel.front());
    found.back().scale(v(0, k));
    for (Eigen::Index j = 1; j < count; ++j) found.back().add(kernel[j], v(j, k));
  }
  return found;
}

/// Index and nullity there.
void count_squares(Tracker& tracker, const ProblemFamily& family, const std::vector<Move>& singular,
                   Solution& solution) {
  if (!solution.morse_index) return;
  tracker.hold(null_directions(tracker, family, singular));
  if (!tracker.branch().linearise()) return;
  const Inertia& found = tracker.branch().inertia();
  solution.morse_index = found.negative;
  solution.nullity = found.zero;
}

/// The branch point. Nothing along the singular directions is corrected there: the other equations are
/// regular. So the predictor must be good along them: it is corrected by the mean of what states as far on
/// either side differ from it. Where that fails, the nearest point before it that is reached. What is left of
/// the forces along the singular directions must vanish; else two branches pass near each other there.
struct FoundBranchPoint {
  std::optional<BranchPoint> point = {};
  bool balanced = false;
};
FoundBranchPoint branch_point_at(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
                                 double at, double length, const std::vector<Move>& singular) {
  bool reached = false;
  for (const double share : offsets) {
    const double off = share * length;
    tracker.hold({});
    if (!tracker.reach_smoothly(from, at - off, true)) continue;
    const BranchState before = tracker.state;
    if (!tracker.reach_smoothly(from, at + off, true)) continue;
    const BranchState near = tracker.corrected(from, {before, BranchState(tracker.state), off}, at);
    tracker.hold(singular);
    reached = tracker.reach(near, at, true);
    if (reached) break;
  }
  tracker.hold(singular);
  if (!reached) reached = tracker.reach_smoothly(from, at, true);
  const bool same_elements = reached;
  if (!reached) {
    tracker.hold({});
    reached = std::ranges::any_of(
        beside, [&](double share) { return tracker.reach_smoothly(from, at - share * length); });
  }
  FoundBranchPoint found;
  if (reached) {
    found.balanced = tracker.balanced();
    found.point = read_point(tracker, PointKind::branch);
  }
  if (same_elements) count_squares(tracker, family, singular, found.point->solution);
  tracker.hold({});
  return found;
}

/// To a state at `guess`, or aside of it where the equations are too singular: at a branch point itself they
/// leave more directions open, and nothing tells its sides apart. NaN if there is none. Where directions are
/// held the tangent is across them, not along the branch: it may turn.
double state_near(Tracker& tracker, const BranchState& from, double guess, double aside,
                  const Side (&sides)[2], bool held = false) {
  for (const double at :
       {guess, guess + aside * (sides[1].at - guess), guess - aside * (guess - sides[0].at)})
    if (held ? tracker.reach(from, at, true)
             : tracker.reach_smoothly(from, at, true) && tracker.state.open <= from.open)
      return at;
  return NAN;
}

const Side& nearer(const Side (&sides)[2]) { return sides[sides[0].size > sides[1].size ? 0 : 1]; }

/// How branch points are narrowed down.
enum class Narrowing { by_responses, by_halves };

/// By halves where the orientation changes, then by the secant of ±1/|response|, which passes zero at a
/// branch point. States next to it are reached with the directions of the responses held.
double narrow(Tracker& tracker, const ProblemFamily& family, const BranchState& from,
              const BranchState& before, int count, Narrowing how, Side (&sides)[2]) {
  const Branch& branch = tracker.branch();
  Move response;
  double last = sides[0].at, best = NAN, far = 0;
  bool lower_before = false, balanced = false;
  std::optional<double> aside_of;
  for (int k = 0; k < most_trials; ++k) {
    const bool known = how == Narrowing::by_responses && sides[0].size > 0 && sides[1].size > 0;
    const bool near =
        known && branch.dot(sides[0].response, sides[1].response) < opposite * sides[0].size * sides[1].size;
    const double a = near ? sides[0].weight / sides[0].size : 1,
                 b = near ? sides[1].weight / sides[1].size : 1;
    const double secant = (sides[0].at * b + sides[1].at * a) / (a + b);
    const double guess = aside_of ? *std::exchange(aside_of, std::nullopt) : secant;
    if (near) {
      best = secant;
      tracker.hold(nearer(sides).singular);
    }
    double at = state_near(tracker, from, guess, near ? aside_near : aside_far, sides, near);
    if (near && std::isnan(at)) {
      tracker.hold({});
      at = state_near(tracker, from, guess, aside_near, sides);
    }
    if (std::isnan(at)) return best;
    const bool across = branches_cross(tracker.state, before);
    tracker.hold({});
    if (!tracker.respond(response)) return best;
    const double size = std::sqrt(branch.dot(response, response));
    const bool lower = near ? branch.dot(response, sides[0].response) > 0 : !across;
    // At the branch point itself the way along the other branch may count as null and be left out. The secant
    // between points as far on either side shows where that is.
    const bool gone = near && size < left_out * std::min(sides[0].size, sides[1].size);
    if (gone && !balanced) {
      balanced = true;
      const Side& nearer = at - sides[0].at < sides[1].at - at ? sides[0] : sides[1];
      aside_of = 2 * at - nearer.at;
      continue;
    }
    // Without a response that grows the index was miscounted, as it may be where elements are very unequal;
    // where both sides were known, roundoff hides all that is nearer.
    if (!std::isfinite(size) || size == 0 || gone || is_located(tracker, family, at - last) || at == last)
      return near || how == Narrowing::by_halves ? at : best;
    last = at;
    // The same side again: the other one counts less (Illinois).
    if (near && lower == lower_before) sides[lower ? 1 : 0].weight *= 0.5;
    if (k == 0) far = size;
    sides[lower ? 0 : 1] = {at, 1, response, size,
                            singular_directions(tracker, response, count, grown * far)};
    lower_before = lower;
  }
  return NAN;
}

/// A δz_a + Bᵀδz_b + Π δz_a of the first element: by how much the momenta of z = (q, p) change otherwise than
/// they do along motions. `size`: of its terms.
Eigen::VectorXd beside_motions(const DiscreteAction& action, const PhaseWeights& weights, const Move& move,
                               double& size) {
  const int all = action.tables().coordinates(), n = all / 2;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(all);
  size = 0;
  for (int i = 0; i < all; ++i) {
    for (int j = 0; j < all; ++j) {
      const double here = action.condensed(0, std::max(i, j), std::min(i, j)) * move.step.nodes[j],
                   next = action.condensed(0, all + j, i) * move.step.nodes[all + j];
      change[i] += here + next;
      size = std::max({size, std::abs(here), std::abs(next)});
    }
    if (i < n) change[i] += (weights.symmetric ? 0.5 : 1) * move.step.nodes[n + i];
    if (i >= n && weights.symmetric) change[i] -= 0.5 * move.step.nodes[i - n];
  }
  return change;
}

/// Whether the equations in phase space are singular at the tracker's path for their squares alone, and not
/// those of motions: see system/phase_space.hpp. The direction may have a part along the branch.
bool of_squares_alone(Tracker& tracker, const Move& direction) {
  const Problem& problem = tracker.branch().problem();
  Move response;
  if (!problem.phase || !tracker.respond(response)) return false;
  const DiscreteAction& action = tracker.workspace().iteration.action();
  double size = 0, size_along = 0;
  Eigen::VectorXd change = beside_motions(action, problem.phase->weights, direction, size);
  const Eigen::VectorXd along =
      beside_motions(action, problem.phase->weights, tracker.state.tangent, size_along);
  if (along.norm() > beside_motion * size_along) change -= along.dot(change) / along.squaredNorm() * along;
  return change.norm() > beside_motion * size;
}

/// A branch point, and the directions along which the equations are singular there.
struct Located {
  double at = NAN;
  std::vector<Move> singular = {};
};

/// A part of a step, from the state that its points are reached from: on the elements of that state.
struct Span {
  BranchState from, before, after;  ///< `before` and `after`: at its ends
  double low, high;
};

/// NaN where the branch cannot be followed, or no response grows.
Located find_branch_point(Tracker& tracker, const ProblemFamily& family, const Span& span, Narrowing how) {
  Side sides[2] = {{.at = span.low}, {.at = span.high}};
  const double at =
      narrow(tracker, family, span.from, span.before, passing(span.before, span.after), how, sides);
  tracker.hold({});
  const Side& side = nearer(sides);
  if (side.singular.empty() || !std::isfinite(at)) return {};
  return {at, side.singular};
}

enum class Finer { not_needed, found, lost };

/// The span on elements that resolve a singular direction too, if its own do not. There points lie elsewhere,
/// and may have left the span: by no more than its length.
Finer refine(Tracker& tracker, const Move& singular, Span& span) {
  const std::optional<BranchState> finer = tracker.resolved_for(span.from, singular);
  if (!finer) return Finer::not_needed;
  const double length = span.high - span.low;
  const auto alike = [&](double at, const BranchState& coarse, BranchState& state) {
    if (!tracker.reach(*finer, at, true)) return false;
    state = tracker.state;
    return !branches_cross(state, coarse);
  };
  Span fine{*finer, span.before, span.after, span.low, span.high};
  if (!alike(fine.low, span.before, fine.before) && !alike(fine.low -= length, span.before, fine.before))
    return Finer::lost;
  if (!alike(fine.high, span.after, fine.after) && !alike(fine.high += length, span.after, fine.after))
    return Finer::lost;
  span = std::move(fine);
  return Finer::found;
}

/// Points of a span, in their order; `apart`: nearer points are one. False where one is not found.
bool find_between(Tracker& tracker, const EventSearch& search, Span span, double apart, Crossings& found) {
  const auto reach = [&](double at) {
    return span.low < at && at < span.high && tracker.reach(span.from, at, true);
  };
  for (int k = 0; k < most_points && branches_cross(span.before, span.after); ++k) {
    Located point = find_branch_point(tracker, search.family, span, Narrowing::by_responses);
    if (!std::isfinite(point.at)) return false;
    const Finer finer = refine(tracker, point.singular.front(), span);
    if (finer == Finer::found) continue;
    if (finer == Finer::lost) return false;  // on those elements alone
    // Of several that pass the responses may lead to a later one, or to none.
    const bool several = passing(span.before, span.after) > 1;
    if (several && reach(point.at - apart) && branches_cross(span.before, tracker.state)) {
      Span earlier = span;
      earlier.after = tracker.state;
      earlier.high = point.at - apart;
      if (!find_between(tracker, search, earlier, apart, found)) return false;
      span.before = std::move(earlier.after);
      span.low = earlier.high;
      continue;
    }
    if (reach(point.at + apart) && !branches_cross(span.before, tracker.state)) {
      point = find_branch_point(tracker, search.family, span, Narrowing::by_halves);
      if (!std::isfinite(point.at)) return false;
    }
    FoundBranchPoint read =
        branch_point_at(tracker, search.family, span.from, point.at, span.high, point.singular);
    if (!read.point) return false;
    if (!read.balanced) {
      found.leaps = true;
      return false;
    }
    const bool crosses = !of_squares_alone(tracker, point.singular.front());
    if (crosses)
      found.events.push_back(
          {point.at,
           {*std::move(read.point), branch_start(tracker, search, PointKind::branch, span.from, point.at,
                                                 static_cast<int>(point.singular.size()))}});
    const BranchState before = reach(point.at - apart) ? tracker.state : span.before;
    if (!reach(point.at + apart)) return false;
    if (crosses) count_null_directions(found.events.back().found.point.solution, before, tracker.state);
    span.before = tracker.state;
    span.low = point.at + apart;
  }
  return !branches_cross(span.before, span.after);
}

std::vector<Sample> crossings_on(const BranchStep& step) {
  return samples_on(
      step, [](const auto& state) { return state.crossing; }, step.to.crossing);
}

}  // namespace

std::vector<Move> singular_directions(Tracker& tracker, const Move& response, int count, double least) {
  const Branch& branch = tracker.branch();
  std::vector<Move> found;
  Move next = response;
  for (int k = 0; k < count; ++k) {
    if (k > 0) {
      tracker.hold(found);
      if (!tracker.respond(next, k)) break;
    }
    const double size = std::sqrt(branch.dot(next, next));
    if (!std::isfinite(size) || size == 0 || (k > 0 && size < least)) break;
    found.push_back(next);
    found.back().scale(1 / size);
  }
  tracker.hold({});
  return found;
}

void count_null_directions(Solution& at, const BranchState& before, const BranchState& after) {
  if (!at.morse_index || !at.nullity) return;
  const int not_positive =
      std::max({*at.morse_index + *at.nullity, before.index + before.nullity, after.index + after.nullity});
  at.morse_index = std::min({*at.morse_index, before.index, after.index});
  at.nullity = not_positive - *at.morse_index;
}

bool branches_cross(const BranchState& a, const BranchState& b) {
  return a.orientation != b.orientation || std::abs(a.index - b.index) >= 2;
}

bool may_cross(const BranchStep& step) {
  return branches_cross(step.from, step.to) || may_dip(crossings_on(step));
}

Crossings find_branch_points(Tracker& tracker, const EventSearch& search, const BranchStep& step) {
  const auto& [from, to, length] = step;
  Crossings found{.change = to.index - from.index};
  std::vector<Sample> samples = crossings_on(step);
  std::size_t left = most_samples;
  resolve(samples, [&](double at) {
    return left > 0 && left-- && tracker.reach(step.from, at, true) ? tracker.state.crossing : NAN;
  });
  const bool dips = std::ranges::any_of(samples, [&](const Sample& sample) {
    return sample.at > 0 && sample.at < step.length && changes_sign(sample.value, step.from.crossing);
  });
  if (!branches_cross(from, to) && !dips) return found;
  found.complete = false;
  BranchState before = from;
  double low = 0;
  for (const Sample& sample : samples) {
    if (sample.at <= low) continue;
    if (!tracker.reach(from, sample.at, true)) return found;
    const BranchState after = tracker.state;
    if (!find_between(tracker, search, {from, before, after, low, sample.at}, beyond_it * length, found))
      return found;
    found.change = after.index - from.index;
    before = after;
    low = sample.at;
  }
  found.complete = true;
  return found;
}

}  // namespace extremal
