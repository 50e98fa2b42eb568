#include "solve/contact/coarse_action.hpp"

#include <algorithm>
#include <cmath>

#include "problem/extension.hpp"
#include "problem/manifold.hpp"
#include "solve/contact/element_hessian.hpp"

namespace extremal {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Square = Eigen::Map<const RowMajor>;

const std::vector<EndCondition>& conditions_of(const Problem& problem) {
  static const std::vector<EndCondition> none;
  return problem.extension ? problem.extension->conditions : none;
}

/// q(0) and q(T) of a path of nodes.
std::vector<double> ends_of_nodes(std::span<const double> z, int n) {
  std::vector<double> ends(z.begin(), z.begin() + n);
  ends.insert(ends.end(), z.end() - n, z.end());
  return ends;
}

/// Of a condition at the ends of a path of nodes.
RowMajor second_derivatives(const Problem& problem, const EndCondition& condition,
                            std::span<const double> z) {
  const int n = problem.coordinates();
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> slope(2 * size);
  RowMajor second(2 * n, 2 * n);
  condition_at(problem, condition, ends_of_nodes(z, n), slope, {second.data(), 4 * size * size});
  return second;
}

/// The inner node that is nearest to a time.
int nearest_node(const std::vector<double>& times, double t) {
  const auto after = std::lower_bound(times.begin() + 1, times.end() - 2, t);
  const bool before = after != times.begin() + 1 && t - *(after - 1) < *after - t;
  return static_cast<int>(after - times.begin()) - before;
}

/// Of equal elements, but for the nodes at waypoints.
std::vector<double> node_times(const Problem& problem, int elements) {
  const double duration = problem.duration.value;
  std::vector<double> times(elements + 1);
  for (int k = 0; k < elements; ++k) times[k] = duration * k / elements;
  times.back() = duration;
  if (problem.extension)
    for (const WaypointCondition& waypoint : problem.extension->waypoints)
      times[nearest_node(times, waypoint.time)] = waypoint.time;
  return times;
}

}  // namespace

CoarseAction::CoarseAction(const Problem& problem, int elements)
    : CoarseAction(problem, node_times(problem, elements)) {}

CoarseAction::CoarseAction(const Problem& problem, std::vector<double> times)
    : problem_(problem),
      inequalities_(*problem.inequalities),
      n_(problem.coordinates()),
      elements_(static_cast<int>(times.size()) - 1),
      times_(std::move(times)) {
  put_waypoints();
  for (int k = 0; k <= elements_; ++k) {
    // The end of a closed path is its start.
    if (fixed(k) || (problem.periodic && k == elements_)) continue;
    for (int c = 0; c < inequalities_.count(); ++c) places_.push_back({k, c});
    if (problem.manifold) constrained_.push_back(k);
  }
}

void CoarseAction::put_waypoints() {
  if (!problem_.extension) return;
  for (const WaypointCondition& waypoint : problem_.extension->waypoints)
    for (const auto& [a, value] : waypoint.fixed)
      waypoints_.push_back({nearest_node(times_, waypoint.time), a, value});
}

bool CoarseAction::fixed(int node) const {
  if (std::ranges::count(waypoints_, node, &FixedCoordinate::node) == n_) return true;
  if (node != 0 && node != elements_) return false;
  const auto begin = problem_.ends.fixed.begin() + (node == 0 ? 0 : n_);
  return std::all_of(begin, begin + n_, [](char f) { return f; });
}

void CoarseAction::midpoint(std::span<const double> z, int k, Point& point) const {
  const double *a = z.data() + k * n_, *b = a + n_;
  point.q.resize(n_);
  point.v.resize(n_);
  for (int i = 0; i < n_; ++i) {
    point.q[i] = 0.5 * (a[i] + b[i]);
    point.v[i] = (b[i] - a[i]) / length(k);
  }
}

