#include "solve/leg_solve.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "problem/extension.hpp"
#include "solution/guessed_by.hpp"

namespace extremal {

namespace {

/// The problem of one leg, from one waypoint that fixes all to the next; −1 and their count: the ends.
class Leg {
 public:
  Leg(const Problem& problem, int first, int last)
      : problem_(problem), first_(first), last_(last), from_(time_of(first)), to_(time_of(last)) {}

  double from() const { return from_; }

  /// Nothing where a condition links its end with another.
  std::optional<Problem> problem() const {
    Problem leg;
    leg.lagrangian = problem_.lagrangian;
    leg.manifold = problem_.manifold;
    leg.paired = problem_.paired;
    leg.names = problem_.names;
    leg.duration.value = to_ - from_;
    leg.boundary.coordinates = problem_.coordinates();
    if (!put_end(first_, false, leg.boundary) || !put_end(last_, true, leg.boundary)) return std::nullopt;
    if (last_ - first_ > 1) leg.extension = waypoints();
    leg.guess = guess();
    return make_problem(std::move(leg));
  }

 private:
  const std::vector<WaypointCondition>& all() const { return problem_.extension->waypoints; }
  bool is_end(int waypoint) const { return waypoint < 0 || waypoint == std::ssize(all()); }

  double time_of(int waypoint) const {
    if (waypoint < 0) return 0;
    return is_end(waypoint) ? problem_.duration.value : all()[waypoint].time;
  }

  bool put_end(int waypoint, bool at_end, BoundaryRelation& relation) const {
    if (is_end(waypoint)) return put_rows(at_end, relation);
    for (const auto& [a, value] : all()[waypoint].fixed) relation.fix(a, at_end, value);
    return true;
  }

  /// The rows of the whole relation that are about this end alone, and the momenta there.
  bool put_rows(bool at_end, BoundaryRelation& relation) const {
    const BoundaryRelation& whole = problem_.boundary;
    const int n = problem_.coordinates();
    std::vector<int> row(whole.rows, -1), other(whole.rows, 0);
    for (const Triplet& entry : whole.matrix) {
      if ((entry.column >= n) != at_end) {
        other[entry.row] = 1;
        continue;
      }
      if (row[entry.row] < 0) row[entry.row] = relation.add_row(whole.value[entry.row]);
      relation.add(row[entry.row], entry.column, entry.value);
    }
    if (!whole.momenta.empty()) {
      relation.momenta.resize(2 * static_cast<std::size_t>(n));
      const int begin = at_end ? n : 0;
      std::copy_n(whole.momenta.begin() + begin, n, relation.momenta.begin() + begin);
    }
    for (int r = 0; r < whole.rows; ++r)
      if (row[r] >= 0 && other[r]) return false;
    return true;
  }

  std::shared_ptr<const Extension> waypoints() const {
    auto extension = std::make_shared<Extension>(*problem_.extension);
    extension->waypoints.assign(all().begin() + first_ + 1, all().begin() + last_);
    for (WaypointCondition& waypoint : extension->waypoints) {
      const double unit = waypoint.free ? problem_.duration.value : 1;
      waypoint.time = (waypoint.time * unit - from_) / (waypoint.free ? to_ - from_ : 1);
    }
    return extension;
  }

  Guess guess() const {
    const auto n = static_cast<std::size_t>(problem_.coordinates());
    const double T = problem_.duration.value, first = from_ / T, last = to_ / T;
    std::vector<double> at{first};
    std::ranges::copy_if(problem_.guess.tau, std::back_inserter(at),
                         [&](double tau) { return tau > first && tau < last; });
    at.push_back(last);
    Guess guess;
    guess.q.resize(at.size() * n);
    for (std::size_t k = 0; k < at.size(); ++k) {
      guess.tau.push_back((at[k] - first) / (last - first));
      problem_.guess.at(at[k], {guess.q.data() + k * n, n});
    }
    guess.tau.back() = 1;
    return guess;
  }

  const Problem& problem_;
  int first_, last_;
  double from_, to_;
};

/// Adds a leg to the guess of the whole; its first point is that which the leg before ends with.
void add_points(const Trajectory& leg, double from, double duration, Guess& guess) {
  const Guess own = guess_of(leg);
  const std::size_t n = leg.coordinates, first = guess.given() ? 1 : 0;
  for (std::size_t k = first; k < own.tau.size(); ++k)
    guess.tau.push_back(std::min(1.0, (from + own.tau[k] * leg.duration()) / duration));
  guess.q.insert(guess.q.end(), own.q.begin() + static_cast<std::ptrdiff_t>(first * n), own.q.end());
}

}  // namespace

std::optional<std::vector<LegProblem>> separate_legs(const Problem& problem) {
  const Extension& extension = *problem.extension;
  const bool common = extension.constants() > 0 || !extension.conditions.empty() ||
                      !extension.end_terms.empty() || !extension.where.empty() || problem.duration.free;
  // At another time L would be another one.
  if (common || !problem.lagrangian->structure().autonomous || !problem.guess.given()) return std::nullopt;
  const int count = static_cast<int>(extension.waypoints.size());
  std::vector<LegProblem> legs;
  for (int first = -1, last = 0; last <= count; ++last) {
    if (last < count) {
      const WaypointCondition& waypoint = extension.waypoints[last];
      if (waypoint.free || std::ssize(waypoint.fixed) < problem.coordinates()) continue;
    }
    if (first < 0 && last == count) return std::nullopt;  // one leg
    const Leg leg(problem, first, last);
    std::optional<Problem> own = leg.problem();
    if (!own) return std::nullopt;
    legs.push_back({*std::move(own), leg.from()});
    first = last;
  }
  return legs;
}

Problem guessed_by_legs(const Problem& problem, const std::vector<LegProblem>& legs,
                        const std::vector<const Trajectory*>& paths) {
  Problem guessed = problem;
  guessed.guess = {};
  for (std::size_t k = 0; k < legs.size(); ++k)
    add_points(*paths[k], legs[k].from, problem.duration.value, guessed.guess);
  guessed.guess.tau.back() = 1;
  return guessed;
}

std::vector<std::vector<int>> least_combinations(const std::vector<std::vector<double>>& actions, int most) {
  std::vector<std::pair<double, std::vector<int>>> least = {{0, {}}};
  for (const std::vector<double>& of_leg : actions) {
    std::vector<std::pair<double, std::vector<int>>> longer;
    for (const auto& [sum, numbers] : least)
      for (std::size_t k = 0; k < of_leg.size(); ++k) {
        longer.emplace_back(sum + of_leg[k], numbers);
        longer.back().second.push_back(static_cast<int>(k));
      }
    std::ranges::sort(longer);
    if (std::ssize(longer) > most) longer.resize(static_cast<std::size_t>(most));
    least = std::move(longer);
  }
  std::vector<std::vector<int>> combinations;
  for (auto& [sum, numbers] : least) combinations.push_back(std::move(numbers));
  return combinations;
}

}  // namespace extremal
