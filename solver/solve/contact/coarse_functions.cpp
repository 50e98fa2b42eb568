#include <algorithm>
#include <cmath>

#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/coarse_action.hpp"
#include "solve/contact/element_hessian.hpp"
#include "solve/contact/limits.hpp"

/// \file The coarse action as a minimum under inequalities: values and derivatives.

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

const std::vector<EndCondition>& conditions_of(const Problem& problem) {
  static const std::vector<EndCondition> none;
  return problem.extension ? problem.extension->conditions : none;
}

/// Of a condition at the ends of a path.
RowMajor second_derivatives(const EndCondition& condition, std::span<const double> constants,
                            const std::vector<double>& ends) {
  std::vector<double> slope(ends.size());
  RowMajor second(ends.size(), ends.size());
  condition_at(condition, constants, ends, slope, {second.data(), ends.size() * ends.size()});
  return second;
}

bool finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

}  // namespace

bool CoarseAction::hessian(std::span<const double> z, double factor, std::span<const double> multipliers,
                           double rate, std::span<double> entries) const {
  std::size_t at = 0;
  const auto put_lower = [&](const MatrixXd& block) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) entries[at++] = block(i, j);
  };
  const std::size_t m = inequalities_.count();
  const std::span<const double> nu = multipliers.subspan(places_.size() + linear_equations(), integrals());
  for (int k = 0; k < elements_; ++k) {
    const ElementHessian element =
        element_hessian(weighted(z, k, Order::hessian, factor, nu), length(k), n_, 0);
    put_lower(element.aa);
    put_lower(element.bb);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) entries[at++] = element.ba(i, j);
  }
  for (std::size_t place = 0; place < places_.size(); place += m)
    put_lower(curvature(*inequalities_.all, z, places_[place].node, multipliers.subspan(place, m)));
  std::size_t row = places_.size() + linear_equations() + integrals();
  for (const EndCondition& condition : conditions_of(problem_)) {
    const RowMajor second = multipliers[row++] * second_derivatives(condition, constants(nu), ends(z));
    put_lower(second.topLeftCorner(n_, n_));
    put_lower(second.bottomRightCorner(n_, n_));
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) entries[at++] = second(n_ + i, j);
  }
  for (const int node : constrained_) {
    const std::size_t c = problem_.manifold->constraints();
    put_lower(curvature(*problem_.manifold, z, node, multipliers.subspan(row, c)));
    row += c;
  }
  const MatrixXd mixed = mixed_with_times(z, factor, nu) / rate;
  for (std::size_t f = 0; f < free_times_.size(); ++f)
    for (const int node : nodes_beside(free_times_[f]))
      for (int a = 0; a < n_; ++a) entries[at++] = mixed(static_cast<Index>(f), node * n_ + a);
  const MatrixXd times = between_times(z, factor, nu) / (rate * rate);
  for (Index f = 0; f < times.rows(); ++f)
    for (Index g = 0; g <= f; ++g) entries[at++] = times(f, g);
  return finite(entries);
}

InequalityMinimum CoarseAction::minimum(std::span<const double> z, double size) const {
  InequalityMinimum minimum;
  const int constraints = problem_.manifold ? problem_.manifold->constraints() : 0;
  minimum.variables = (elements_ + 1) * n_ + static_cast<int>(free_times_.size());
  minimum.inequalities = static_cast<int>(places_.size());
  minimum.equations = linear_equations() + integrals() + static_cast<int>(conditions_of(problem_).size()) +
                      constraints * static_cast<int>(constrained_.size());
  put_places(minimum);
  put_action(minimum, size);
  put_constraints(minimum, size);
  put_units(z, size, minimum);
  return minimum;
}

