#include "solve/adaptive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/start.hpp"

namespace extremal {

namespace {

constexpr int first_degree = 4;
constexpr int highest_degree = 16;
/// Elements are at most this long in units of 1/ω, ω the local frequency along the guess.
constexpr double longest_element = 2.0;
constexpr int most_elements = 1 << 16;
/// Coarse elements have done their work when the path is known to this, relative to its range.
constexpr double coarse_goal = 3e-3;
/// Steps allowed for one run of damped Newton.
constexpr int coarse_steps = 40;
constexpr int fine_steps = 12;
/// Corrections below this (relative) are roundoff.
constexpr double roundoff = 1e-15;

}  // namespace

AdaptiveSolve::AdaptiveSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem), options_(options), w_(workspace) {}

/// ∫ω dt along the guess, ω² a bound of M⁻¹L_qq, by elements no longer than `longest_element`/ω.
int AdaptiveSolve::first_elements() {
  const Structure& s = problem_.lagrangian->structure();
  const int n = s.coordinates;
  std::vector<double> mass(n, 0);
  for (const Triplet& m : s.mass)
    if (m.row == m.column) mass[m.row] = std::abs(m.value);
  DiscreteAction& action = w_.iteration.action();
  const int points = tables_->shape().points;
  double phase = 0;
  for (int b = 0; b < w_.path.batches(); ++b) {
    const double* rows = action.rows(w_.path, b, Order::hessian);
    const std::size_t stride = static_cast<std::size_t>(points) * lanes;
    const double* hessian = rows + (1 + s.gradient.size()) * stride;
    for (int i = 0; i < points; ++i)
      for (int lane = 0; lane < std::min(lanes, w_.path.elements() - b * lanes); ++lane) {
        double force = 0, inertia = 0;
        for (std::size_t e = 0; e < s.hessian.size(); ++e) {
          const double value = std::abs(hessian[e * stride + i * lanes + lane]);
          if (s.hessian[e].row < n) force = std::max(force, value / std::max(mass[s.hessian[e].row], 1e-300));
          if (s.hessian[e].column >= n && s.hessian[e].row == s.hessian[e].column)
            inertia = std::max(inertia, value);
        }
        if (!s.quadratic) {
          force = 0;
          for (std::size_t e = 0; e < s.hessian.size(); ++e)
            if (s.hessian[e].row < n)
              force = std::max(force, std::abs(hessian[e * stride + i * lanes + lane]));
          force /= std::max(inertia, 1e-300);
        }
        phase += std::sqrt(force) * tables_->scheme().weight[i] * w_.path.h(b)[lane];
      }
  }
  if (!std::isfinite(phase)) return lanes;
  const double wanted = std::min<double>(phase / longest_element, most_elements / 16);
  return lanes * std::max(1, static_cast<int>(std::ceil(wanted / lanes)));
}

/// A uniform mesh and the guess on it, moved aside until the action is finite. False if it never is.
bool AdaptiveSolve::start(int elements, int degree) {
  tables_ = &w_.levels.at(degree);
  std::vector<double> mesh(elements + 1);
  for (int k = 0; k <= elements; ++k) mesh[k] = static_cast<double>(k) / elements;
  w_.iteration.reset(problem_, *tables_, elements);
  for (double bend : {0.0, 0.1, -0.1, 0.3, -0.3, 1.0, -1.0}) {
    w_.path.reset(*tables_, mesh, problem_.duration.value);
    start_path(problem_, ends_, *tables_, bend, w_.path);
    w_.iteration.action().evaluate_plain(w_.path);
    if (w_.iteration.action().finite()) return true;
    if (problem_.guess.given()) break;
  }
  return false;
}

