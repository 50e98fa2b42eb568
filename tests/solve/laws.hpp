#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "action/rule.hpp"
#include "action/systems.hpp"
#include "problem/problem.hpp"
#include "solve/solve.hpp"

/// \file What the laws of the method share: problems in a line, norms of differences, slopes.

namespace extremal::laws {

using Values = std::vector<double>;

/// q(0) = start, q(T) = end.
inline Problem fixed_ends(std::shared_ptr<const Lagrangian> lagrangian, const Values& start,
                          const Values& end, double duration) {
  Problem problem;
  problem.lagrangian = std::move(lagrangian);
  problem.boundary.coordinates = static_cast<int>(start.size());
  for (std::size_t a = 0; a < start.size(); ++a) {
    problem.names.push_back("q[" + std::to_string(a + 1) + "]");
    problem.boundary.fix(static_cast<int>(a), false, start[a]);
    problem.boundary.fix(static_cast<int>(a), true, end[a]);
  }
  problem.duration.value = duration;
  return make_problem(std::move(problem));
}

using Relation = std::function<void(BoundaryRelation&)>;

inline Problem with_ends(std::shared_ptr<const Lagrangian> lagrangian, double duration,
                         const Relation& relation) {
  Problem problem;
  const int n = lagrangian->structure().coordinates;
  problem.lagrangian = std::move(lagrangian);
  for (int a = 0; a < n; ++a) problem.names.push_back("q[" + std::to_string(a + 1) + "]");
  problem.boundary.coordinates = n;
  relation(problem.boundary);
  problem.duration.value = duration;
  return make_problem(std::move(problem));
}

/// q(T) = q(0) + shift, every coordinate alike.
inline Problem periodic(std::shared_ptr<const Lagrangian> lagrangian, double T, double shift = 0) {
  const int n = lagrangian->structure().coordinates;
  Problem problem = with_ends(std::move(lagrangian), T, [&](BoundaryRelation& b) {
    for (int a = 0; a < n; ++a) {
      const int row = b.add_row(shift);
      b.add(row, a, -1);
      b.add(row, n + a, 1);
    }
  });
  problem.periodic = true;
  return make_problem(std::move(problem));
}

inline Problem guessed(Problem problem, const std::function<Values(double)>& q_of_tau) {
  for (int i = 0; i <= 100; ++i) {
    problem.guess.tau.push_back(i / 100.0);
    for (double q : q_of_tau(i / 100.0)) problem.guess.q.push_back(q);
  }
  return make_problem(std::move(problem));
}

inline SolveOptions pinned(const Scheme& scheme, int elements) {
  SolveOptions options;
  options.scheme = scheme;
  options.elements = elements;
  return options;
}
inline SolveOptions within(double tolerance) {
  SolveOptions options;
  options.tolerance = tolerance;
  return options;
}

/// The options, held to their word: throws when more steps are taken than they allow.
inline SolveOptions counted(SolveOptions options) {
  options.progress = [limit = options.max_iterations, count = 0](const Iteration&) mutable {
    if (++count > limit) throw std::runtime_error(fmt::format("more than {} Newton steps", limit));
  };
  return options;
}

/// Solves. Throws, and so fails the test, where that does not converge.
inline Solution solve(Solver& solver, const Problem& problem, const SolveOptions& options) {
  Solution solution = solver.solve(problem, counted(options));
  if (!solution.converged())
    throw std::runtime_error(fmt::format("{}: {} ({}, {} elements, T = {})", name(solution.status),
                                         solution.message, options.scheme ? options.scheme->name : "adaptive",
                                         options.elements, problem.duration.value));
  return solution;
}

inline Solution solve(const Problem& problem, const SolveOptions& options) {
  Solver solver;
  return solve(solver, problem, options);
}

/// The same problem, guessed by its own solution: on a mesh so coarse that a straight line leads elsewhere.
inline Problem guided(const Problem& problem) {
  const Trajectory path = solve(problem, within(1e-10)).trajectory;
  const int n = problem.coordinates(), steps = 200;
  Problem result = problem;
  result.guess.tau.clear();
  result.guess.q.assign(static_cast<std::size_t>(steps + 1) * n, 0);
  Values v(n);
  for (int i = 0; i <= steps; ++i) {
    const double tau = static_cast<double>(i) / steps;
    result.guess.tau.push_back(tau);
    path.at(tau * path.duration(), {result.guess.q.data() + static_cast<std::size_t>(i) * n, v.size()}, v);
  }
  result.duration.value = path.duration();
  return make_problem(std::move(result));
}

/// Every named scheme, and members of the two families.
inline std::vector<Scheme> schemes_and_families() {
  std::vector<Scheme> list;
  for (const char* name : {"rectangle", "rectangle-right", "midpoint", "trapezoid", "simpson", "linear",
                           "quadratic", "lobatto(1)", "lobatto(2)", "lobatto(3)", "lobatto(4)", "gauss(1)",
                           "gauss(2)", "gauss(3)", "gauss(4)"})
    list.push_back(scheme(name));
  return list;
}

inline bool one_sided(const Scheme& scheme) {
  return scheme.quadrature == Quadrature::left || scheme.quadrature == Quadrature::right;
}

/// q and q' of a trajectory.
struct State {
  Values q, v;
};
inline State at(const Trajectory& trajectory, double t) {
  State state{Values(trajectory.coordinates), Values(trajectory.coordinates)};
  trajectory.at(std::min(t, trajectory.duration()), state.q, state.v);
  return state;
}

/// q at mesh node k.
inline Values node(const Trajectory& trajectory, int k) {
  const std::size_t n = trajectory.coordinates, s = trajectory.degree;
  const bool last = k == trajectory.elements();
  const double* q = trajectory.nodes.data() + (last ? (k - 1) * (s + 1) + s : k * (s + 1)) * n;
  return Values(q, q + n);
}

inline double largest_difference(std::span<const double> a, std::span<const double> b) {
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, std::abs(a[i] - b[i]));
  return result;
}
inline double largest(std::span<const double> a) {
  double result = 0;
  for (double x : a) result = std::max(result, std::abs(x));
  return result;
}

