#include "problem/infinite_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "linear/dense.hpp"
#include "machine/largest.hpp"
#include "problem/limits.hpp"
#include "problem/point_text.hpp"

namespace extremal {

using namespace limits::infinite_ends;

namespace {

using About = InfiniteEndError::About;

/// Of the points that are named.
constexpr int digits = 10;

std::vector<double> values_of(const EndMap& ends, bool at_end) {
  const auto n = static_cast<std::ptrdiff_t>(ends.fixed.size() / 2), first = at_end ? n : 0;
  return {ends.offset.begin() + first, ends.offset.begin() + first + n};
}

/// A time so late that the linear motion about q has decayed by then: where L depends on t, what L is like as
/// t → ∞ shows there.
double late(const Lagrangian& lagrangian, std::span<const double> q) {
  if (lagrangian.structure().autonomous) return 0;
  double t = 1;
  for (int k = 0; k < most_doublings; ++k, t *= 2) {
    const RestPoint rest = rest_point(lagrangian, q, t);
    if (rest.hyperbolic && t * rest.slowest_in >= decays) break;
  }
  return t;
}

/// One end of a relation as it is examined.
struct End {
  bool fixed = false, at_rest = false;
  std::vector<double> q;
  RestPoint rest;
};

/// Whether the rates are those beside the point too, and no roundoff: where ∂²L/∂q∂q vanishes like a power of
/// the distance, rounded coordinates leave something of it.
bool has_rates(const Lagrangian& lagrangian, const RestPoint& rest, double t) {
  const double size = largest(rest.q);
  std::vector<double> q = rest.q;
  for (const double side : {beside, -2 * beside}) {
    for (double& x : q) x += side * size;
    if (!(slowest_rate(lagrangian, q, t) <= 2 * rest.slowest)) return false;
  }
  return true;
}

End examine(const Lagrangian& lagrangian, const EndMap& ends, bool at_end) {
  End end{.fixed = ends.fixes(at_end), .at_rest = false, .q = values_of(ends, at_end), .rest = {}};
  if (!end.fixed) return end;
  const About about = at_end ? About::end : About::start;
  const bool autonomous = lagrangian.structure().autonomous;
  if (!autonomous && !at_end) return end;
  try {
    const double t = late(lagrangian, end.q), size = largest(end.q);
    end.rest = rest_point(lagrangian, end.q, t);
    end.at_rest = end.rest.distance <= at_equilibrium * (size > 0 ? size : 1);
    if (end.at_rest && end.rest.hyperbolic) end.rest.hyperbolic = has_rates(lagrangian, end.rest, t);
    // Where L approaches its limit slowly, the equilibrium does too.
    if (!autonomous && !end.at_rest)
      end.at_rest = rest_point(lagrangian, end.q, 2 * t).distance <= approaching * end.rest.distance;
  } catch (const std::invalid_argument& e) {
    throw InfiniteEndError(
        about, fmt::format("the {} cannot be at infinity: {}", at_end ? "end" : "start", e.what()));
  }
  return end;
}

void check_hyperbolic(const End& end, bool at_end, const std::vector<std::string>& names) {
  const About about = at_end ? About::end : About::start;
  if (!end.rest.hyperbolic)
    throw InfiniteEndError(
        about,
        fmt::format("the equilibrium {} at the {} is not approached exponentially in all directions: "
                    "motions about it go as exp(λt) with λ = {}, and some λ are imaginary or zero; ends "
                    "at infinity need real parts. Give a finite duration",
                    point_text(names, end.q, digits), at_end ? "end" : "start", exponents_text(end.rest)));
  if ((at_end ? end.rest.stable : end.rest.unstable).size() == 0)
    throw InfiniteEndError(
        about, fmt::format("motions that tend to the equilibrium {} do not have one momentum for each "
                           "displacement, so the {} cannot be at infinity; give a finite duration",
                           point_text(names, end.q, digits), at_end ? "end" : "start"));
}

[[noreturn]] void refuse_finite(const End& start, const End& end, bool autonomous,
                                const std::vector<std::string>& names) {
  for (const auto& [at, text, about] :
       {std::tuple(&end, "end", About::end), {&start, "start", About::start}}) {
    if (!at->fixed || (!autonomous && at == &start)) continue;
    // An end that is left out is the one that may be at infinity.
    const bool other_open = at == &end ? !start.fixed && autonomous : !end.fixed;
    const std::string nearest =
        std::isfinite(at->rest.distance)
            ? fmt::format("the nearest one is {}; give that{}", point_text(names, at->rest.q, digits),
                          !other_open  ? ""
                          : at == &end ? " at the start"
                                       : " at the end")
            : std::string("no equilibrium is near; give one at an end");
    throw InfiniteEndError(
        about, fmt::format("duration = \"infinite\" needs an end at an equilibrium of L; at the {}, {}, the "
                           "force ∂L/∂q at rest is {:.3g}, and {}, or a finite duration",
                           text, point_text(names, at->q, digits), at->rest.force, nearest));
  }
  if (!autonomous && start.fixed)
    throw InfiniteEndError(
        About::start,
        "L depends on t: only the end can be at infinity, with every coordinate fixed at an "
        "equilibrium that L approaches as t → ∞");
  throw InfiniteEndError(About::both,
                         "duration = \"infinite\" needs an end at which every coordinate is fixed, at an "
                         "equilibrium of L; fix all coordinates of the start or of the end");
}

/// An autonomous L conserves the energy −L(equilibrium).
bool equal_energies(const End& start, const End& end) {
  double way = 0;
  for (std::size_t a = 0; a < start.q.size(); ++a) way = std::max(way, std::abs(end.q[a] - start.q[a]));
  const double a = start.rest.value, b = end.rest.value,
               size = std::max({std::abs(a), std::abs(b),
                                way * way * std::max(start.rest.stiffness, end.rest.stiffness)});
  return std::abs(a - b) <= same_energy * size;
}

void check_energies(const End& start, const End& end, const std::vector<std::string>& names) {
  if (equal_energies(start, end)) return;
  throw InfiniteEndError(
      About::both,
      fmt::format("the energy of rest is {:.10g} at {} and {:.10g} at {}, and L conserves it: no "
                  "extremal leads from one to the other; choose equilibria of equal energy, or a "
                  "finite duration",
                  -start.rest.value, point_text(names, start.q, digits), -end.rest.value,
                  point_text(names, end.q, digits)));
}

/// Relation without the conditions on an end.
void release(BoundaryRelation& relation, bool at_end) {
  const int n = relation.coordinates, first = at_end ? n : 0;
  std::vector<char> dropped(relation.rows, 0);
  for (const Triplet& entry : relation.matrix)
    if (entry.column >= first && entry.column < first + n) dropped[entry.row] = 1;
  BoundaryRelation kept = relation;
  kept.rows = 0;
  kept.matrix.clear();
  kept.value.clear();
  std::vector<int> number(relation.rows, -1);
  for (int row = 0; row < relation.rows; ++row)
    if (!dropped[row]) number[row] = kept.add_row(relation.value[row]);
  for (const Triplet& entry : relation.matrix)
    if (!dropped[entry.row]) kept.add(number[entry.row], entry.column, entry.value);
  relation = std::move(kept);
}

/// The share of the way from the start to the end at time s after the middle: e^{as} before and 1 − e^{−bs}
/// behind it but for factors that make it smooth.
double share_of_way(double s, double a, double b) {
  return s < 0 ? b / (a + b) * std::exp(a * s) : 1 - a / (a + b) * std::exp(-b * s);
}

/// Moves the free coordinates of the finite end, beside rest at the other, to where the linear motions that
/// tend to rest have the momenta that are asked for: p = ∂L/∂q' + S (q − q*), with S that of these motions.
void meet_momenta(const Problem& problem, const RestPoint& rest, bool at_end, std::vector<double>& q) {
  const std::size_t n = q.size(), first = at_end ? n : 0;
  const Eigen::MatrixXd& slope = at_end ? rest.unstable : rest.stable;
  std::vector<int> free;
  for (std::size_t a = 0; a < n; ++a)
    if (!problem.ends.fixed[first + a]) free.push_back(static_cast<int>(a));
  if (free.empty() || slope.size() == 0) return;
  Eigen::VectorXd away(n), missing(n);
  for (std::size_t a = 0; a < n; ++a) {
    const double asked = problem.boundary.momenta.empty() ? 0 : problem.boundary.momenta[first + a];
    away[a] = problem.ends.fixed[first + a] ? q[a] - rest.q[a] : 0;
    missing[a] = asked - rest.momentum[a];
  }
  missing -= slope * away;
  const Eigen::VectorXd free_away = least_norm(slope(free, free), missing(free));
  if (!free_away.allFinite()) return;
  for (std::size_t k = 0; k < free.size(); ++k) q[free[k]] = rest.q[free[k]] + free_away[k];
}

/// The default guess would be the equilibrium q.
[[noreturn]] void refuse_rest(const Problem& problem, const InfiniteEnds& infinite,
                              const std::vector<double>& q) {
  const std::string_view open = infinite.both() ? "" : infinite.start.empty() ? "start" : "end";
  const std::string level = q.front() == 0 ? "" : fmt::format("{:.10g} + ", q.front());
  throw InfiniteEndError(
      About::both,
      fmt::format("the default guess is the equilibrium itself, which is an extremal at rest; give {}a guess "
                  "that leaves it, such as {} = \"{}1/cosh(t - T/2)\" in [guess]",
                  open.empty() ? "" : fmt::format("the {} a place away from it, or ", open),
                  problem.names.empty() ? "x" : problem.names.front(), level));
}

Guess default_guess(const Problem& problem, const InfiniteEnds& infinite) {
  const std::size_t n = problem.coordinates();
  const bool from = !infinite.start.empty(), to = !infinite.end.empty();
  const double T = problem.duration.value;
  std::vector<double> start = values_of(problem.ends, false), end = values_of(problem.ends, true);
  double a = 0, b = 0;
  if (from) {
    const RestPoint rest = rest_point_of(*problem.lagrangian, infinite, false, T);
    a = rest.slowest_out;
    if (!to) meet_momenta(problem, rest, true, end);
  }
  if (to) {
    const RestPoint rest = rest_point_of(*problem.lagrangian, infinite, true, T);
    b = rest.slowest_in;
    if (!from) meet_momenta(problem, rest, false, start);
  }
  double way = 0, size = 0;
  for (std::size_t k = 0; k < n; ++k) {
    way = std::max(way, std::abs(end[k] - start[k]));
    size = std::max({size, std::abs(start[k]), std::abs(end[k])});
  }
  if (way <= same_point * size &&
      ((from && to) || std::ranges::any_of(problem.ends.fixed, [](char f) { return !f; })))
    refuse_rest(problem, infinite, start);
  const double middle = from && to ? T * b / (a + b) : 0;
  Guess guess;
  for (int k = 0; k <= samples; ++k) {
    const double tau = static_cast<double>(k) / samples, t = tau * T;
    const double share = from && to ? share_of_way(t - middle, a, b)
                         : to       ? 1 - std::exp(-b * t)
                                    : std::exp(a * (t - T));
    guess.tau.push_back(tau);
    for (std::size_t i = 0; i < n; ++i) guess.q.push_back(start[i] + share * (end[i] - start[i]));
  }
  return guess;
}

}  // namespace

InfiniteEnds infinite_ends(const Lagrangian& lagrangian, const EndMap& ends,
                           const std::vector<std::string>& names) {
  const bool autonomous = lagrangian.structure().autonomous;
  End start = examine(lagrangian, ends, false), end = examine(lagrangian, ends, true);
  if (!start.at_rest && !end.at_rest) refuse_finite(start, end, autonomous, names);
  // An equilibrium that is not approached exponentially may still be passed, at a finite time: with another
  // energy than that of rest.
  const auto passed = [&](const End& here, const End& there) {
    return !here.rest.hyperbolic && there.at_rest && there.rest.hyperbolic &&
           !(autonomous && equal_energies(start, end));
  };
  if (start.at_rest && !passed(start, end)) check_hyperbolic(start, false, names);
  if (end.at_rest && !passed(end, start)) check_hyperbolic(end, true, names);
  start.at_rest = start.at_rest && start.rest.hyperbolic;
  end.at_rest = end.at_rest && end.rest.hyperbolic;
  InfiniteEnds found;
  if (start.at_rest) found.start = autonomous ? start.rest.q : start.q;
  if (end.at_rest) found.end = autonomous ? end.rest.q : end.q;
  if (found.both()) check_energies(start, end, names);
  return found;
}

RestPoint rest_point_of(const Lagrangian& lagrangian, const InfiniteEnds& infinite, bool at_end, double t) {
  return rest_point(lagrangian, at_end ? infinite.end : infinite.start, t);
}

double approach_time(const Lagrangian& lagrangian, const InfiniteEnds& infinite) {
  double time = 0;
  for (const bool at_end : {false, true}) {
    const std::vector<double>& q = at_end ? infinite.end : infinite.start;
    if (!q.empty()) time += decays / rest_point(lagrangian, q, late(lagrangian, q)).decay(at_end);
  }
  return time;
}

void make_infinite(Problem& problem, InfiniteEnds infinite) {
  if (!problem.guess.given()) problem.guess = default_guess(problem, infinite);
  if (!infinite.start.empty()) release(problem.boundary, false);
  if (!infinite.end.empty()) release(problem.boundary, true);
  problem.ends = solve_relation(problem.boundary);
  problem.infinite = std::move(infinite);
}

}  // namespace extremal
