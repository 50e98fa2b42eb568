#include "solve/fit/fitted_path.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense.hpp"
#include "solve/fit/limits.hpp"
#include "solve/fit/members.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/ends.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

namespace extremal {

using namespace limits::fit;

FittedPath::FittedPath(const FitTask& task, const SolveOptions& options)
    : task_(task), options_(options), observer_(task.data, task.coordinates) {}

/// The problem at these values, and tables bound to it; the path stays.
bool FittedPath::bind(std::span<const double> values) {
  std::optional<FittedProblem> next = task_.at(values.first(task_.unknowns.size()));
  if (!next) return false;
  at_ = std::move(next);
  tables_.bind(*scheme_, *at_->problem.lagrangian);
  tables_.end_at(at_->problem.lagrangian->kinks());
  return true;
}

/// With forces both copies move alike.
void FittedPath::take(const Solution& solution, std::span<const double> values) {
  scheme_ = std::make_unique<SchemeTables>(scheme_of(solution.trajectory, options_), exact_points);
  steps_.clear();
  converged_ = false;
  ends_.clear();
  members_.clear();
  held_ = {};
  path_ = {};
  if (!bind(values)) return;
  put_trajectory(solution.trajectory, tables_, path_);
  values_.assign(values.begin(), values.end());
}

std::vector<double> FittedPath::coordinates() const {
  std::vector<double> result = values_;
  for (const std::size_t j : ends_) result[j] = path_.node(node_)[task_.unknowns[j].last];
  return result;
}

std::vector<double> FittedPath::values() const {
  std::vector<double> result = values_at(values_);
  result.resize(task_.unknowns.size());
  return result;
}

bool FittedPath::converge_on_elements() {
  if (!scheme_ || path_.elements() == 0) return false;
  node_ = path_.elements();
  meet_ends(at_->problem, path_);
  if (!converge_here(values_)) return false;
  converged_ = true;
  choose_node();
  if (!find_members(0)) return false;
  values_.resize(task_.unknowns.size() + members_.size());
  asked_ = coordinates();
  return true;
}

/// The moves to other extremals for the same values: those of symmetries, and where elements are condensed
/// all null directions of the second variation beside these. At least so many, if there are.
bool FittedPath::find_members(std::size_t at_least) {
  members_ = moves_of_closed_path(at_->problem, path_, tables_);
  held_ = {};
  for (Step& member : members_)
    if (!close(member)) return false;
  if (at_->problem.paired || !ends_.empty()) return true;
  const double null = null_eigenvalue_of_branch(1, options_.tolerance, path_);
  while (members_.size() < 2 * static_cast<std::size_t>(path_.coordinates())) {
    std::optional<SoftStep> soft = softest_step(newton_, path_, tables_, members_);
    if (!soft || (std::abs(soft->eigenvalue) > null && members_.size() >= at_least)) break;
    held_.add(direction_of(soft->step.nodes, path_));
    members_.push_back(std::move(soft->step));
  }
  return true;
}

/// Whether no force holds the path along directions that are null: farther away, or for other values, the
/// family may end.
bool FittedPath::within_family() { return held_.count == 0 || newton_.residual_at(path_) <= largest_force; }

/// What closes a duration may ask for another orbit of the family where time begins later.
bool FittedPath::close(Step& member) {
  const ClosingEquation* const closing = newton_.closing(path_);
  if (!closing || closing->row.empty()) return true;
  const std::size_t n = path_.coordinates(), last = member.nodes.size() - n;
  double moved = 0;
  for (std::size_t a = 0; a < n; ++a)
    moved += closing->row[a] * member.nodes[a] + closing->row[n + a] * member.nodes[last + a];
  ProblemChange back;
  back.parameters.resize(at_->problem.lagrangian->structure().parameters);
  back.ends.resize(2 * n);
  back.where = [moved](auto, auto) { return moved; };
  if (!response_.factor(newton_, at_->problem, path_, tables_, {&back, 1})) return false;
  Step step;
  response_.to(back, step);
  add(member, step, 1);
  return true;
}

/// ∂q/∂q(T) of the ends that are unknowns, at a node.
Eigen::MatrixXd FittedPath::fields_at(int node) const {
  const auto count = static_cast<Eigen::Index>(ends_.size());
  const std::size_t first = static_cast<std::size_t>(node) * path_.coordinates();
  Eigen::MatrixXd fields(count, count);
  for (Eigen::Index a = 0; a < count; ++a)
    for (Eigen::Index b = 0; b < count; ++b)
      fields(a, b) = fields_[b].nodes[first + task_.unknowns[ends_[a]].last];
  return fields;
}

/// The first node behind which the fields, normalised at the first node, fall.
void FittedPath::choose_node() {
  node_ = path_.elements();
  ends_.clear();
  for (std::size_t j = 0; j < task_.unknowns.size(); ++j)
    if (task_.unknowns[j].last >= 0) ends_.push_back(j);
  if (ends_.empty() || path_.elements() < 3) return;
  std::vector<ProblemChange> changes;
  for (const std::size_t j : ends_) changes.push_back(at_->changes[j]);
  if (!response_.factor(newton_, at_->problem, path_, tables_, changes)) return;
  fields_.resize(ends_.size());
  for (std::size_t k = 0; k < ends_.size(); ++k) response_.to(changes[k], fields_[k]);
  const Eigen::MatrixXd unit = inverse(fields_at(1));
  double largest = 0;
  int best = path_.elements();
  for (int node = 1; node <= path_.elements(); ++node) {
    const double size = singular_values(fields_at(node) * unit).minCoeff();
    if (!std::isfinite(size)) return;
    if (size > largest) {
      largest = size;
      best = node;
    } else if (size < fallen * largest) {
      node_ = best;
      return;
    }
  }
}

/// To the path that derivatives predict.
bool FittedPath::move_to(std::span<const double> coordinates) {
  if (!steps_.empty()) {
    path_ = base_;
    double duration = path_.duration();
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      const double by = coordinates[j] - base_values_[j];
      path_.add(steps_[j].nodes, steps_[j].inner, by);
      duration += by * steps_[j].duration;
    }
    if (!(duration > 0)) return false;
    path_.set_duration(duration);
    path_.load_ends();
  }
  return true;
}

