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

/// Why a solve may have failed before it began; empty if nothing is found.
std::string irregularity(const Problem& problem) {
  const int n = problem.coordinates();
  if (n > most_coordinates) return {};
  std::vector<double> q(n, 0.1), v(n, 0.1);
  if (problem.guess.given()) problem.guess.at(0.5, q);
  Scratch scratch;
  const PointValues at = evaluate_at(*problem.lagrangian, q, v, 0, Order::hessian, scratch);
  const Eigen::Map<const Eigen::MatrixXd> mass(at.vv.data(), n, n);
  if (!mass.allFinite() || mass.fullPivLu().rank() == n) return {};
  return "the Lagrangian is not regular: its mass matrix ∂²L/∂q'∂q' is singular";
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
        "the ends seem to be conjugate: there is no extremal or a family of them; move an end or change the "
        "duration (" +
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
