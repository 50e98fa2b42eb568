#include "solve/contact/intervals.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "linear/dense.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/constraint_sets.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;

/// Gradients whose part across the others is smaller, relative, depend on them.
constexpr double dependence = 1e-6;

/// At a node; of inequalities whose gradients depend on each other, those held at the node before, then those
/// pressed most.
struct Pressed {
  int constraint;
  double force;
  bool before = false;
};

/// `basis`: orthonormal columns of the gradients of constraints.
std::vector<int> independent(std::vector<Pressed> pressed, const ConstraintValues& values,
                             Eigen::MatrixXd basis) {
  std::ranges::stable_sort(pressed, [](const Pressed& a, const Pressed& b) {
    return a.before != b.before ? a.before : a.force > b.force;
  });
  std::vector<int> held;
  for (const Pressed& each : pressed) {
    Eigen::VectorXd row = values.slopes.row(each.constraint);
    const double size = row.norm();
    for (int pass = 0; pass < 2; ++pass) row -= basis * (basis.transpose() * row).eval();
    if (!(row.norm() > dependence * size)) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = row.normalized();
    held.push_back(each.constraint);
  }
  std::ranges::sort(held);
  return held;
}

bool includes(const std::vector<int>& a, const std::vector<int>& b) { return std::ranges::includes(a, b); }

/// Where several inequalities are held on few elements, beside the ends of the path, a path passes a corner
/// rather than resting in it: it leaves one surface before it comes to another. One that the neighbours do
/// not hold is held there alone, or none; what is missing then is found as a violation.
void pass_corners(const CoarseAction& action, std::vector<Interval>& intervals) {
  std::vector<Interval> passed;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const Interval& interval = intervals[i];
    const double length = interval.to - interval.from;
    if (i == 0 || i + 1 == intervals.size() ||
        action.elements_in(interval.from, interval.to) > corner_elements || interval.held.size() < 2) {
      passed.push_back(interval);
      continue;
    }
    const std::vector<int>&before = intervals[i - 1].held, &after = intervals[i + 1].held;
    // One contact comes after the other, or on top of it.
    if (includes(before, interval.held) || includes(after, interval.held) ||
        (!(before.empty() && after.empty()) && (includes(before, after) || includes(after, before)))) {
      passed.push_back(interval);
      continue;
    }
    std::vector<int> alone;
    for (const int k : interval.held)
      if (alone.empty() && !std::ranges::binary_search(before, k) && !std::ranges::binary_search(after, k))
        alone = {k};
    passed.push_back({{}, interval.from, interval.from + length / 3});
    passed.push_back({alone, interval.from + length / 3, interval.to - length / 3});
    passed.push_back({{}, interval.to - length / 3, interval.to});
  }
  intervals = std::move(passed);
}

/// A point in between that is given belongs to a contact that lasts before and after it.
void hold_given_points(const Inequalities& inequalities, const CoarseAction& action,
                       std::span<const double> z, double size, std::vector<std::vector<int>>& held) {
  const auto n = static_cast<std::size_t>(action.coordinates());
  std::vector<char> compared(held.size());
  for (const NodeInequality& place : action.places()) compared[place.node] = 1;
  for (std::size_t node = 1; node + 1 < held.size(); ++node) {
    if (compared[node]) continue;
    const ConstraintValues values =
        inequalities.all->at(z.subspan(node * n, n), action.time(static_cast<int>(node)));
    for (const int c : held[node - 1])
      if (std::ranges::binary_search(held[node + 1], c) && on_surface(values, c, size))
        held[node].push_back(c);
  }
}

}  // namespace

