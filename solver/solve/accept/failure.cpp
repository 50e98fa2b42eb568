#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>

#include "solve/accept/acceptance.hpp"
#include "solve/accept/conjugate_ends.hpp"
#include "solve/accept/limits.hpp"

/// \file Why a solve found nothing.

namespace extremal {

using namespace limits::failure;

namespace {

using Clock = std::chrono::steady_clock;

bool singular_mass(const Problem& problem, const std::vector<double>& q) {
  const int n = problem.coordinates();
  const std::vector<double> v(n, 0.1);
  Scratch scratch;
  const PointValues at = evaluate_at(*problem.lagrangian, q, v, 0, Order::hessian, scratch);
  const Eigen::Map<const Eigen::MatrixXd> mass(at.vv.data(), n, n);
  return mass.allFinite() && mass.fullPivLu().rank() < n;
}

/// The guess in the middle; the default guess, where no coordinate is free, at that of the ends.
std::vector<double> middle_of_guess(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  std::vector<double> q(n, 0.1);
  if (problem.guess.given())
    problem.guess.at(0.5, q);
  else
    for (std::size_t a = 0; a < n; ++a)
      if (problem.ends.fixed[a] && problem.ends.fixed[n + a])
        q[a] = 0.5 * (problem.ends.offset[a] + problem.ends.offset[n + a]);
  return q;
}

/// Why a solve may have failed before it began; empty if nothing is found.
std::string irregularity(const Problem& problem) {
  const int n = problem.coordinates();
  if (n > most_coordinates) return {};
  std::vector<double> q = middle_of_guess(problem);
  if (!singular_mass(problem, q)) return {};
  std::string place;
  for (int a = 0; a < n; ++a)
    place += fmt::format("{}{} = {:.6g}", a ? ", " : "", problem.names.empty() ? "q" : problem.names[a], q[a]);
  for (int a = 0; a < n; ++a) q[a] += aside * (1 + std::abs(q[a])) * (a + 1) / n;
  if (singular_mass(problem, q))
    return "the Lagrangian is not regular: its mass matrix ∂²L/∂q'∂q' is singular";
  return fmt::format(
      "the mass matrix ∂²L/∂q'∂q' is singular on the guess, at {}, though not beside it; try a guess that avoids "
      "such points",
      place);
}

}  // namespace

Solution explain_failure(const Problem& problem, const SolveOptions& options, const Outcome& last,
                         Workspace& w) {
  const auto start = Clock::now();
  Solution solution;
  solution.status = last.status;
  solution.message = last.message;
  if (const std::string reason = irregularity(problem); !reason.empty()) {
    solution.message = reason;
  } else if (last.status != Status::conjugate_ends &&
             failed_at_conjugate_ends(problem, trajectory_of(last.path), w.variation)) {
    solution.status = Status::conjugate_ends;
    solution.message =
        "the ends seem to be conjugate, with no extremal or a family of them; move an end or the duration (" +
        last.message + ")";
  }
  solution.strategy = last.strategy;
  if (options.method != Method::newton)
    solution.strategy += fmt::format(", led by {}", description(options.method));
  solution.iterations = last.iterations;
  w.iteration.forget();
  solution.seconds_analyse = std::chrono::duration<double>(Clock::now() - start).count();
  return solution;
}

}  // namespace extremal