Outcome AdaptiveSolve::run() {
  ends_ = starting_ends(problem_);
  outcome_.strategy = "newton from the guess";
  outcome_.message = "the action is not finite along the guess";
  if (!start(lanes, first_degree)) return outcome_;
  const int elements = first_elements();
  if (elements != w_.path.elements() && !start(elements, first_degree)) return outcome_;

  for (int tries = 0; tries < 3; ++tries) {
    Attempt result = attempt();
    while (result == Attempt::refine && 2 * w_.path.elements() <= most_elements) {
      halve();
      result = attempt();
    }
    if (result == Attempt::converged) break;
    if (result == Attempt::refine) {
      outcome_.message =
          fmt::format("{} elements do not resolve the path; try a larger tolerance", w_.path.elements());
      break;
    }
    if (!start(elements << (tries + 1), first_degree)) break;
  }
  outcome_.tables = tables_;
  return outcome_;
}

void AdaptiveSolve::report_step() {
  ++outcome_.iterations;
  if (options_.progress)
    options_.progress({.elements = w_.path.elements(),
                       .degree = w_.path.degree(),
                       .residual = w_.iteration.action().residual(),
                       .step = w_.iteration.norm(),
                       .damping = w_.iteration.damping()});
}

bool AdaptiveSolve::meets(const Resolution::Error& error, double safety) const {
  return error.q <= safety * options_.tolerance * scales_.q &&
         error.v <= 10 * safety * options_.tolerance * scales_.v;
}

/// The least degree that resolves the path to the tolerance, or one above the highest.
int AdaptiveSolve::needed_degree() const {
  int degree = w_.path.degree();
  while (degree <= highest_degree && !meets(w_.resolution.at(degree), 0.5)) ++degree;
  return degree;
}

void AdaptiveSolve::raise(int degree) {
  const std::vector<double>& matrix = w_.levels.raise(w_.path.degree(), degree);
  tables_ = &w_.levels.at(degree);
  w_.other.interpolate_from(w_.path, *tables_, matrix);
  std::swap(w_.path, w_.other);
  w_.iteration.reset(problem_, *tables_, w_.path.elements());
  w_.iteration.set_scale(scales_.q);
}

void AdaptiveSolve::halve() {
  w_.other.split_from(w_.path, *tables_, w_.levels.halve(w_.path.degree()));
  std::swap(w_.path, w_.other);
  w_.iteration.reset(problem_, *tables_, w_.path.elements());
}

AdaptiveSolve::Attempt AdaptiveSolve::attempt() {
  const auto on_step = [this] { report_step(); };
  const NewtonReport coarse = converge(w_.iteration, w_.path, *tables_, {coarse_goal, coarse_steps}, on_step);
  outcome_.message = coarse.failure;
  if (!coarse.reached) return Attempt::failed;
  for (;;) {
    scales_ = scales(w_.path, *tables_);
    w_.resolution.measure(w_.path, *tables_);
    const int degree = needed_degree();
    if (degree > highest_degree) return Attempt::refine;
    if (degree > w_.path.degree()) raise(degree);
    const NewtonGoal goal{std::max(0.05 * options_.tolerance, roundoff), fine_steps};
    const NewtonReport fine = converge(w_.iteration, w_.path, *tables_, goal, on_step);
    const Attempt result = judge(fine);
    if (result != Attempt::refine || w_.path.degree() == highest_degree) return result;
  }
}

/// What a converged iteration has reached, from the coefficients that its elements leave out.
AdaptiveSolve::Attempt AdaptiveSolve::judge(const NewtonReport& newton) {
  outcome_.message = newton.failure;
  if (!newton.reached) return Attempt::failed;
  scales_ = scales(w_.path, *tables_);
  w_.resolution.measure(w_.path, *tables_);
  const Resolution::Error truncation = w_.resolution.at(w_.path.degree());
  outcome_.tolerance = options_.tolerance * scales_.q;
  outcome_.error = truncation.q + newton.remaining * scales_.q;
  if (newton.remaining > options_.tolerance) {
    outcome_.message =
        fmt::format("roundoff, amplified to {:.1e} of the range, hides the tolerance {:.1e}; loosen it",
                    newton.remaining, options_.tolerance);
    return Attempt::failed;
  }
  if (!meets(truncation, 1)) return Attempt::refine;
  outcome_.status = Status::converged;
  outcome_.message = "converged";
  return Attempt::converged;
}

}  // namespace extremal