/// The values for these coordinates, where q(T) is that of the path.
std::vector<double> FittedPath::values_at(std::span<const double> coordinates) const {
  std::vector<double> result(coordinates.begin(), coordinates.end());
  if (node_ < path_.elements())
    for (const std::size_t j : ends_) result[j] = path_.node(path_.elements())[task_.unknowns[j].last];
  return result;
}

/// Fields move the end along a tangent of the constraints. So the end is put on these, until it moves no
/// more.
bool FittedPath::correct_end(std::span<const double> coordinates) {
  const double size = scales(path_, tables_).q;
  for (int k = 0; k < most_newton_steps; ++k) {
    const std::vector<double> before = values_at(coordinates);
    if (!correct(coordinates)) return false;
    if (!at_->curved) return true;
    const std::vector<double> after = values_at(coordinates);
    double moved = 0;
    for (const std::size_t j : ends_) moved = std::max(moved, std::abs(after[j] - before[j]));
    if (moved <= roundoff_of_step * size) return true;
    if (!bind(after)) return false;
    newton_.reset(at_->problem, tables_, path_.elements());
    meet_ends(at_->problem, path_);
  }
  return false;
}

bool FittedPath::converge_here(std::span<const double> coordinates) {
  if (!at_->problem.duration.free) path_.set_duration(at_->problem.duration.value);
  newton_.reset(at_->problem, tables_, path_.elements());
  newton_.hold(held_);
  newton_.forget();
  if (node_ < path_.elements()) {
    if (at_->curved) meet_ends(at_->problem, path_);
    return correct_end(coordinates);
  }
  meet_ends(at_->problem, path_);
  const NewtonReport report = converge(newton_, path_, tables_, {.steps = most_newton_steps},
                                       [&] { return !options_.deadline.passed(); });
  iterations_ += report.steps;
  // A free duration is known to fewer digits than the path then.
  if (report.reached && at_->problem.duration.free) correct(coordinates);
  return report.reached;
}

/// Newton's method without damping. Where q is given at a node and not at T, the combination of fields that
/// keeps q there comes to a step between fixed ends.
bool FittedPath::correct(std::span<const double> coordinates) {
  const bool held = node_ < path_.elements();
  std::vector<ProblemChange> changes;
  for (const std::size_t j : ends_)
    if (held) changes.push_back(at_->changes[j]);
  const double size = scales(path_, tables_).q;
  double before = INFINITY;
  Step step;
  for (int k = 0; k < most_newton_steps && !options_.deadline.passed(); ++k, ++iterations_) {
    if (!response_.factor(newton_, at_->problem, path_, tables_, changes)) return false;
    newton_.model().solve(newton_.action(), newton_.closing(path_), step);
    if (held && !hold_node(coordinates, changes, step)) return false;
    double norm = std::abs(step.duration) / path_.duration();
    for (const double x : step.nodes) norm = std::max(norm, std::abs(x) / size);
    const double duration = path_.duration() + step.duration;
    if (!std::isfinite(norm) || !(duration > 0)) return false;
    path_.add(step.nodes, step.inner, 1);
    if (at_->problem.duration.free) path_.set_duration(duration);
    path_.load_ends();
    if (norm < least_step || (norm < roundoff_of_step && norm > 0.3 * before)) return true;
    before = norm;
  }
  return false;
}

