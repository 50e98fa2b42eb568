#include "solve/branch/other_branches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/bifurcation_equations.hpp"
#include "solve/branch/common_symmetries.hpp"
#include "solve/branch/half_period.hpp"
#include "solve/branch/limits.hpp"

namespace extremal {

using namespace limits::other_branches;

namespace {

/// A branch point: its state, with the tangent of the known branch, and the null directions.
class BranchPointCentre {
 public:
  BranchPointCentre(const ProblemFamily& family, const SolveOptions& options, const BranchStart& start)
      : family_(family),
        options_(options),
        at_rest_(limits::continuation::rest * start.units.extent),
        twice_(start.kind == PointKind::period_doubling),
        tracker_(family, options.tolerance) {
    if (start.regular) tracker_.branch().set_regular();
    if (!tracker_.begin(start.beside.path, start.beside.coordinate, start.units, at_rest_)) return;
    Move response;
    if (!tracker_.respond(response)) return;
    centre_ = tracker_.state;
    null_ = singular_directions(tracker_, response, start.count, 0);
    centre_.path = start.at.path;
    centre_.coordinate = start.at.coordinate;
    centre_.varied = start.at.varied;
  }

  int count() const { return static_cast<int>(null_.size()); }

  /// The bifurcation equations at this distance.
  std::optional<BifurcationEquations> equations(double distance) {
    tracker_.hold(null_);
    auto found = BifurcationEquations::measure(count(), distance,
                                               [&](const Departure& departure) { return forces(departure); });
    tracker_.hold({});
    return found;
  }

  /// The state on the branch that begins in this direction, so far from the point; nothing if there is none.
  /// It is reached across its direction from the point, twice, so that copies are equally far. The branch may
  /// turn on that way.
  std::optional<BranchState> first_state(const Departure& departure, double distance) {
    const Branch& branch = tracker_.branch();
    BranchState from = centre_;
    from.tangent = move(departure);
    for (const bool same_elements : {true, true, false}) {
      from.tangent.scale(1 / std::sqrt(branch.dot(from.tangent, from.tangent)));
      if (!tracker_.reach(from, distance, same_elements)) return std::nullopt;
      // Where several directions are open at once, so near nothing tells paths in between from extremals.
      if (branch.regular() && branch.open() > 0) return std::nullopt;
      if (!same_elements) break;
      from.tangent = tracker_.difference_to(centre_);
      from.tangent.scale(-1);
    }
    if (twice_ && repeats_half(tracker_.state, distance)) return std::nullopt;
    return tracker_.state;
  }

  /// Whether the state is beyond the value that the family leads to, as seen from the point.
  bool passed(const BranchState& state) const {
    return (state.varied - family_.to) * (centre_.varied - family_.to) < 0;
  }

  /// Whether a symmetry maps the branches of two states, as far from the point, onto each other: with the
  /// same value, extremals of both have the same action and the same duration. `gap`: from the action of the
  /// known branch to that of theirs.
  bool are_copies(const BranchState& a, const BranchState& b, double gap) {
    const bool paired = tracker_.branch().problem().paired;  // the action of two copies is zero
    const double way = a.varied - centre_.varied, other_way = b.varied - centre_.varied;
    if (std::abs(way - other_way) > (paired ? copies : nearly_as_far) * std::abs(way)) return false;
    if (!tracker_.begin(b, at_rest_) || !tracker_.land(a.varied)) return false;
    const BranchState& state = tracker_.state;
    const double roundoff = action_roundoff * (std::abs(a.action) + a.energy_time);
    const double duration = a.path.duration();
    return std::abs(state.action - a.action) <= copies * std::abs(gap) + roundoff &&
           std::abs(state.path.duration() - duration) <= copies * duration;
  }

  bool out_of_time() const { return options_.deadline.passed(); }

 private:
  /// Null directions turn their sign after half of the doubled period, so that a path so far along them
  /// differs by twice as much from itself half a period later.
  bool repeats_half(const BranchState& state, double distance) const {
    return has_half_period(family_, state.varied, trajectory_of(state.path), distance * state.units.extent);
  }

  Move move(const Departure& departure) const {
    Move sum = centre_.tangent;
    sum.scale(departure.along);
    for (int k = 0; k < count(); ++k) sum.add(null_[k], departure.across[k]);
    return sum;
  }

  std::optional<Eigen::VectorXd> forces(const Departure& departure) {
    if (out_of_time() || !tracker_.reach(centre_, move(departure))) return std::nullopt;
    Eigen::VectorXd found(count());
    for (int k = 0; k < count(); ++k) found[k] = tracker_.branch().force_along(null_[k]);
    return found;
  }

  const ProblemFamily& family_;
  const SolveOptions& options_;
  const double at_rest_;
  const bool twice_;
  Tracker tracker_;
  BranchState centre_;
  std::vector<Move> null_;
};

/// A branch on one way from the point.
struct Way {
  Departure departure;
  BranchState state;
};

bool are_opposite(const Departure& a, const Departure& b) {
  return a.across.dot(b.across) <= opposite * a.across.squaredNorm();
}

/// Branches at this distance from the point: those that each solution of the bifurcation equations leads to.
struct Ways {
  std::vector<Way> found = {};
  bool complete = false;  ///< each does
  bool passed = false;    ///< one of them beyond the value wanted
};

/// Of one null direction it is the direction of the branch to first order, where differences of forces are
/// not known.
std::vector<Departure> directions(const std::optional<BifurcationEquations>& equations, int count,
                                  double distance, bool both_ways) {
  if (equations) return equations->solutions();
  if (count > 1) return {};
  std::vector<Departure> found = {{0, Eigen::VectorXd::Constant(1, distance)}};
  if (both_ways) found.push_back({0, Eigen::VectorXd::Constant(1, -distance)});
  return found;
}

Ways ways_at(BranchPointCentre& centre, double distance, bool both_ways) {
  const std::optional<BifurcationEquations> equations = centre.equations(distance);
  const std::vector<Departure> solutions = directions(equations, centre.count(), distance, both_ways);
  Ways ways;
  ways.complete = !solutions.empty();
  for (const Departure& solution : solutions) {
    const std::optional<BranchState> state = centre.first_state(solution, distance);
    ways.complete = ways.complete && state;
    if (!state) continue;
    ways.passed = ways.passed || centre.passed(*state);
    const bool copy = std::ranges::any_of(ways.found, [&](const Way& known) {
      if (both_ways && are_opposite(known.departure, solution)) return false;
      return centre.are_copies(known.state, *state, equations ? equations->potential(solution) : 0);
    });
    if (!copy) ways.found.push_back({solution, *state});
  }
  return ways;
}

}  // namespace

OtherBranches other_branches(const ProblemFamily& family, const SolveOptions& options,
                             const BranchStart& start) {
  const ProblemFamily common = with_common_symmetries(family);
  BranchPointCentre centre(common, options, start);
  Ways most;
  for (double distance = farthest; distance > nearest; distance *= shorter) {
    if (centre.count() == 0 || centre.count() > most_directions || centre.out_of_time()) break;
    Ways ways = ways_at(centre, distance, start.kind == PointKind::branch);
    const bool done = ways.complete && !ways.passed;
    const bool more =
        ways.found.size() > most.found.size() || (ways.found.size() == most.found.size() && most.passed);
    if (ways.complete > most.complete || (ways.complete == most.complete && more)) most = std::move(ways);
    if (done) break;
  }
  OtherBranches result{.complete = most.complete};
  for (Way& way : most.found) result.found.push_back({std::move(way.state), start.regular});
  return result;
}

}  // namespace extremal