PointValues CoarseAction::values(std::span<const double> z, int k, Order order,
                                 std::span<const double> nu) const {
  Point point;
  Scratch scratch;
  midpoint(z, k, point);
  point.q.insert(point.q.end(), nu.begin(), nu.end());
  point.v.resize(point.q.size(), 0);
  const Lagrangian& lagrangian = nu.empty() ? *problem_.lagrangian : *problem_.extension->lagrangian;
  return evaluate_at(lagrangian, point.q, point.v, (times_[k] + times_[k + 1]) / 2, order, scratch);
}

ElementHessian CoarseAction::element(std::span<const double> z, int k, std::span<const double> nu,
                                     double kinetic_only) const {
  const int all = n_ + static_cast<int>(nu.size());
  ElementHessian found = element_hessian(values(z, k, Order::hessian, nu), length(k), all, kinetic_only);
  if (nu.empty()) return found;
  for (MatrixXd* block : {&found.aa, &found.ba, &found.bb}) *block = block->topLeftCorner(n_, n_).eval();
  return found;
}

std::vector<double> CoarseAction::integral_values(std::span<const double> z) const {
  std::vector<double> sums(integrals());
  if (sums.empty()) return sums;
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    for (std::size_t j = 0; j < sums.size(); ++j) sums[j] += length(k) * l.dq[n_ + j];
  }
  return sums;
}

/// ∂∫g/∂z, a row of each.
MatrixXd CoarseAction::integral_slopes(std::span<const double> z) const {
  const int m = integrals(), all = n_ + m;
  MatrixXd rows = MatrixXd::Zero(m, static_cast<Index>(z.size()));
  for (int k = 0; k < elements_ && m > 0; ++k) {
    const PointValues l = values(z, k, Order::hessian);
    const Square qq(l.qq.data(), all, all), vq(l.vq.data(), all, all);
    const MatrixXd by_q = 0.5 * length(k) * qq.bottomLeftCorner(m, n_),
                   by_v = vq.topRightCorner(n_, m).transpose();
    rows.middleCols(k * n_, n_) += by_q - by_v;
    rows.middleCols((k + 1) * n_, n_) += by_q + by_v;
  }
  return rows;
}

std::vector<double> CoarseAction::integral_multipliers(const MinimumReport& report) const {
  const auto first = report.of_equations.begin() + linear_equations();
  return {first, first + integrals()};
}

ConstraintValues CoarseAction::at(const Manifold& manifold, std::span<const double> z, int node) const {
  return manifold.at(z.subspan(node * n_, n_), time(node));
}

MatrixXd CoarseAction::curvature(const Manifold& manifold, std::span<const double> z, int node,
                                 std::span<const double> multipliers) const {
  const int all = n_ + 1 + static_cast<int>(multipliers.size());
  std::vector<double> point(z.begin() + node * n_, z.begin() + (node + 1) * n_), rest(all);
  point.push_back(time(node));
  point.insert(point.end(), multipliers.begin(), multipliers.end());
  Scratch scratch;
  const PointValues form = evaluate_at(*manifold.parts().forms, point, rest, 0, Order::hessian, scratch);
  return Square(form.qq.data(), all, all).topLeftCorner(n_, n_);
}

/// Of factor L + Σ ν g.
ElementHessian CoarseAction::weighted(std::span<const double> z, int k, double factor,
                                      std::span<const double> nu) const {
  const std::vector<double> none(nu.size());
  ElementHessian found = element(z, k, none, 0);
  for (MatrixXd* block : {&found.aa, &found.ba, &found.bb}) *block *= factor;
  if (nu.empty()) return found;
  const ElementHessian with = element(z, k, nu, 0), without = element(z, k, none, 0);
  found.aa += with.aa - without.aa;
  found.ba += with.ba - without.ba;
  found.bb += with.bb - without.bb;
  return found;
}

