#include "solve/contact/contact_check.hpp"

#include <algorithm>
#include <cmath>

#include "machine/bisect.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/constraint_sets.hpp"
#include "solve/contact/limits.hpp"

namespace extremal {

namespace {

using namespace limits::contact;

/// A quantity of one inequality along one arc; it must not be negative.
struct Sampled {
  std::vector<double> t, values;
};

/// The stretch about the least value in which values are negative; times at its ends.
Violation stretch(const Sampled& sampled, std::size_t least, int constraint, bool forbidden) {
  std::size_t first = least, last = least;
  while (first > 0 && sampled.values[first - 1] < 0) --first;
  while (last + 1 < sampled.values.size() && sampled.values[last + 1] < 0) ++last;
  if (forbidden && first > 0) --first;
  if (forbidden && last + 1 < sampled.t.size()) ++last;
  return {constraint, forbidden, sampled.t[first], sampled.t[last], -sampled.values[least]};
}

/// Points in each element, ends included, no farther from each other than `most`.
std::vector<double> times_of(const Trajectory& path, double most = INFINITY) {
  std::vector<double> times;
  for (int k = 0; k < path.elements(); ++k) {
    const int count = std::max(points, static_cast<int>(std::ceil(path.length(k) / most)));
    for (int i = 0; i < count; ++i) times.push_back(path.times[k] + path.length(k) * i / count);
  }
  times.push_back(path.duration());
  return times;
}

struct Least {
  double t, value;
};

/// The least value between two times, by golden sections.
template <class Function>
Least least_between(double a, double b, const Function& f) {
  constexpr double part = 0.381966011250105;
  double x = a + part * (b - a), y = b - part * (b - a), fx = f(x), fy = f(y);
  for (int k = 0; k < 24; ++k) {
    if (fx < fy) {
      b = y;
      y = x;
      fy = fx;
      x = a + part * (b - a);
      fx = f(x);
    } else {
      a = x;
      x = y;
      fx = fy;
      y = b - part * (b - a);
      fy = f(y);
    }
  }
  return fx < fy ? Least{x, fx} : Least{y, fy};
}

/// Between a time at which f is not negative and one at which it is: the last of the first kind, about.
template <class Function>
double last_kept(double kept, double forbidden, const Function& f) {
  constexpr int halvings = 12;  // a place that is told needs no more digits
  return bisect(kept, forbidden, halvings, [&](double t) { return !(f(t) < 0); }).low;
}

class LawCheck {
 public:
  LawCheck(Arcs& arcs, const Junctions& path)
      : arcs_(arcs),
        path_(path),
        inequalities_(*arcs.problem().inequalities),
        n_(arcs.problem().coordinates()),
        q_(n_),
        v_(n_) {}

  std::optional<Violation> run() {
    for (std::size_t i = 0; i < path_.arcs().size(); ++i) check_distances(i, INFINITY);
    if (worst_) return worst_;
    for (std::size_t i = 0; i < path_.arcs().size(); ++i)
      if (!path_.arcs()[i].held.empty()) check_forces(i);
    if (worst_) return worst_;
    for (std::size_t i = 0; i < path_.arcs().size(); ++i) check_distances(i, path_.duration() / dense_points);
    return worst_;
  }

 private:
  /// g_k as a distance, at a time of an arc.
  double distance(std::size_t arc, int constraint, double t) {
    path_.solved()[arc].trajectory.at(t, q_, v_);
    const ConstraintValues values = inequalities_.all->at(q_, path_.arcs()[arc].from + t);
    const double slope = values.slopes.row(constraint).norm();
    return values.g[constraint] / (slope > 0 ? slope : 1);
  }

  /// At times that are no farther from each other than `most`.
  void check_distances(std::size_t i, double most) {
    const PathArc& arc = path_.arcs()[i];
    const Trajectory& trajectory = path_.solved()[i].trajectory;
    const double tolerance = arcs_.options().tolerance * path_.size();
    Sampled sampled{times_of(trajectory, most), {}};
    for (int k = 0; k < inequalities_.count(); ++k) {
      sampled.values.clear();
      for (const double t : sampled.t) sampled.values.push_back(distance(i, k, t) + tolerance);
      const std::size_t least = std::ranges::min_element(sampled.values) - sampled.values.begin();
      const double a = sampled.t[least > 0 ? least - 1 : 0],
                   b = sampled.t[std::min(least + 1, sampled.t.size() - 1)];
      const auto at = [&](double t) { return distance(i, k, t) + tolerance; };
      const Least between = least_between(a, b, at);
      const bool seen = sampled.values[least] < 0;
      if (!seen && !(between.value < 0)) continue;
      Violation violation = stretch(sampled, least, k, true);
      violation.amount = std::max(violation.amount, -between.value);
      // Of a stretch between two samples the ends are looked for.
      if (!seen) {
        violation.from = last_kept(a, between.t, at);
        violation.to = last_kept(b, between.t, at);
      }
      keep(violation, arc.from);
    }
  }

  void check_forces(std::size_t i) {
    const PathArc& arc = path_.arcs()[i];
    const Trajectory& trajectory = path_.solved()[i].trajectory;
    const std::shared_ptr<const Manifold> manifold = arcs_.manifold(arc);
    std::vector<Sampled> sampled(arc.held.size(), {times_of(trajectory), {}});
    const int constraints = arcs_.constraints();
    double largest = 0;
    for (const double t : sampled.front().t) {
      trajectory.at(t, q_, v_);
      manifold->project(q_, arc.from + t);
      manifold->make_tangent(q_, arc.from + t, v_);
      const std::vector<double> forces = manifold->multipliers(q_, arc.from + t, v_);
      for (std::size_t h = 0; h < sampled.size(); ++h) {
        sampled[h].values.push_back(-forces[constraints + h]);
        largest = std::max(largest, std::abs(forces[constraints + h]));
      }
    }
    for (std::size_t h = 0; h < sampled.size(); ++h) {
      for (double& force : sampled[h].values) force += negative_force * largest;
      const std::size_t least = std::ranges::min_element(sampled[h].values) - sampled[h].values.begin();
      if (sampled[h].values[least] < 0) keep(stretch(sampled[h], least, arc.held[h], false), arc.from);
    }
  }

