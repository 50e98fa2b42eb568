#include "problem/copies.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "problem/extension.hpp"

namespace extremal {

namespace {

/// Numbers of start and end, n each, for both copies; those of the second times `sign`.
std::vector<double> for_both(const std::vector<double>& ends, double sign) {
  std::vector<double> both;
  const auto n = static_cast<std::ptrdiff_t>(ends.size() / 2);
  for (const auto begin : {ends.begin(), ends.begin() + n}) {
    both.insert(both.end(), begin, begin + n);
    std::transform(begin, begin + n, std::back_inserter(both), [&](double x) { return sign * x; });
  }
  return both;
}

BoundaryRelation relation_of_both(const BoundaryRelation& one) {
  BoundaryRelation both{.coordinates = 2 * one.coordinates,
                        .rows = 2 * one.rows,
                        .matrix = {},
                        .value = one.value,
                        .momenta = for_both(one.momenta, -1),
                        .costs = {}};
  const int n = one.coordinates;
  for (const int copy : {0, 1})
    for (const Triplet& e : one.matrix)
      both.matrix.push_back({copy * one.rows + e.row, (e.column < n ? 0 : n) + copy * n + e.column, e.value});
  both.value.insert(both.value.end(), one.value.begin(), one.value.end());
  return both;
}

/// Where coordinate a of a copy, or constant a − n, is among the coordinates of both and the constants.
std::size_t of_both(std::size_t a, std::size_t n, std::size_t copy) { return a < n ? copy * n + a : n + a; }

/// Σ_copies part · g of that copy and the constants.
EndCondition of_copies(const EndCondition& one, std::size_t n, const std::array<double, 2>& parts) {
  return {[one, n, parts](std::span<const double> start, std::span<const double> end,
                          std::span<double> gradient, std::span<double> hessian) {
    const std::size_t both = start.size(), all = both - n;
    std::vector<double> q(all), last(all), slopes(2 * all), bends(hessian.empty() ? 0 : 4 * all * all);
    double value = 0;
    std::ranges::fill(gradient, 0.0);
    std::ranges::fill(hessian, 0.0);
    for (const std::size_t copy : {0, 1}) {
      if (parts[copy] == 0) continue;
      const auto place = [&](std::size_t e) { return (e < all ? 0 : both) + of_both(e % all, n, copy); };
      for (std::size_t a = 0; a < all; ++a) {
        q[a] = start[place(a)];
        last[a] = end[place(a)];
      }
      value += parts[copy] * one.function(q, last, slopes, bends);
      for (std::size_t e = 0; e < 2 * all; ++e) {
        gradient[place(e)] += parts[copy] * slopes[e];
        for (std::size_t f = 0; !hessian.empty() && f < 2 * all; ++f)
          hessian[place(e) * 2 * both + place(f)] += parts[copy] * bends[e * 2 * all + f];
      }
    }
    return value;
  }};
}

/// Each condition and each waypoint holds for both copies, with multipliers that differ in sign; what
/// replaces equations of constants, of their mean.
std::shared_ptr<const Extension> extension_of_both(const Extension& one, int n) {
  auto both = std::make_shared<Extension>();
  both->lagrangian = one.copies;
  both->names = one.names;
  both->guess = one.guess;
  for (const std::array<double, 2>& parts : {std::array{1.0, 0.0}, std::array{0.0, 1.0}})
    for (const EndCondition& r : one.conditions) both->conditions.push_back(of_copies(r, n, parts));
  for (const EndCondition& e : one.end_terms) both->end_terms.push_back(of_copies(e, n, {1, -1}));
  for (const EndCondition& w : one.where) both->where.push_back(of_copies(w, n, {0.5, 0.5}));
  both->waypoints = one.waypoints;
  for (WaypointCondition& waypoint : both->waypoints) {
    const auto fixed = waypoint.fixed;
    for (const auto& [a, value] : fixed) waypoint.fixed.emplace_back(n + a, value);
  }
  both->at = one.copies_at;
  return both;
}

/// Of the mean of both copies.
EndFunction of_mean(const EndFunction& one) {
  return [one](std::span<const double> start, std::span<const double> end, std::span<double> gradient) {
    const std::size_t n = start.size() / 2;
    std::vector<double> q(n), last(n), slopes(2 * n);
    for (std::size_t a = 0; a < n; ++a) {
      q[a] = 0.5 * (start[a] + start[n + a]);
      last[a] = 0.5 * (end[a] + end[n + a]);
    }
    const double value = one(q, last, slopes);
    for (std::size_t a = 0; a < n; ++a) {
      gradient[a] = gradient[n + a] = 0.5 * slopes[a];
      gradient[2 * n + a] = gradient[3 * n + a] = 0.5 * slopes[n + a];
    }
    return value;
  };
}

/// What a generator does to the first copy, G by rows and then c; nothing where it mixes the copies.
Eigen::VectorXd on_first(const Generator& generator) {
  const std::size_t m = generator.shift.size(), n = m / 2;
  Eigen::VectorXd part(static_cast<Eigen::Index>(n * n + n));
  double mixed = 0, size = 0;
  for (std::size_t a = 0; a < n; ++a) {
    part[static_cast<Eigen::Index>(n * n + a)] = generator.shift[a];
    for (std::size_t b = 0; b < n; ++b) {
      part[static_cast<Eigen::Index>(a * n + b)] = generator.matrix[a * m + b];
      mixed = std::max(
          {mixed, std::abs(generator.matrix[a * m + n + b]), std::abs(generator.matrix[(n + a) * m + b])});
    }
  }
  for (const double x : generator.matrix) size = std::max(size, std::abs(x));
  constexpr double apart = 1e-6;
  return mixed <= apart * size ? part : Eigen::VectorXd::Zero(part.size());
}

Generator on_copy(const Eigen::VectorXd& part, std::size_t n, std::size_t copy) {
  const std::size_t m = 2 * n, first = copy * n;
  Generator result{std::vector<double>(m * m, 0), std::vector<double>(m, 0)};
  for (std::size_t a = 0; a < n; ++a) {
    result.shift[first + a] = part[static_cast<Eigen::Index>(n * n + a)];
    for (std::size_t b = 0; b < n; ++b)
      result.matrix[(first + a) * m + first + b] = part[static_cast<Eigen::Index>(a * n + b)];
  }
  return result;
}

}  // namespace

Guess guess_of_both(const Guess& one, std::size_t n) {
  Guess both = one;
  both.q.clear();
  for (auto q = one.q.begin(); q != one.q.end(); q += static_cast<std::ptrdiff_t>(n))
    for (int copy = 0; copy < 2; ++copy) both.q.insert(both.q.end(), q, q + static_cast<std::ptrdiff_t>(n));
  return both;
}

Problem pair_of(const Problem& problem) {
  Problem pair;
  pair.lagrangian = problem.copies;
  pair.paired = true;
  pair.names = problem.names;
  pair.names.insert(pair.names.end(), problem.names.begin(), problem.names.end());
  pair.boundary = relation_of_both(problem.boundary);
  pair.ends = solve_relation(pair.boundary);
  pair.periodic = problem.periodic;
  pair.duration = problem.duration;
  if (problem.duration.where) pair.duration.where = of_mean(problem.duration.where);
  if (problem.extension)
    pair.extension = extension_of_both(*problem.extension, problem.coordinates());
  else if (problem.duration.free && !problem.duration.where)
    pair.duration.energy = 0;
  if (problem.initial) {
    const auto& [q, p, paired] = *problem.initial;
    InitialData both{q, p, true};
    both.q.insert(both.q.end(), q.begin(), q.end());
    std::transform(p.begin(), p.end(), std::back_inserter(both.p), std::negate<>());
    pair.initial = std::move(both);
  }
  pair.guess = guess_of_both(problem.guess, problem.coordinates());
  return pair;
}

std::vector<Generator> symmetries_of_copies(const std::vector<Generator>& found) {
  constexpr double dependent = 1e-6;
  std::vector<Generator> result;
  std::vector<Eigen::VectorXd> known;  // orthonormal
  for (const Generator& generator : found) {
    Eigen::VectorXd part = on_first(generator);
    const double before = part.norm();
    for (const Eigen::VectorXd& other : known) part -= other.dot(part) * other;
    if (!(part.norm() > dependent * before)) continue;
    known.push_back(part.normalized());
    for (const std::size_t copy : {0, 1})
      result.push_back(on_copy(known.back(), generator.shift.size() / 2, copy));
  }
  return result;
}

}  // namespace extremal
