#include "problem/recurrence.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "machine/roundoff.hpp"
#include "problem/closing.hpp"
#include "problem/nearby.hpp"
#include "problem/problem.hpp"

namespace extremal {

namespace {

using Eigen::VectorXd;

/// Changes below this, relative to forces and momenta, are roundoff; and of a quotient of differences, to the
/// larger of those of any coordinate.
constexpr double unchanged = 1e-10, change_roundoff = 1e-13;
/// Points evenly over [0, T), where t may make pulses, and beyond; tries for each where L is not finite.
constexpr int points_within = 24, points_for_pulses = 96, points_beyond = 8, tries_a_point = 4;
/// f'(0) = Σ w_i (f(ih) − f(−ih))/h to eighth order, with so many h in T.
constexpr double weights[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
constexpr double steps_a_duration = 512;
/// Common periods are looked for among so many of the longest; a shorter one among so many parts.
constexpr int most_periods = 1000, most_parts = 12;

/// q(T) = R q(0) + c, R with few entries.
struct SparseClosing {
  Eigen::SparseMatrix<double> r;
  VectorXd c;
  bool identity = false;
};

SparseClosing sparse_closing(const Problem& problem) {
  const int n = problem.coordinates();
  SparseClosing closing{Eigen::SparseMatrix<double>(n, n), VectorXd::Zero(n)};
  std::vector<Eigen::Triplet<double>> entries;
  bool solved = true;  // for q(T), row by row
  for (const Triplet& entry : problem.boundary.matrix) {
    if (entry.column < n)
      entries.emplace_back(entry.row, entry.column, -entry.value);
    else
      solved = solved && entry.column - n == entry.row && entry.value == 1;
  }
  if (solved) {
    closing.r.setFromTriplets(entries.begin(), entries.end());
    closing.c = Eigen::Map<const VectorXd>(problem.boundary.value.data(), n);
  } else {
    const ClosingMap dense = closing_map(problem);
    closing.r = dense.r.sparseView();
    closing.c = dense.c;
  }
  closing.identity = closing.c.isZero(0);
  for (int a = 0; a < n && closing.identity; ++a)
    closing.identity = closing.r.coeff(a, a) == 1 && closing.r.col(a).nonZeros() == 1;
  return closing;
}

/// A place on a path q + q' s + q'' s²/2.
struct Place {
  VectorXd q, v, a;
  bool draw(NearbyPoints& points, double duration) {
    std::vector<double> at, direction;
    points.next(at, direction);
    q = Eigen::Map<const VectorXd>(at.data(), std::ssize(at));
    const double rate = 2 * std::numbers::pi / duration;
    v = rate * Eigen::Map<const VectorXd>(direction.data(), std::ssize(at));
    points.next(at, direction);
    a = rate * rate * Eigen::Map<const VectorXd>(direction.data(), std::ssize(at));
    return q.allFinite();
  }
};

/// p = ∂L/∂q', ∂L/∂q and dp/dt along the path.
struct Slopes {
  VectorXd p, force, rate;
  VectorXd residual() const { return force - rate; }
};

class PathSlopes {
 public:
  explicit PathSlopes(const Lagrangian& lagrangian) : lagrangian_(lagrangian) {}

  Slopes at(const Place& place, double t, double step) {
    PointValues here = values(place, t, 0);
    Slopes slopes{vector(here.dv), vector(here.dq), VectorXd::Zero(std::ssize(here.dv))};
    for (int i = 0; i < std::ssize(weights); ++i) {
      const double s = (i + 1) * step;
      slopes.rate += weights[i] / step * (vector(values(place, t, s).dv) - vector(values(place, t, -s).dv));
    }
    return slopes;
  }
  VectorXd momentum(const Place& place, double t) { return vector(values(place, t, 0).dv); }

 private:
  static VectorXd vector(const std::vector<double>& x) {
    return Eigen::Map<const VectorXd>(x.data(), std::ssize(x));
  }
  PointValues values(const Place& place, double t, double s) {
    const VectorXd q = place.q + s * (place.v + s / 2 * place.a), v = place.v + s * place.a;
    const auto span = [](const VectorXd& x) { return std::span(x.data(), std::size_t(x.size())); };
    return evaluate_at(lagrangian_, span(q), span(v), t + s, Order::gradient, scratch_);
  }

  const Lagrangian& lagrangian_;
  Scratch scratch_;
};

/// The largest changes of each coordinate, beside what they are changes of.
struct Changes {
  VectorXd most, size;
  explicit Changes(int n) : most(VectorXd::Zero(n)), size(VectorXd::Zero(n)) {}

  void add(const VectorXd& before, const VectorXd& after, const VectorXd& scale) {
    size = size.cwiseMax(scale.cwiseAbs());
    for (Eigen::Index a = 0; a < most.size(); ++a) {
      const double change = std::abs(after[a] - before[a]);
      most[a] = std::isfinite(change) ? std::max(most[a], change) : INFINITY;
    }
  }
  /// The coordinate with the largest relative change beyond what may be roundoff.
  std::optional<ClosingChange> worst(bool momentum, double relative, double absolute) const {
    std::optional<ClosingChange> found;
    const double least = change_roundoff * size.maxCoeff() + absolute;
    for (int a = 0; a < most.size(); ++a) {
      if (!(most[a] > relative * size[a] + least)) continue;
      if (!found || most[a] / size[a] > found->change / found->size) found = {a, momentum, most[a], size[a]};
    }
    return found;
  }
};

std::string change_text(const Problem& problem, const ClosingChange& change) {
  const std::string name = problem.names.empty() ? fmt::format("coordinate {}", change.coordinate + 1)
                                                 : problem.names[change.coordinate];
  const std::string of = change.momentum ? "the momentum ∂L/∂q' of " + name : "the force on " + name;
  return fmt::format("{} changes by {:.3g}, where it is up to {:.3g}", of, change.change, change.size);
}

Problem without_map(Problem problem) {
  const int n = problem.coordinates();
  problem.boundary = {};
  problem.boundary.coordinates = n;
  for (int a = 0; a < n; ++a) {
    const int row = problem.boundary.add_row(0);
    problem.boundary.add(row, n + a, 1);
    problem.boundary.add(row, a, -1);
  }
  problem.ends = solve_relation(problem.boundary);
  return problem;
}

std::string mend_text(const Problem& problem) {
  const Structure& s = problem.lagrangian->structure();
  if (const std::optional<double> period = recurrence_time(problem))
    // With a map it repeats after a multiple only if the map is the same as so many.
    return fmt::format("; L repeats after {:.15g}: give that duration{}", *period,
                       sparse_closing(problem).identity ? ", or a multiple of it" : "");
  if (!sparse_closing(problem).identity)
    if (const std::optional<double> period = recurrence_time(without_map(problem)))
      return fmt::format(
          "; L repeats after {:.15g}, but the map changes it: leave the map out and give that "
          "duration, or a map that leaves L unchanged",
          *period);
  if (!s.harmonic)
    return "; t stands in L outside of sin, cos and tan, and no period is known: give both ends instead of "
           "'periodic', or an L that repeats";
  return "; no common period of the sin, cos and tan of t in L is known: give both ends instead of "
         "'periodic', or an L that repeats";
}

}  // namespace

std::optional<ClosingChange> closing_change(const Problem& problem, double duration) {
  const Structure& s = problem.lagrangian->structure();
  const SparseClosing closing = sparse_closing(problem);
  if (s.autonomous && closing.identity) return std::nullopt;
  const int n = problem.coordinates();
  const double span = problem.duration.value, step = span / steps_a_duration;
  const double fastest = s.frequencies.empty() ? 0 : s.frequencies.back();
  // Roundoff of t acts on sin(ω t) as ω t ε does.
  const double relative = unchanged + 8 * machine_epsilon * fastest * (duration + span);
  NearbyPoints nearby(problem);
  PathSlopes slopes(*problem.lagrangian);
  Changes forces(n), momenta(n);
  Place place;
  const auto image = [&] {
    return Place{closing.r * place.q + closing.c, closing.r * place.v, closing.r * place.a};
  };
  const Eigen::SparseMatrix<double> back = closing.r.transpose();
  const int first_points = s.harmonic ? points_within : points_for_pulses;
  const int points = first_points + (s.autonomous ? 0 : points_beyond);
  for (int k = 0, tries = 0; k < points && tries < tries_a_point * points; ++tries) {
    if (!place.draw(nearby, span)) continue;
    const bool within = k < first_points;
    const double t = duration * (within ? (k + 0.5) / first_points : 1 + 1.37 * (k - first_points));
    const Slopes before = slopes.at(place, t, step);
    const VectorXd start = slopes.momentum(place, 0);
    if (!before.residual().allFinite() || !start.allFinite()) continue;
    const Slopes after = slopes.at(image(), t + duration, step);
    forces.add(before.residual(), back * after.residual(),
               before.force.cwiseAbs().cwiseMax(before.rate.cwiseAbs()));
    momenta.add(start, back * slopes.momentum(image(), duration), start);
    ++k;
  }
  // A difference quotient has the roundoff of momenta over its step.
  const double quotient = change_roundoff * momenta.size.maxCoeff() / step;
  if (const auto worst = forces.worst(false, relative, quotient)) return worst;
  return momenta.worst(true, relative, 0);
}

std::optional<double> recurrence_time(const Problem& problem) {
  constexpr double whole = 1e-9;
  const Structure& s = problem.lagrangian->structure();
  if (!s.harmonic) return std::nullopt;
  std::vector<double> frequencies = s.frequencies;
  std::erase(frequencies, 0.0);
  if (frequencies.empty()) return std::nullopt;
  for (int m = 1; m <= most_periods; ++m) {
    const bool common = std::all_of(frequencies.begin(), frequencies.end(), [&](double frequency) {
      const double turns = m * (frequency / frequencies.front());
      return std::abs(turns - std::round(turns)) <= whole * turns;
    });
    if (!common) continue;
    const double period = 2 * std::numbers::pi * m / frequencies.front();
    for (int parts = most_parts; parts >= 1; --parts)
      if (!closing_change(problem, period / parts)) return period / parts;
    return std::nullopt;
  }
  return std::nullopt;
}

void check_recurrence(const Problem& problem) {
  if (!problem.periodic) return;
  const double duration = problem.duration.value;
  const auto change = closing_change(problem, duration);
  if (!change) return;
  const std::string amounts = change_text(problem, *change);
  if (problem.lagrangian->structure().autonomous)
    throw RecurrenceError("the map changes the Lagrangian: " + amounts, "");
  const std::string map = sparse_closing(problem).identity ? "" : ", up to the map,";
  const std::string until = fmt::format("L does not repeat{} after the duration {}: ", map, duration);
  if (change->momentum)
    throw RecurrenceError(until + "motions do, but " + amounts + ", so that velocities would jump",
                          "; leave the total time derivative out of L that makes it");
  throw RecurrenceError(until + amounts, mend_text(problem));
}

}  // namespace extremal