bool CoarseAction::hessian(std::span<const double> z, double factor, std::span<const double> multipliers,
                           std::span<double> entries) const {
  std::size_t at = 0;
  const auto put_lower = [&](const MatrixXd& block) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) entries[at++] = block(i, j);
  };
  const std::size_t m = inequalities_.count();
  const std::span<const double> nu = multipliers.subspan(places_.size() + linear_equations(), integrals());
  for (int k = 0; k < elements_; ++k) {
    const ElementHessian element = weighted(z, k, factor, nu);
    put_lower(element.aa);
    put_lower(element.bb);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) entries[at++] = element.ba(i, j);
  }
  for (std::size_t place = 0; place < places_.size(); place += m)
    put_lower(curvature(*inequalities_.all, z, places_[place].node, multipliers.subspan(place, m)));
  std::size_t row = places_.size() + linear_equations() + integrals();
  for (const EndCondition& condition : conditions_of(problem_)) {
    const RowMajor second = multipliers[row++] * second_derivatives(problem_, condition, z);
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
  return std::ranges::all_of(entries, [](double x) { return std::isfinite(x); });
}

InequalityMinimum CoarseAction::minimum(std::span<const double> z, double size) const {
  InequalityMinimum minimum;
  const std::vector<Triplet>& relation = problem_.boundary.matrix;
  const int rows = static_cast<int>(places_.size());
  minimum.variables = (elements_ + 1) * n_;
  minimum.inequalities = rows;
  const std::vector<EndCondition>& conditions = conditions_of(problem_);
  const int constraints = problem_.manifold ? problem_.manifold->constraints() : 0;
  minimum.equations = linear_equations() + integrals() + static_cast<int>(conditions.size()) +
                      constraints * static_cast<int>(constrained_.size());
  const auto variable = [this](int e) { return e < n_ ? e : elements_ * n_ + e - n_; };
  for (int i = 0; i < rows; ++i)
    for (int a = 0; a < n_; ++a) minimum.slopes.push_back({i, places_[i].node * n_ + a});
  for (const Triplet& b : relation) minimum.slopes.push_back({rows + b.row, variable(b.column)});
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
  put_functions(minimum);
  put_units(z, size, minimum);
  return minimum;
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
  if (!minimum.constraint_slopes(z, slopes)) return;
  // Those that are the same at other nodes have one unit.
  const int inequalities = inequalities_.count(), places = static_cast<int>(places_.size());
  const int constraints = problem_.manifold ? problem_.manifold->constraints() : 0;
  const int ends =
      minimum.inequalities + minimum.equations - constraints * static_cast<int>(constrained_.size());
  const auto kind = [&](int row) {
    if (row < places) return row % inequalities;
    return row < ends ? inequalities + row - places
                      : inequalities + ends - places + (row - ends) % constraints;
  };
  std::vector<double> largest(inequalities + ends - places + constraints);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    double& most = largest[kind(minimum.slopes[i].row)];
    most = std::max(most, std::abs(slopes[i]));
  }
  for (int row = 0; row < minimum.inequalities + minimum.equations; ++row) {
    const double most = largest[kind(row)];
    minimum.constraint_units.push_back(most > 0 ? most * size : 1);
  }
}

