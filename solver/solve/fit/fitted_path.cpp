#include "solve/fit/fitted_path.hpp"

#include <algorithm>
#include <cmath>

#include "solve/fit/limits.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/ends.hpp"

namespace extremal {

using namespace limits::fit;

FittedPath::FittedPath(const FitTask& task, const SolveOptions& options)
    : task_(task), options_(options), observer_(task.data, task.coordinates) {}

/// The problem at these values, and tables bound to it; the path stays.
bool FittedPath::bind(std::span<const double> values) {
  std::optional<FittedProblem> next = task_.at(values);
  if (!next) return false;
  at_ = std::move(next);
  tables_.bind(*scheme_, *at_->problem.lagrangian);
  tables_.end_at(at_->problem.lagrangian->kinks());
  return true;
}

/// Elements of the scheme that was asked for, or of the degree of the trajectory, whose velocities are right to
/// the tolerance. With forces both copies move alike.
void FittedPath::take(const Solution& solution, std::span<const double> values) {
  const Trajectory& trajectory = solution.trajectory;
  const int degree = options_.scheme ? options_.scheme->degree : trajectory.degree;
  scheme_ = options_.scheme ? std::make_unique<SchemeTables>(*options_.scheme, exact_points)
                            : std::make_unique<SchemeTables>(lobatto(degree));
  steps_.clear();
  converged_ = false;
  path_ = {};
  if (!bind(values)) return;
  const std::size_t n = trajectory.coordinates, width = at_->problem.coordinates();
  std::vector<double> mesh;
  for (const double t : trajectory.times) mesh.push_back(t / trajectory.duration());
  mesh.back() = 1;
  path_.reset(tables_, mesh, trajectory.duration());
  std::vector<double> nodes((degree + 1) * width), q(n), v(n);
  const std::vector<double>& places = lobatto_barycentric(degree).nodes;
  for (int k = 0; k < path_.elements(); ++k) {
    for (int j = 0; j <= degree; ++j) {
      trajectory.in_element(k, places[j], q, v);
      for (std::size_t a = 0; a < width; ++a) nodes[j * width + a] = q[a % n];
    }
    path_.set_element(k, nodes.data());
  }
  path_.load_ends();
  values_.assign(values.begin(), values.end());
}

/// To the path that derivatives predict for the values, with its ends on the boundary relation.
bool FittedPath::move_to(std::span<const double> values) {
  if (!steps_.empty()) {
    path_ = base_;
    double duration = path_.duration();
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      const double by = values[j] - base_values_[j];
      path_.add(steps_[j].nodes, steps_[j].inner, by);
      duration += by * steps_[j].duration;
    }
    if (!(duration > 0)) return false;
    path_.set_duration(duration);
    path_.load_ends();
  }
  if (!at_->problem.duration.free) path_.set_duration(at_->problem.duration.value);
  meet_ends(at_->problem, path_);
  return true;
}

bool FittedPath::converge_here() {
  newton_.reset(at_->problem, tables_, path_.elements());
  newton_.forget();
  const NewtonReport report =
      converge(newton_, path_, tables_, {.steps = most_newton_steps}, [&] { return !options_.deadline.passed(); });
  iterations_ += report.steps;
  return report.reached;
}

bool FittedPath::evaluate(std::span<const double> values, std::span<double> residuals,
                          std::span<double> jacobian) {
  if (!scheme_ || path_.elements() == 0) return false;
  if (!converged_ || !std::ranges::equal(values, values_)) {
    converged_ = false;
    if (!bind(values) || !move_to(values) || !converge_here()) {
      if (!steps_.empty()) path_ = base_;
      return false;
    }
    values_.assign(values.begin(), values.end());
    converged_ = true;
  }
  if (!observer_.residuals(path_, at_->formulas, residuals)) return false;
  return jacobian.empty() || differentiate(jacobian);
}

bool FittedPath::differentiate(std::span<double> jacobian) {
  const std::size_t count = task_.unknowns.size();
  steps_.resize(count);
  if (!response_.factor(newton_, at_->problem, path_, tables_, at_->changes)) {
    steps_.clear();
    return false;
  }
  for (std::size_t j = 0; j < count; ++j) {
    response_.to(at_->changes[j], steps_[j]);
    observer_.derivatives(path_, tables_, at_->formulas, steps_[j], at_->changes[j], jacobian.data() + j,
                          static_cast<std::ptrdiff_t>(count));
  }
  base_ = path_;
  base_values_ = values_;
  return std::ranges::all_of(jacobian, [](double x) { return std::isfinite(x); });
}

}  // namespace extremal