  void keep(Violation violation, double from) {
    if (worst_ && worst_->amount >= violation.amount) return;
    violation.from += from;
    violation.to += from;
    worst_ = violation;
  }

  Arcs& arcs_;
  const Junctions& path_;
  const Inequalities& inequalities_;
  std::size_t n_;
  std::vector<double> q_, v_;
  std::optional<Violation> worst_;
};

/// Times of elements that end where arcs do, and at waypoints.
std::vector<double> aligned_times(const Junctions& path, int elements) {
  std::vector<double> times = {0};
  for (std::size_t part = 0; part < path.arcs().size(); ++part) {
    const PathArc& arc = path.arcs()[part];
    const SolvedArc& solved = path.solved()[part];
    const double share = (arc.to - arc.from) / path.duration();
    // By elements that turn by θ each the second variation of a contact of length τ is too small by θ⁴/12 of
    // a displacement along it, squared, over their length. That of the path beside it is a few 1/T: of m
    // elements that turn by less than π, (T/τ)/m³ is to be small.
    const double turning = arc.held.empty() ? 0 : elements * turn_elements * std::cbrt(1 / share);
    const int count =
        std::max(least_arc_elements, static_cast<int>(std::lround(std::max(share * elements, turning))));
    for (int i = 1; i <= count; ++i)
      times.push_back(i == count ? arc.to : arc.from + (arc.to - arc.from) * i / count);
    for (const WaypointImpulse& waypoint : solved.waypoints) times.push_back(waypoint.time);
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// μ of all inequalities, the mean between two times that are near each other; where a contact begins between
/// them, its force counts in part.
std::vector<double> mean_forces(Arcs& arcs, const Junctions& path, double from, double to) {
  const std::size_t n = arcs.problem().coordinates();
  std::vector<double> forces(arcs.problem().inequalities->count()), q(n), v(n);
  for (std::size_t i = 0; i < path.arcs().size(); ++i) {
    const PathArc& arc = path.arcs()[i];
    const double begin = std::max(from, arc.from), end = std::min(to, arc.to), t = (begin + end) / 2;
    if (arc.held.empty() || !(end > begin)) continue;
    const Trajectory& trajectory = path.solved()[i].trajectory;
    trajectory.at(std::clamp(t - arc.from, 0.0, trajectory.duration()), q, v);
    const std::shared_ptr<const Manifold> manifold = arcs.manifold(arc);
    manifold->make_tangent(q, t, v);
    const std::vector<double> found = manifold->multipliers(q, t, v);
    for (std::size_t h = 0; h < arc.held.size(); ++h)
      forces[arc.held[h]] -= (end - begin) / (to - from) * found[arcs.constraints() + h];
  }
  return forces;
}

/// Whether the second variation is positive on about so many elements.
bool is_positive(Arcs& arcs, const Junctions& path, int elements) {
  const Problem& problem = arcs.problem();
  const std::size_t n = problem.coordinates();
  const CoarseAction action(problem, aligned_times(path, elements));
  std::vector<double> z((action.elements() + 1) * n), v(n);
  CoarseContacts contacts;
  contacts.held.resize(action.elements() + 1);
  contacts.forces.resize(contacts.held.size());
  std::size_t i = 0;
  for (int k = 0; k <= action.elements(); ++k) {
    const double t = action.time(k);
    while (i + 1 < path.arcs().size() && t >= path.arcs()[i].to) ++i;
    const PathArc& arc = path.arcs()[i];
    const Trajectory& trajectory = path.solved()[i].trajectory;
    trajectory.at(std::clamp(t - arc.from, 0.0, trajectory.duration()), {z.data() + k * n, n}, v);
    contacts.held[k] = arc.held;
    if (i > 0 && t == arc.from) contacts.held[k] = sorted_union(path.arcs()[i - 1].held, arc.held);
    contacts.forces[k] = mean_forces(arcs, path, action.cell_begin(k), action.cell_end(k));
  }
  const std::vector<EndContact>& ends = path.end_contacts();
  contacts.ends = path.end_curvature();
  const std::vector<double>& constants = path.constants();
  contacts.multipliers = {constants.end() - action.integrals(), constants.end()};
  for (std::size_t c = 0; c < ends.size(); ++c)
    if (!ends[c].holonomic) {
      std::vector<int>& held = ends[c].at_end ? contacts.held.back() : contacts.held.front();
      if (!std::ranges::binary_search(held, ends[c].constraint)) held.push_back(ends[c].constraint);
      std::ranges::sort(held);
    }
  return action.positive(z, contacts);
}

}  // namespace

std::optional<Violation> worst_violation(Arcs& arcs, const Junctions& path) {
  return LawCheck(arcs, path).run();
}

/// Zero within the error of few elements is positive on more.
bool is_minimum(Arcs& arcs, const Junctions& path) {
  const int n = arcs.problem().coordinates();
  return std::ranges::any_of(variation_elements, [&](int elements) {
    return is_positive(arcs, path, std::min(elements, most_unknowns / n));
  });
}

}  // namespace extremal