void CoarseAction::put_places(InequalityMinimum& minimum) const {
  const std::vector<EndCondition>& conditions = conditions_of(problem_);
  const int rows = minimum.inequalities,
            constraints = problem_.manifold ? problem_.manifold->constraints() : 0;
  for (int i = 0; i < rows; ++i)
    for (int a = 0; a < n_; ++a) minimum.slopes.push_back({i, places_[i].node * n_ + a});
  for (const Triplet& b : problem_.boundary.matrix)
    minimum.slopes.push_back({rows + b.row, variable(b.column)});
  int row = rows + problem_.boundary.rows;
  for (const FixedCoordinate& w : waypoints_) minimum.slopes.push_back({row++, w.node * n_ + w.coordinate});
  for (int j = 0; j < integrals(); ++j, ++row)
    for (int a = 0; a < minimum.variables; ++a) minimum.slopes.push_back({row, a});
  for (std::size_t i = 0; i < conditions.size(); ++i, ++row)
    for (int e = 0; e < 2 * n_; ++e) minimum.slopes.push_back({row, variable(e)});
  for (const int node : constrained_)
    for (int c = 0; c < constraints; ++c, ++row)
      for (int a = 0; a < n_; ++a) minimum.slopes.push_back({row, node * n_ + a});
  const auto lower = [&](int node) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) minimum.curvature.push_back({node * n_ + i, node * n_ + j});
  };
  for (int k = 0; k < elements_; ++k) {
    lower(k);
    lower(k + 1);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) minimum.curvature.push_back({(k + 1) * n_ + i, k * n_ + j});
  }
  for (std::size_t place = 0; place < places_.size(); place += inequalities_.count())
    lower(places_[place].node);
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    lower(0);
    lower(elements_);
    for (int a = 0; a < n_; ++a)
      for (int b = 0; b < n_; ++b) minimum.curvature.push_back({elements_ * n_ + a, b});
  }
  for (const int node : constrained_) lower(node);
  const int times = (elements_ + 1) * n_;
  for (std::size_t f = 0; f < free_times_.size(); ++f)
    for (const int node : nodes_beside(free_times_[f]))
      for (int a = 0; a < n_; ++a) minimum.curvature.push_back({times + static_cast<int>(f), node * n_ + a});
  for (int f = times; f < minimum.variables; ++f)
    for (int g = times; g <= f; ++g) minimum.curvature.push_back({f, g});
}

/// Size of the path, of its action by forces, and of constraints by their largest slopes along the path.
void CoarseAction::put_units(std::span<const double> z, double size, InequalityMinimum& minimum) const {
  const double duration = times_.back();
  double force = this->force(z);
  for (const int k : {0, elements_ / 2, elements_ - 1})
    for (const double m : values(z, k, Order::hessian).vv)
      force = std::max(force, std::abs(m) * size / (duration * duration));
  if (!(size > 0) || !std::isfinite(force) || !(force > 0)) return;
  minimum.unit = size;
  minimum.value_unit = force * size * duration / elements_;  // what a node adds
  std::vector<double> slopes(minimum.slopes.size());
  if (!minimum.constraint_slopes(variables(z, size), slopes)) return;
  // Equations that are the same at other nodes have one unit. An inequality counts as a distance at each
  // node: beside a small obstacle its slope may be far below that elsewhere.
  const int inequalities = inequalities_.count(), places = static_cast<int>(places_.size());
  const int constraints = problem_.manifold ? problem_.manifold->constraints() : 0;
  const int ends =
      minimum.inequalities + minimum.equations - constraints * static_cast<int>(constrained_.size());
  const auto kind = [&](int row) {
    if (row < places) return row % inequalities;
    return row < ends ? inequalities + row - places
                      : inequalities + ends - places + (row - ends) % constraints;
  };
  std::vector<double> largest(inequalities + ends - places + constraints), own(places);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const int row = minimum.slopes[i].row;
    double& most = largest[kind(row)];
    most = std::max(most, std::abs(slopes[i]));
    if (row < places) own[row] = std::max(own[row], std::abs(slopes[i]));
  }
  for (int row = 0; row < minimum.inequalities + minimum.equations; ++row) {
    double most = largest[kind(row)];
    if (row < places) most = std::max(own[row], limits::contact::least_slope * most);
    minimum.constraint_units.push_back(most > 0 ? most * size : 1);
  }
}

