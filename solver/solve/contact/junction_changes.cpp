#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/contact/constraint_sets.hpp"
#include "solve/contact/junctions.hpp"
#include "solve/contact/limits.hpp"

/// \file Contacts that begin, or end, shortly one after the other.

namespace extremal {

namespace {

using namespace limits::contact;
using Eigen::Index;
using Eigen::VectorXd;

/// dg_k/dt of an arc at one of its times.
double rate_of(const Manifold& all, const SolvedArc& arc, double from, double t, int constraint) {
  const std::size_t n = arc.trajectory.coordinates;
  std::vector<double> q(n), v(n);
  arc.trajectory.at(t, q, v);
  const ConstraintValues values = all.at(q, from + t);
  return values.slopes.row(constraint).dot(Eigen::Map<const VectorXd>(v.data(), static_cast<Index>(n))) +
         values.rates[constraint];
}

}  // namespace

/// Beside a contact that is alone g_k = a (t − t_k)²/2 on the side where it is not held. So the rate of g_k
/// at the junction, by its slope a, is what the junction is late for t_k.
std::vector<Junctions::Change> Junctions::changes_at(int junction) const {
  const PathArc &before = parts_[junction], &after = parts_[junction + 1];
  const std::vector<int> begun = sorted_difference(after.held, before.held),
                         ended = sorted_difference(before.held, after.held);
  if (begun.size() + ended.size() < 2 || (!begun.empty() && !ended.empty())) return {};
  const bool at_end = !begun.empty();  // of the arc on which they are not held
  const PathArc& free = at_end ? before : after;
  const SolvedArc& solved = solved_[at_end ? junction : junction + 1];
  const double length = solved.trajectory.duration(), part = difference * length;
  const double reach = most_apart * std::min(before.to - before.from, after.to - after.from);
  std::vector<std::pair<double, int>> times;
  const std::shared_ptr<const Manifold> all = arcs_.inequalities(constants());
  for (const int k : at_end ? begun : ended) {
    const double t = at_end ? length : 0, beside = at_end ? length - part : part;
    const double rate = rate_of(*all, solved, free.from, t, k);
    const double slope = (rate - rate_of(*all, solved, free.from, beside, k)) / (t - beside);
    const double late = slope > 0 ? std::clamp(rate / slope, -reach, reach) : std::copysign(reach, rate);
    times.emplace_back(state_.t[junction] - late, k);
  }
  std::ranges::sort(times);
  // Times that are near each other, by all of them, are told apart on arcs that are there already.
  const double spread = times.back().first - times.front().first;
  const double told = std::max(apart * shortest_arc * duration(), told_apart * spread);
  std::vector<Change> changes;
  for (const auto& [time, k] : times) {
    if (changes.empty() || time - changes.back().time > told) changes.push_back({{}, time});
    changes.back().constraints.push_back(k);
  }
  for (Change& change : changes) std::ranges::sort(change.constraints);
  return changes;
}

/// Whether a junction has changes at more than one time.
bool Junctions::find_changes() {
  changes_.clear();
  bool several = false;
  for (int j = 0; j < count(); ++j) {
    changes_.push_back(touched_[j] < 0 ? changes_at(j) : std::vector<Change>{});
    several = several || changes_.back().size() > 1;
  }
  return several;
}

std::vector<Interval> Junctions::separated(const std::vector<Interval>& intervals) const {
  std::vector<Interval> all;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const bool split = i > 0 && changes_[i - 1].size() > 1;
    const double from = split ? changes_[i - 1].back().time : parts_[i].from;
    if (split) {
      const std::vector<Change>& changes = changes_[i - 1];
      const bool begin = parts_[i].held.size() > parts_[i - 1].held.size();
      all.back().to = changes.front().time;
      for (std::size_t c = 0; c + 1 < changes.size(); ++c) {
        const std::vector<int>& held = all.back().held;
        all.push_back({begin ? sorted_union(held, changes[c].constraints)
                             : sorted_difference(held, changes[c].constraints),
                       changes[c].time, changes[c + 1].time});
      }
    }
    Interval interval = intervals[i];
    interval.from = from;
    interval.to = parts_[i].to;
    all.push_back(std::move(interval));
  }
  return all;
}

}  // namespace extremal