/// Largest distance at the nodes between elements of `path`.
inline double node_distance(const Trajectory& path, const Trajectory& truth) {
  double result = 0;
  for (int k = 0; k <= path.elements(); ++k)
    result = std::max(result, largest_difference(node(path, k), at(truth, path.times[k]).q));
  return result;
}

/// Largest distance from q(t) over 100 times.
inline double distance(const Trajectory& path, const std::function<Values(double)>& q) {
  double result = 0;
  for (int i = 0; i <= 100; ++i) {
    const double t = path.duration() * i / 100;
    result = std::max(result, largest_difference(at(path, t).q, q(t)));
  }
  return result;
}

/// (∫ |q − truth|² dt)^½, by seven Gauss points an element.
inline double l2_distance(const Trajectory& path, const Trajectory& truth) {
  const Rule rule = gauss_rule(7);
  double sum = 0;
  for (int k = 0; k < path.elements(); ++k)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double h = path.times[k + 1] - path.times[k], t = path.times[k] + h * rule.nodes[i];
      const Values q = at(path, t).q, r = at(truth, t).q;
      for (std::size_t a = 0; a < q.size(); ++a) sum += h * rule.weights[i] * (q[a] - r[a]) * (q[a] - r[a]);
    }
  return std::sqrt(sum);
}

/// Largest distance over `points` equal steps.
inline double sup_distance(const Trajectory& path, const Trajectory& truth, int points = 1000) {
  double result = 0;
  for (int i = 0; i <= points; ++i) {
    const double t = path.duration() * i / points;
    result = std::max(result, largest_difference(at(path, t).q, at(truth, t).q));
  }
  return result;
}

/// Errors against h, and their order as a least-squares slope.
struct Refinement {
  Values h, error;

  void add(double step, double size) {
    h.push_back(step);
    error.push_back(size);
  }
  /// Of log error over log h, over the errors above `plateau`. NaN with fewer than four.
  double slope(double plateau) const {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < h.size(); ++i) {
      if (!(error[i] > plateau)) continue;
      const double a = std::log(h[i]), b = std::log(error[i]);
      n += 1, x += a, y += b, xx += a * a, xy += a * b;
    }
    return n < 4 ? NAN : (n * xy - x * y) / (n * xx - x * x);
  }
};

/// Numbers of elements, each √2 times the one before.
inline std::vector<int> refinements(int first, int count) {
  std::vector<int> result;
  for (int i = 0; i < count; ++i)
    result.push_back(static_cast<int>(std::lround(first * std::pow(2.0, i / 2.0))));
  return result;
}

/// Fourth-order central difference of f about 0.
template <class F>
double difference(F f, double h) {
  return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}

}  // namespace extremal::laws