std::vector<Interval> intervals_of(const Problem& problem, const CoarseAction& action,
                                   std::span<const double> z, std::span<const double> multipliers) {
  const Inequalities& inequalities = *problem.inequalities;
  const std::size_t n = problem.coordinates(), m = inequalities.count();
  const int elements = action.elements();
  const double force = action.force(z);
  double size = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t i = a; i < z.size(); i += n) size = std::max(size, std::abs(z[i] - z[a]));
  if (!(size > 0)) size = 1;
  std::vector<ConstraintValues> compared;
  std::vector<double> largest(m, 0.0);
  const auto pressure = [&](std::size_t place, std::size_t c) {
    const int node = action.places()[place].node;
    const double slope = compared[place / m].slopes.row(static_cast<Eigen::Index>(c)).norm();
    return multipliers[place + c] * slope / (action.cell_end(node) - action.cell_begin(node));
  };
  for (std::size_t place = 0; place < action.places().size(); place += m) {
    const int node = action.places()[place].node;
    compared.push_back(inequalities.all->at(z.subspan(node * n, n), action.time(node)));
    for (std::size_t c = 0; c < m; ++c) largest[c] = std::max(largest[c], pressure(place, c));
  }
  std::vector<std::vector<int>> held(elements + 1);
  for (std::size_t place = 0; place < action.places().size(); place += m) {
    const int node = action.places()[place].node;
    const ConstraintValues& values = compared[place / m];
    std::vector<Pressed> pressed;
    const double step = size * (action.cell_end(node) - action.cell_begin(node)) / problem.duration.value;
    for (std::size_t c = 0; c < m; ++c) {
      // The product of pressure and distance is the small barrier parameter; in contact the pressure is the
      // larger one: by the forces and the size of the path, and by the largest pressure and the way of a
      // node, since beside a small obstacle the first two are large.
      const auto row = static_cast<Eigen::Index>(c);
      const double pressed_by = pressure(place, c),
                   distance = std::abs(values.g[row]) / values.slopes.row(row).norm();
      if (pressed_by * size > distance * force && pressed_by * step > distance * largest[c])
        pressed.push_back({static_cast<int>(c), pressed_by,
                           node > 0 && std::ranges::binary_search(held[node - 1], static_cast<int>(c))});
    }
    Eigen::MatrixXd basis(n, 0);
    if (problem.manifold)
      basis = orthonormal(problem.manifold->at(z.subspan(node * n, n), action.time(node)).slopes.transpose());
    held[node] = independent(std::move(pressed), values, std::move(basis));
  }
  hold_given_points(inequalities, action, z, size, held);
  // An end that is given belongs to a contact that lasts until there; what a free end holds alone is touched.
  std::vector<int> at_start, at_end;
  for (const int node : {0, elements}) {
    const int next = node == 0 ? 1 : elements - 1;
    const bool compared = !action.places().empty() && (node == 0 ? action.places().front().node == 0
                                                                 : action.places().back().node == elements);
    if (compared && !problem.periodic) {
      std::vector<int>& touched = node == 0 ? at_start : at_end;
      touched = sorted_difference(held[node], held[next]);
      held[node] = sorted_difference(held[node], touched);
    }
    if (problem.periodic && node == elements) held[node] = held[next];
    if (compared || problem.periodic) continue;
    const ConstraintValues values = inequalities.all->at(z.subspan(node * n, n), action.time(node));
    for (const int c : held[next])
      if (on_surface(values, c, size)) held[node].push_back(c);
  }
  std::vector<Interval> intervals;
  for (int k = 0; k <= elements; ++k) {
    const double from = action.cell_begin(k), to = action.cell_end(k);
    if (!intervals.empty() && intervals.back().held == held[k]) {
      intervals.back().to = to;
      continue;
    }
    // Between contacts neither of which includes the other, only what both hold is held for a moment.
    if (!intervals.empty() && !includes(intervals.back().held, held[k]) &&
        !includes(held[k], intervals.back().held)) {
      std::vector<int> both;
      std::ranges::set_intersection(intervals.back().held, held[k], std::back_inserter(both));
      const double quarter = 0.25 * std::min(from - intervals.back().from, to - from);
      intervals.back().to = from - quarter;
      intervals.push_back({std::move(both), from - quarter, from + quarter});
      intervals.push_back({held[k], from + quarter, to});
      continue;
    }
    intervals.push_back({held[k], from, to});
  }
  pass_corners(action, intervals);
  intervals.front().at_start = std::move(at_start);
  intervals.back().at_end = std::move(at_end);
  return intervals;
}

void tidy(std::vector<Interval>& intervals, double duration) {
  std::vector<Interval> kept;
  std::vector<int> at_start = std::move(intervals.front().at_start),
                   at_end = std::move(intervals.back().at_end);
  for (Interval& interval : intervals) {
    interval.at_start.clear();
    interval.at_end.clear();
    if (!(interval.to - interval.from > shortest_arc * duration)) continue;
    if (!kept.empty() && kept.back().held == interval.held && interval.touched < 0)
      kept.back().to = interval.to;
    else
      kept.push_back(std::move(interval));
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i > 0) kept[i].from = kept[i - 1].to;
  }
  kept.front().from = 0;
  kept.back().to = duration;
  kept.front().at_start = std::move(at_start);
  kept.back().at_end = std::move(at_end);
  intervals = std::move(kept);
}

void leave_out(std::vector<Interval>& intervals, int number, double duration) {
  if (intervals.size() < 2) return;
  const Interval gone = intervals[number];
  const std::size_t next = number;
  const bool inner = next > 0 && next + 1 < intervals.size();
  if (inner && intervals[next - 1].held == intervals[next + 1].held && gone.touched < 0 &&
      intervals[next + 1].touched < 0 && gone.held.size() == intervals[next - 1].held.size() + 1)
    intervals[next + 1].touched = sorted_difference(gone.held, intervals[next - 1].held).front();
  intervals.erase(intervals.begin() + number);
  if (next == 0) {
    intervals.front().from = gone.from;
    intervals.front().at_start =
        sorted_difference(sorted_union(gone.held, gone.at_start), intervals.front().held);
  } else if (next == intervals.size()) {
    intervals.back().to = gone.to;
    intervals.back().at_end = sorted_difference(sorted_union(gone.held, gone.at_end), intervals.back().held);
  } else {
    intervals[next - 1].to = intervals[next].from = (gone.from + gone.to) / 2;
  }
  if (next == 0) intervals.front().touched = -1;
  tidy(intervals, duration);
}

void change(std::vector<Interval>& intervals, int constraint, bool held, double from, double to,
            double duration) {
  std::vector<Interval> changed;
  for (const Interval& interval : intervals) {
    const double a = std::clamp(from, interval.from, interval.to),
                 b = std::clamp(to, interval.from, interval.to);
    Interval middle = interval;
    const auto found = std::ranges::find(middle.held, constraint);
    if (held && found == middle.held.end()) {
      middle.held.push_back(constraint);
      std::ranges::sort(middle.held);
    } else if (!held && found != middle.held.end()) {
      middle.held.erase(found);
    }
    changed.push_back({interval.held, interval.from, a, interval.touched});
    changed.push_back({middle.held, a, b});
    changed.push_back({interval.held, b, interval.to});
  }
  changed.front().at_start = intervals.front().at_start;
  changed.back().at_end = intervals.back().at_end;
  intervals = std::move(changed);
  tidy(intervals, duration);
}

bool on_surface(const ConstraintValues& values, int constraint, double size) {
  return std::abs(values.g[constraint]) <= on_it * size * values.slopes.row(constraint).norm();
}

}  // namespace extremal
