#include "solve/contact/end_equations.hpp"

#include <algorithm>
#include <utility>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "problem/manifold.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// ∂e/∂(q(0), q(T)) of the terms of the action by momenta that unknowns give.
VectorXd term_slopes(const Problem& problem, std::span<const double> constants, const VectorXd& ends) {
  VectorXd sum = VectorXd::Zero(ends.size()), slope = sum;
  const auto size = static_cast<std::size_t>(ends.size());
  for (const EndCondition& term : problem.extension->end_terms) {
    condition_at(term, constants, {ends.data(), size}, {slope.data(), size}, {});
    sum += slope;
  }
  return sum;
}

}  // namespace

double condition_at(const EndCondition& condition, std::span<const double> constants,
                    std::span<const double> ends, std::span<double> gradient, std::span<double> hessian) {
  const std::size_t n = ends.size() / 2, all = n + constants.size();
  if (all == n) return condition.function(ends.first(n), ends.last(n), gradient, hessian);
  std::vector<double> start(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(n)),
      end(ends.begin() + static_cast<std::ptrdiff_t>(n), ends.end());
  start.insert(start.end(), constants.begin(), constants.end());
  end.insert(end.end(), constants.begin(), constants.end());
  std::vector<double> slope(2 * all), second(hessian.empty() ? 0 : 4 * all * all);
  const double value = condition.function(start, end, slope, second);
  const auto place = [&](std::size_t e) { return e < n ? e : all + e - n; };
  for (std::size_t e = 0; e < 2 * n; ++e) {
    gradient[e] = slope[place(e)];
    for (std::size_t f = 0; !hessian.empty() && f < 2 * n; ++f)
      hessian[e * 2 * n + f] = second[place(e) * 2 * all + place(f)];
  }
  return value;
}

bool closed_by_condition(const Problem& problem) {
  return problem.duration.where || first_where(problem) > 0;
}

std::size_t first_where(const Problem& problem) {
  return problem.extension ? problem.extension->where.size() - problem.extension->names.size() : 0;
}

double closing_condition(const Problem& problem, std::span<const double> constants,
                         std::span<const double> ends, std::span<double> gradient) {
  const std::size_t n = ends.size() / 2;
  if (problem.duration.where) return problem.duration.where(ends.first(n), ends.last(n), gradient);
  return condition_at(problem.extension->where.front(), constants, ends, gradient, {});
}

EndEquations::EndEquations(const Problem& problem, std::vector<EndContact> contacts)
    : problem_(problem),
      n_(problem.coordinates()),
      free_(problem.ends.free),
      conditions_(problem.extension ? problem.extension->conditions.size() : 0) {
  for (const EndContact& contact : contacts)
    // The end of a closed path is its start.
    if (!problem.ends.fixes(contact.at_end) && !(problem.periodic && contact.at_end))
      contacts_.push_back(contact);
}

int EndEquations::unknowns() const { return free_ + (free_duration() ? 1 : 0) + multipliers(); }

VectorXd EndEquations::at(std::span<const double> ends, double duration) const {
  VectorXd x = VectorXd::Zero(unknowns());
  for (int f = 0; f < free_; ++f) x[f] = ends[problem_.ends.home[f]];
  if (free_duration()) x[free_] = duration;
  return x;
}

VectorXd EndEquations::ends(const VectorXd& x) const {
  VectorXd ends = Eigen::Map<const VectorXd>(problem_.ends.offset.data(),
                                             static_cast<Index>(problem_.ends.offset.size()));
  for (const Triplet& z : problem_.ends.z) ends[z.row] += z.value * x[z.column];
  return ends;
}

double EndEquations::duration(const VectorXd& x) const {
  return free_duration() ? x[free_] : problem_.duration.value;
}

bool EndEquations::moves(int unknown, bool at_end) const {
  return std::ranges::any_of(problem_.ends.z, [&](const Triplet& z) {
    return z.column == unknown && z.value != 0 && (z.row >= n_) == at_end;
  });
}

double EndEquations::multiplier(const VectorXd& x, std::size_t contact) const {
  return x[unknowns() - multipliers() + static_cast<Index>(conditions_ + contact)];
}

void EndEquations::set_units(double size, double momentum, double time) {
  size_ = size;
  momentum_ = momentum;
  time_ = time;
}

VectorXd EndEquations::scaled(const VectorXd& step) const {
  VectorXd x = step;
  x.head(free_) *= size_;
  if (free_duration()) x[free_] *= time_;
  x.tail(multipliers()) *= momentum_;
  return x;
}

