#include "problem/copies.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

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

Guess guess_of_both(const Guess& one, std::size_t n) {
  Guess both = one;
  both.q.clear();
  for (auto q = one.q.begin(); q != one.q.end(); q += static_cast<std::ptrdiff_t>(n))
    for (int copy = 0; copy < 2; ++copy) both.q.insert(both.q.end(), q, q + static_cast<std::ptrdiff_t>(n));
  return both;
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
  if (problem.duration.free && !problem.duration.where) pair.duration.energy = 0;
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
