#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "machine/clock.hpp"
#include "machine/largest.hpp"
#include "problem/point_text.hpp"
#include "solve/accept/acceptance.hpp"
#include "solve/accept/branches_apart.hpp"
#include "solve/accept/conjugate_ends.hpp"
#include "solve/accept/limits.hpp"
#include "system/open_ends.hpp"

/// \file Why a solve found nothing.

namespace extremal {

using namespace limits::failure;

namespace {

using Point = std::span<const double>;

bool singular_mass(const Problem& problem, Point q) {
  const int n = problem.coordinates();
  const std::vector<double> v(n, 0.1);
  Scratch scratch;
  // Where L depends on t it may be singular at t = 0 alone, as at a radius of zero.
  const double t = problem.lagrangian->structure().autonomous ? 0 : 0.5 * problem.duration.value;
  const PointValues at = evaluate_at(*problem.lagrangian, q, v, t, Order::hessian, scratch);
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

/// The end, where every coordinate is fixed; else nothing.
Point fixed_end(const Problem& problem, bool end) {
  const std::size_t n = problem.coordinates(), first = end ? n : 0;
  return problem.ends.fixes(end) ? Point(problem.ends.offset).subspan(first, n) : Point();
}

/// A point at a thousandth of the coordinates from another, or of one where all are zero, to one side.
std::vector<double> beside(Point q, double side) {
  const double size = largest(q);
  std::vector<double> result(q.begin(), q.end());
  for (double& x : result) x += side * 1e-3 * (size > 0 ? size : 1);
  return result;
}

/// An end where L is not finite at rest nor at speeds along each axis, first one beside which it is not
/// either; or an end that no motion reaches in time: where L is finite at rest, but it or its momenta are not
/// at the mean velocity between the ends.
std::string unreachable(const Problem& problem) {
  const std::size_t n = problem.coordinates();
  const double duration = problem.duration.value;
  Scratch scratch;
  const auto finite = [&](Point q, const std::vector<double>& v, double t) {
    const PointValues at = evaluate_at(*problem.lagrangian, q, v, t, Order::gradient, scratch);
    return std::isfinite(at.value) && std::ranges::all_of(at.dv, [](double p) { return std::isfinite(p); });
  };
  const auto finite_at_some_velocity = [&](Point q, double t) {
    std::vector<double> v(n, 0);
    if (finite(q, v, t)) return true;
    for (std::size_t a = 0; a < n; ++a) {
      for (const double speed : {-1e3, -1.0, -1e-3, 1e-3, 1.0, 1e3}) {
        v[a] = speed;
        if (finite(q, v, t)) return true;
      }
      v[a] = 0;
    }
    return false;
  };
  const auto* const open = dynamic_cast<const OpenEnds*>(problem.lagrangian.get());
  const auto finite_beside = [&](Point q, double t) {
    return finite_at_some_velocity(beside(q, 1), t) || finite_at_some_velocity(beside(q, -1), t);
  };
  for (const bool within : {false, true})
    for (const bool end : {false, true}) {
      const Point q = fixed_end(problem, end);
      if (q.empty() || (open && (end ? open->open_end() : open->open_start()))) continue;
      const double time = end ? duration : 0;
      if (finite_at_some_velocity(q, time) || finite_beside(q, time) != within) continue;
      // Either the point is singular, and points beside it are not, or the time is.
      const double little = 1e-9 * duration;
      if (!within && finite_at_some_velocity(q, end ? duration - little : little))
        return fmt::format("L is not finite at t = {:.6g}; write t {} {:.1g} for t in {}", time,
                           end ? '-' : '+', little, problem.paired ? "L and the forces" : "L");
      return fmt::format("L is not finite {} the {}, {}; move this end", within ? "at" : "about",
                         end ? "end" : "start", point_text(problem.names, q));
    }
  const Point start = fixed_end(problem, false), end = fixed_end(problem, true);
  if (start.empty() || end.empty() || problem.duration.free || open) return {};
  std::vector<double> mean(n);
  for (std::size_t a = 0; a < n; ++a) mean[a] = (end[a] - start[a]) / duration;
  if (finite(start, mean, 0) || finite(end, mean, duration)) return {};
  return fmt::format(
      "L is not finite at the mean velocity between the ends, {:.6g}: they may be out of reach in this "
      "duration; try a longer one, or ends nearer to each other",
      std::sqrt(std::inner_product(mean.begin(), mean.end(), mean.begin(), 0.0)));
}

/// Why a solve may have failed before it began; empty if nothing is found.
std::string irregularity(const Problem& problem) {
  const int n = problem.coordinates();
  if (n > most_coordinates || problem.phase) return {};
  if (std::string reason = unreachable(problem); !reason.empty()) return reason;
  const std::vector<double> middle = middle_of_guess(problem);
  const std::pair<const char*, Point> points[] = {
      {"start", fixed_end(problem, false)}, {"end", fixed_end(problem, true)}, {"guess", middle}};
  for (const auto& [where, q] : points) {
    if (q.empty() || !singular_mass(problem, q)) continue;
    std::vector<double> beside(q.begin(), q.end());
    for (int a = 0; a < n; ++a) beside[a] += aside * (1 + std::abs(q[a])) * (a + 1) / n;
    if (singular_mass(problem, beside))
      return "the Lagrangian is not regular: its mass matrix ∂²L/∂q'∂q' is singular";
    return fmt::format(
        "the mass matrix ∂²L/∂q'∂q' is singular at {}, a point of the {}, though not beside it: momenta do "
        "not determine velocities there; avoid it, or take other coordinates",
        point_text(problem.names, q), where);
  }
  return {};
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
  } else if (const std::string apart = branches_apart(problem); !apart.empty()) {
    solution.status = Status::no_solution_near;
    solution.message = apart;
  } else if (last.status != Status::conjugate_ends && last.path.elements() > 0 &&
             !options.deadline.passed() &&
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
  solution.seconds_analyse = seconds_since(start);
  return solution;
}

}  // namespace extremal