EndEquations::Condition EndEquations::contact(const EndContact& contact, const VectorXd& ends,
                                              double duration, const EndLaws& laws) const {
  const double* q = ends.data() + (contact.at_end ? n_ : 0);
  const Manifold& manifold = contact.holonomic ? *laws.constraints : *laws.inequalities;
  const ConstraintValues values =
      manifold.at({q, static_cast<std::size_t>(n_)}, contact.at_end ? duration : 0);
  Condition condition{values.g[contact.constraint], VectorXd::Zero(2 * n_)};
  condition.slope.segment(contact.at_end ? n_ : 0, n_) = values.slopes.row(contact.constraint).transpose();
  return condition;
}

std::vector<EndEquations::Condition> EndEquations::conditions(const VectorXd& x, const EndLaws& laws) const {
  const VectorXd ends = this->ends(x);
  const auto n = static_cast<std::size_t>(n_);
  std::vector<Condition> found;
  for (std::size_t i = 0; i < conditions_; ++i) {
    Condition condition{0, VectorXd::Zero(2 * n_)};
    condition.value = condition_at(problem_.extension->conditions[i], laws.constants, {ends.data(), 2 * n},
                                   {condition.slope.data(), 2 * n}, {});
    found.push_back(std::move(condition));
  }
  for (const EndContact& each : contacts_) found.push_back(contact(each, ends, duration(x), laws));
  for (Condition& condition : found)
    if (const double length = condition.slope.norm(); length > 0) {
      condition.value /= length;
      condition.slope /= length;
    }
  return found;
}

/// In units of momentum.
double EndEquations::missed(double value, const VectorXd& gradient) const {
  const double length = gradient.norm();
  return value / (length > 0 ? length * size_ : 1) * momentum_;
}

double EndEquations::closing(const VectorXd& ends, const EndState& state, const EndLaws& laws) const {
  if (!closed_by_condition(problem_)) return (state.energy - *problem_.duration.energy) * time_ / size_;
  VectorXd gradient = VectorXd::Zero(ends.size());
  const auto size = static_cast<std::size_t>(ends.size());
  return missed(closing_condition(problem_, laws.constants, {ends.data(), size}, {gradient.data(), size}),
                gradient);
}

VectorXd EndEquations::where_residual(const VectorXd& x, const EndLaws& laws) const {
  const VectorXd ends = this->ends(x);
  const auto size = static_cast<std::size_t>(ends.size());
  const int count = problem_.extension ? problem_.extension->unknowns() : 0;
  VectorXd r(count);
  for (int i = 0; i < count; ++i) {
    VectorXd gradient = VectorXd::Zero(ends.size());
    const EndCondition& where =
        problem_.extension->where[first_where(problem_) + static_cast<std::size_t>(i)];
    r[i] = missed(condition_at(where, laws.constants, {ends.data(), size}, {gradient.data(), size}, {}),
                  gradient);
  }
  return r;
}

VectorXd EndEquations::residual(const VectorXd& x, const EndState& state, const EndLaws& laws) const {
  VectorXd force(2 * n_);
  force << -state.p_start, state.p_end;
  const std::vector<double>& given = problem_.boundary.momenta;
  for (std::size_t e = 0; e < given.size(); ++e)
    force[static_cast<Index>(e)] -= (e >= static_cast<std::size_t>(n_) ? 1 : -1) * given[e];
  if (problem_.extension) force += term_slopes(problem_, laws.constants, ends(x));
  const std::vector<Condition> conditions = this->conditions(x, laws);
  const Index first = unknowns() - multipliers();
  VectorXd r = VectorXd::Zero(unknowns());
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    force += x[first + static_cast<Index>(i)] * conditions[i].slope;
    r[first + static_cast<Index>(i)] = conditions[i].value * momentum_ / size_;
  }
  for (const Triplet& z : problem_.ends.z) r[z.column] += z.value * force[z.row];
  if (free_duration()) r[free_] = closing(ends(x), state, laws);
  return r;
}

EndCurvature EndEquations::curvature(const VectorXd& x, const EndLaws& laws) const {
  const VectorXd ends = this->ends(x);
  const auto n = static_cast<std::size_t>(n_);
  EndCurvature found{MatrixXd::Zero(static_cast<Index>(conditions_), 2 * n_), MatrixXd::Zero(2 * n_, 2 * n_)};
  for (std::size_t i = 0; i < conditions_; ++i) {
    VectorXd slope(2 * n_);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> second(2 * n_, 2 * n_);
    condition_at(problem_.extension->conditions[i], laws.constants, {ends.data(), 2 * n},
                 {slope.data(), 2 * n}, {second.data(), 4 * n * n});
    found.slopes.row(static_cast<Index>(i)) = slope.transpose();
    const double eta = x[unknowns() - multipliers() + static_cast<Index>(i)];
    if (const double length = slope.norm(); length > 0) found.curvature += eta / length * second;
  }
  return found;
}

}  // namespace extremal