void CoarseAction::put_action(InequalityMinimum& minimum, double size) const {
  const std::vector<double>& momenta = problem_.boundary.momenta;
  // Linear in the ends.
  const std::vector<EndCondition> terms =
      problem_.extension ? problem_.extension->end_terms : std::vector<EndCondition>{};
  const std::vector<double> none(integrals());
  const double rate = size / times_.back();
  minimum.value = [=, this, &momenta](std::span<const double> x, double& f) {
    const CoarseAction path = at_variables(x, size);
    const std::span<const double> z = x.first(nodes_size());
    f = 0;
    for (int k = 0; k < elements_; ++k) f += path.length(k) * path.values(z, k, Order::value).value;
    for (std::size_t e = 0; e < momenta.size(); ++e)
      f += (e < std::size_t(n_) ? 1 : -1) * momenta[e] * z[variable(static_cast<int>(e))];
    std::vector<double> slope(2 * static_cast<std::size_t>(n_));
    for (const EndCondition& term : terms) f += condition_at(term, constants(none), ends(z), slope, {});
    return path.ordered() && std::isfinite(f);
  };
  minimum.gradient = [=, this, &momenta](std::span<const double> x, std::span<double> f_z) {
    const CoarseAction path = at_variables(x, size);
    const std::span<const double> z = x.first(nodes_size());
    std::ranges::fill(f_z, 0.0);
    for (int k = 0; k < elements_; ++k) {
      const PointValues l = path.values(z, k, Order::gradient);
      for (int i = 0; i < n_; ++i) {
        f_z[k * n_ + i] += 0.5 * path.length(k) * l.dq[i] - l.dv[i];
        f_z[(k + 1) * n_ + i] += 0.5 * path.length(k) * l.dq[i] + l.dv[i];
      }
    }
    for (std::size_t e = 0; e < momenta.size(); ++e)
      f_z[variable(static_cast<int>(e))] += (e < std::size_t(n_) ? 1 : -1) * momenta[e];
    std::vector<double> slope(2 * static_cast<std::size_t>(n_));
    for (const EndCondition& term : terms) {
      condition_at(term, constants(none), ends(z), slope, {});
      for (std::size_t e = 0; e < slope.size(); ++e) f_z[variable(static_cast<int>(e))] += slope[e];
    }
    const Eigen::VectorXd by_times = path.time_slopes(z) / rate;
    std::ranges::copy(by_times, f_z.begin() + static_cast<std::ptrdiff_t>(nodes_size()));
    return path.ordered() && finite(f_z);
  };
  minimum.hessian = [=, this](std::span<const double> x, double factor, std::span<const double> multipliers,
                              std::span<double> entries) {
    const CoarseAction path = at_variables(x, size);
    return path.ordered() && path.hessian(x.first(nodes_size()), factor, multipliers, rate, entries);
  };
}

void CoarseAction::put_constraints(InequalityMinimum& minimum, double size) const {
  const std::vector<Triplet>& relation = problem_.boundary.matrix;
  const std::vector<EndCondition>& conditions = conditions_of(problem_);
  const int rows = minimum.inequalities, m = inequalities_.count();
  const double rate = size / times_.back();
  const std::vector<double> none(integrals());  // of ν conditions are free
  minimum.constraints = [=, this, &relation, &conditions](std::span<const double> x, std::span<double> a) {
    const CoarseAction path = at_variables(x, size);
    const std::span<const double> z = x.first(nodes_size());
    for (int i = 0; i < rows; i += m)
      std::ranges::copy(path.at(*inequalities_.all, z, places_[i].node).g, a.begin() + i);
    for (int r = 0; r < problem_.boundary.rows; ++r) a[rows + r] = -problem_.boundary.value[r];
    for (const Triplet& b : relation) a[rows + b.row] += b.value * z[variable(b.column)];
    std::vector<double> slope(2 * static_cast<std::size_t>(n_));
    auto next = a.begin() + rows + problem_.boundary.rows;
    for (const FixedCoordinate& w : waypoints_) *next++ = z[w.node * n_ + w.coordinate] - w.value;
    const std::vector<double> integrals = path.integral_values(z);
    for (std::size_t j = 0; j < integrals.size(); ++j)
      *next++ = integrals[j] - problem_.extension->integrals[j];
    for (const EndCondition& condition : conditions)
      *next++ = condition_at(condition, constants(none), ends(z), slope, {});
    for (const int node : constrained_)
      next = std::ranges::copy(path.at(*problem_.manifold, z, node).g, next).out;
    return path.ordered() && finite(a);
  };
  minimum.constraint_slopes = [=, this, &relation, &conditions](std::span<const double> x,
                                                                std::span<double> a_z) {
    const CoarseAction path = at_variables(x, size);
    const std::span<const double> z = x.first(nodes_size());
    auto next = a_z.begin();
    const auto put = [&](const Manifold& manifold, int node) {
      const RowMajor slopes = path.at(manifold, z, node).slopes;
      next = std::copy_n(slopes.data(), slopes.size(), next);
    };
    for (int i = 0; i < rows; i += m) put(*inequalities_.all, places_[i].node);
    for (const Triplet& b : relation) *next++ = b.value;
    next = std::fill_n(next, waypoints_.size(), 1.0);
    RowMajor of_integrals(integrals(), static_cast<Index>(x.size()));
    of_integrals << path.integral_slopes(z), path.integral_rates(z) / rate;
    next = std::copy_n(of_integrals.data(), of_integrals.size(), next);
    for (const EndCondition& condition : conditions) {
      std::vector<double> slope(2 * static_cast<std::size_t>(n_));
      condition_at(condition, constants(none), ends(z), slope, {});
      next = std::ranges::copy(slope, next).out;
    }
    for (const int node : constrained_) put(*problem_.manifold, node);
    return path.ordered() && finite(a_z);
  };
}

}  // namespace extremal
