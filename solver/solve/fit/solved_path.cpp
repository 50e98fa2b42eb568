#include "solve/fit/solved_path.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "solve/fit/limits.hpp"
#include "solve/fit/members.hpp"

namespace extremal {

using namespace limits::fit;

SolvedPath::SolvedPath(const FitTask& task, const SolveOptions& options)
    : task_(task), options_(options), observer_(task.data, task.coordinates) {}

void SolvedPath::take(const Solution& solution, std::span<const double> values) {
  std::vector<double> residuals(task_.data.count());
  members_.clear();
  if (!put(solution, values, residuals)) path_ = {};
  values_.resize(task_.unknowns.size() + members_.size());
}

/// The extremal for these values, from the one there is, moved to the member that is asked for.
bool SolvedPath::solve(std::span<const double> values, Solution& solution) {
  Path from = path_;
  const std::size_t unknowns = task_.unknowns.size();
  for (std::size_t j = 0; j < members_.size(); ++j)
    from.add(members_[j].nodes, members_[j].inner, values[unknowns + j] - values_[unknowns + j]);
  from.load_ends();
  std::optional<Problem> problem = task_.problem(
      values.first(unknowns), guess_of_elements(first_copy(trajectory_of(from), task_.coordinates)),
      solution_.duration());
  if (!problem || options_.deadline.passed()) return false;
  problem_ = std::move(problem);
  solution = task_.solve(*problem_, options_);
  iterations_ += solution.iterations;
  return solution.converged();
}

/// What is computed along an extremal. False where it is not finite.
bool SolvedPath::put(const Solution& solution, std::span<const double> values, std::span<double> residuals) {
  const std::span<const double> known = values.first(task_.unknowns.size());
  if (!problem_) {
    problem_ = task_.problem(known, guess_of_elements(solution.trajectory), solution.duration());
    if (!problem_) return false;
  }
  scheme_ = std::make_unique<SchemeTables>(scheme_of(solution.trajectory, options_), exact_points);
  tables_.bind(*scheme_, *problem_->lagrangian);
  put_trajectory(solution.trajectory, tables_, path_);
  if (&solution != &solution_) solution_ = solution;
  values_.assign(values.begin(), values.end());
  members_ = moves_of_closed_path(*problem_, path_, tables_);
  return observer_.residuals(path_, task_.formulas(known), residuals);
}

bool SolvedPath::evaluate(std::span<const double> values, std::span<double> residuals,
                          std::span<double> jacobian) {
  if (!std::ranges::equal(values, values_)) {
    Solution solution;
    if (!solve(values, solution) || !put(solution, values, residuals)) return false;
  } else if (!put(solution_, std::vector<double>(values.begin(), values.end()), residuals)) {
    return false;
  }
  if (jacobian.empty()) return true;
  const std::size_t count = values.size(), unknowns = task_.unknowns.size();
  if (unknowns + members_.size() != count) return false;
  for (std::size_t j = 0; j < unknowns; ++j)
    if (!differentiate(j, count, jacobian)) return false;
  for (std::size_t j = unknowns; j < count; ++j)
    observer_.derivatives(path_, tables_, task_.formulas(values.first(unknowns)), members_[j - unknowns], {},
                          jacobian.data() + j, static_cast<std::ptrdiff_t>(count));
  return true;
}

bool SolvedPath::evaluate_by_values(std::span<double> residuals, std::span<double> jacobian) {
  return evaluate(std::vector<double>(values_), residuals, jacobian);
}

/// A column, by central differences of fourth order; the path stays. False where the extremals beside it are
/// of another family.
bool SolvedPath::differentiate(std::size_t unknown, std::size_t count, std::span<double> jacobian) {
  constexpr std::array<double, 4> places = {-2, -1, 1, 2};
  const Solution kept = solution_;
  const std::vector<double> here = values_;
  const double step = difference * task_.unknowns[unknown].size;
  Eigen::MatrixXd beside(task_.data.count(), static_cast<Eigen::Index>(places.size()));
  bool found = true;
  for (std::size_t k = 0; k < places.size() && found; ++k) {
    std::vector<double> moved = here;
    moved[unknown] += places[k] * step;
    Solution solution;
    const std::span<double> residuals(beside.col(static_cast<Eigen::Index>(k)).data(), task_.data.count());
    found = solve(moved, solution) && put(solution, moved, residuals);
    solution_ = kept;
  }
  std::vector<double> residuals(task_.data.count());
  if (!put(kept, here, residuals) || !found) return false;
  const Eigen::VectorXd one = (beside.col(2) - beside.col(1)) / 2, two = (beside.col(3) - beside.col(0)) / 4,
                        slopes = (4 * one - two) / (3 * step);
  for (Eigen::Index i = 0; i < slopes.size(); ++i) jacobian[i * count + unknown] = slopes[i];
  return (one - two).norm() <= quotients_apart * one.norm() + options_.tolerance * task_.data.size();
}

}  // namespace extremal