void CoarseAction::put_functions(InequalityMinimum& minimum) const {
  const std::vector<Triplet>& relation = problem_.boundary.matrix;
  const std::vector<EndCondition>& conditions = conditions_of(problem_);
  const int rows = static_cast<int>(places_.size());
  const auto variable = [this](int e) { return e < n_ ? e : elements_ * n_ + e - n_; };
  const std::vector<double>& momenta = problem_.boundary.momenta;
  minimum.value = [=, this, &momenta](std::span<const double> z, double& f) {
    f = 0;
    for (int k = 0; k < elements_; ++k) f += length(k) * values(z, k, Order::value).value;
    for (std::size_t e = 0; e < momenta.size(); ++e)
      f += (e < std::size_t(n_) ? 1 : -1) * momenta[e] * z[variable(static_cast<int>(e))];
    return std::isfinite(f);
  };
  minimum.gradient = [=, this, &momenta](std::span<const double> z, std::span<double> f_z) {
    std::ranges::fill(f_z, 0.0);
    for (int k = 0; k < elements_; ++k) {
      const PointValues l = values(z, k, Order::gradient);
      for (int i = 0; i < n_; ++i) {
        f_z[k * n_ + i] += 0.5 * length(k) * l.dq[i] - l.dv[i];
        f_z[(k + 1) * n_ + i] += 0.5 * length(k) * l.dq[i] + l.dv[i];
      }
    }
    for (std::size_t e = 0; e < momenta.size(); ++e)
      f_z[variable(static_cast<int>(e))] += (e < std::size_t(n_) ? 1 : -1) * momenta[e];
    return std::ranges::all_of(f_z, [](double x) { return std::isfinite(x); });
  };
  const int m = inequalities_.count();
  const auto size = static_cast<std::size_t>(n_);
  minimum.constraints = [=, this, &relation, &conditions](std::span<const double> z, std::span<double> a) {
    for (int i = 0; i < rows; i += m)
      std::ranges::copy(at(*inequalities_.all, z, places_[i].node).g, a.begin() + i);
    for (int r = 0; r < problem_.boundary.rows; ++r) a[rows + r] = -problem_.boundary.value[r];
    for (const Triplet& b : relation) a[rows + b.row] += b.value * z[variable(b.column)];
    std::vector<double> slope(2 * size);
    auto next = a.begin() + rows + problem_.boundary.rows;
    for (const FixedCoordinate& w : waypoints_) *next++ = z[w.node * n_ + w.coordinate] - w.value;
    const std::vector<double> integrals = integral_values(z);
    for (std::size_t j = 0; j < integrals.size(); ++j)
      *next++ = integrals[j] - problem_.extension->integrals[j];
    for (const EndCondition& condition : conditions)
      *next++ = condition_at(problem_, condition, ends_of_nodes(z, n_), slope, {});
    for (const int node : constrained_) next = std::ranges::copy(at(*problem_.manifold, z, node).g, next).out;
    return std::ranges::all_of(a, [](double x) { return std::isfinite(x); });
  };
  minimum.constraint_slopes = [=, this, &relation, &conditions](std::span<const double> z,
                                                                std::span<double> a_z) {
    auto next = a_z.begin();
    const auto put = [&](const Manifold& manifold, int node) {
      const RowMajor slopes = at(manifold, z, node).slopes;
      next = std::copy_n(slopes.data(), slopes.size(), next);
    };
    for (int i = 0; i < rows; i += m) put(*inequalities_.all, places_[i].node);
    for (const Triplet& b : relation) *next++ = b.value;
    next = std::fill_n(next, waypoints_.size(), 1.0);
    const RowMajor of_integrals = integral_slopes(z);
    next = std::copy_n(of_integrals.data(), of_integrals.size(), next);
    for (const EndCondition& condition : conditions) {
      std::vector<double> slope(2 * size);
      condition_at(problem_, condition, ends_of_nodes(z, n_), slope, {});
      next = std::ranges::copy(slope, next).out;
    }
    for (const int node : constrained_) put(*problem_.manifold, node);
    return std::ranges::all_of(a_z, [](double x) { return std::isfinite(x); });
  };
  minimum.hessian = [this](std::span<const double> z, double factor, std::span<const double> multipliers,
                           std::span<double> entries) { return hessian(z, factor, multipliers, entries); };
}

double CoarseAction::closing(std::span<const double> z) const {
  if (closed_by_condition(problem_)) {
    std::vector<double> gradient(2 * static_cast<std::size_t>(n_));
    return closing_condition(problem_, ends_of_nodes(z, n_), gradient);
  }
  double energy = 0;
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    double action = 0;  // p·q'
    for (int a = 0; a < n_; ++a) action += l.dv[a] * (z[(k + 1) * n_ + a] - z[k * n_ + a]);
    energy += (action - length(k) * l.value) / times_.back();
  }
  return energy - *problem_.duration.energy;
}

double CoarseAction::force(std::span<const double> z) const {
  double largest = 0;
  for (int k = 0; k < elements_; ++k) {
    const PointValues l = values(z, k, Order::gradient);
    for (int a = 0; a < n_; ++a)
      largest = std::max({largest, std::abs(l.dq[a]), std::abs(l.dv[a]) / problem_.duration.value});
  }
  return largest;
}

}  // namespace extremal