/// Adds to a step the fields that bring q at the node to its coordinates.
bool FittedPath::hold_node(std::span<const double> coordinates, std::span<const ProblemChange> changes,
                           Step& step) {
  const std::size_t first = static_cast<std::size_t>(node_) * path_.coordinates();
  Eigen::VectorXd missing(static_cast<Eigen::Index>(ends_.size()));
  for (std::size_t j = 0; j < ends_.size(); ++j) {
    response_.to(changes[j], fields_[j]);
    const int a = task_.unknowns[ends_[j]].last;
    missing[static_cast<Eigen::Index>(j)] =
        coordinates[ends_[j]] - (path_.node(node_)[a] + path_.rest(node_)[a]) - step.nodes[first + a];
  }
  const Eigen::VectorXd parts = solved(fields_at(node_), missing);
  if (!parts.allFinite()) return false;
  for (std::size_t j = 0; j < ends_.size(); ++j) add(step, fields_[j], parts[static_cast<Eigen::Index>(j)]);
  return true;
}

bool FittedPath::evaluate(std::span<const double> coordinates, std::span<double> residuals,
                          std::span<double> jacobian) {
  if (!converged_ || !std::ranges::equal(coordinates, asked_)) {
    converged_ = false;
    if (!move_to(coordinates) || !bind(values_at(coordinates)) || !converge_here(coordinates) ||
        !within_family()) {
      if (!steps_.empty()) path_ = base_;
      return false;
    }
    values_.assign(coordinates.begin(), coordinates.end());
    asked_ = values_;
    converged_ = true;
  }
  if (!observer_.residuals(path_, at_->formulas, residuals)) return false;
  return jacobian.empty() || differentiate(false, jacobian);
}

bool FittedPath::evaluate_by_values(std::span<double> residuals, std::span<double> jacobian) {
  return converged_ && observer_.residuals(path_, at_->formulas, residuals) && differentiate(true, jacobian);
}

/// From derivatives with q(T) given to those with q at the node given.
void FittedPath::combine_fields() {
  const std::size_t n = path_.coordinates(), held = node_ * n;
  for (std::size_t k = 0; k < ends_.size(); ++k) fields_[k] = steps_[ends_[k]];
  const Eigen::MatrixXd by_node = inverse(fields_at(node_));
  for (std::size_t j = 0; j < steps_.size(); ++j) {
    const auto end = std::ranges::find(ends_, j);
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(ends_.size()));
    if (end != ends_.end())
      moved[end - ends_.begin()] = 1;
    else
      for (std::size_t k = 0; k < ends_.size(); ++k)
        moved[static_cast<Eigen::Index>(k)] = -steps_[j].nodes[held + task_.unknowns[ends_[k]].last];
    const Eigen::VectorXd parts = by_node * moved;
    if (end != ends_.end()) add(steps_[j], fields_[end - ends_.begin()], -1);
    for (std::size_t k = 0; k < ends_.size(); ++k)
      add(steps_[j], fields_[k], parts[static_cast<Eigen::Index>(k)]);
  }
}

bool FittedPath::differentiate(bool by_values, std::span<double> jacobian) {
  const std::size_t unknowns = task_.unknowns.size(), count = values_.size();
  steps_.clear();
  if (!find_members(count - unknowns) || unknowns + members_.size() != count) return false;
  newton_.hold(held_);
  if (!response_.factor(newton_, at_->problem, path_, tables_, at_->changes)) return false;
  steps_.resize(unknowns);
  for (std::size_t j = 0; j < unknowns; ++j) response_.to(at_->changes[j], steps_[j]);
  if (!by_values && node_ < path_.elements()) combine_fields();
  steps_.insert(steps_.end(), members_.begin(), members_.end());
  const ProblemChange nothing;
  for (std::size_t j = 0; j < count; ++j)
    observer_.derivatives(path_, tables_, at_->formulas, steps_[j], j < unknowns ? at_->changes[j] : nothing,
                          jacobian.data() + j, static_cast<std::ptrdiff_t>(count));
  base_ = path_;
  base_values_ = coordinates();
  if (by_values) steps_.clear();
  return std::ranges::all_of(jacobian, [](double x) { return std::isfinite(x); });
}

}  // namespace extremal
