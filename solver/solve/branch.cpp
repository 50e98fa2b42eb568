#include "solve/branch.hpp"

#include <cmath>
#include <utility>

#include "solve/start.hpp"

namespace extremal {

namespace {

/// A change of the parameter for difference quotients, in its unit.
constexpr double small = 1e-5;

void add_scaled(std::vector<double>& to, double factor, std::span<const double> a,
                std::span<const double> b) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * (a[k] - b[k]);
}

}  // namespace

Branch::Branch(const ProblemFamily& family, Workspace& workspace)
    : family_(family), w_(workspace), problem_(family.problem), unit_(std::abs(family.to - family.from)) {
  if (by_duration()) problem_.duration = {.value = 0, .free = true, .energy = 0, .where = {}};
}

bool Branch::place(double coordinate) {
  if (by_duration()) {
    if (!(coordinate > 0)) return false;
    w_.path.set_duration(coordinate);
    if (!tables_ || tables_->scheme().degree != w_.path.degree()) bind();
    return true;
  }
  std::optional<Problem> problem = family_.at(coordinate);
  if (!problem) return false;
  problem_ = std::move(*problem);
  coordinate_ = coordinate;
  fit_path(problem_);
  bind();
  return true;
}

void Branch::bind() {
  w_.levels.bind(problem_.lagrangian);
  tables_ = &w_.levels.at(w_.path.degree());
  w_.iteration.reset(problem_, *tables_, w_.path.elements());
}

/// Ends, and a duration that is given, are the problem's exactly.
void Branch::fit_path(const Problem& problem) {
  if (!problem.duration.free) w_.path.set_duration(problem.duration.value);
  close_ends(problem, w_.path);
}

bool Branch::apply(const Move& move, double factor) {
  const double duration = w_.path.duration() + factor * move.step.duration;
  if (!(duration > 0)) return false;
  const double coordinate = this->coordinate() + factor * move.parameter;
  w_.path.add(move.step.nodes, move.step.inner, factor);
  if (!by_duration()) w_.path.set_duration(duration);
  w_.path.load_ends();
  const std::vector<double> before = ends();
  if (!place(coordinate)) return false;
  ends_ = ends();
  for (std::size_t e = 0; e < ends_.size(); ++e) ends_[e] -= before[e];
  stretch_ = by_duration() ? 0 : w_.path.duration() - duration;
  return true;
}

/// q(0), q(T).
std::vector<double> Branch::ends() const {
  const int n = w_.path.coordinates();
  std::vector<double> both(w_.path.node(0), w_.path.node(0) + n);
  both.insert(both.end(), w_.path.node(w_.path.elements()), w_.path.node(w_.path.elements()) + n);
  return both;
}

double Branch::drift(const Move& tangent) const {
  const std::size_t n = ends_.size() / 2, last = tangent.step.nodes.size() - n;
  double sum = 0;
  for (std::size_t a = 0; a < n; ++a)
    sum += tangent.step.nodes[a] * ends_[a] + tangent.step.nodes[last + a] * ends_[n + a];
  return sum / (units_.extent * units_.extent * static_cast<double>(tangent.step.nodes.size())) +
         tangent.step.duration * stretch_ / (units_.duration * units_.duration);
}

bool Branch::linearise() {
  const bool solved = by_duration() ? linearise_duration() : linearise_parameter();
  const double length = solved ? dot(direction, direction) : 0;
  return std::isfinite(length) && length > 0 && std::isfinite(dot(correction, correction));
}

/// With H and t the second derivatives of S_h in x and in x and T, H δx + t δT = −g leaves one direction
/// free. Two right-hand sides of the equation that would close it give two solutions, even where H is
/// singular.
bool Branch::linearise_duration() {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  ClosingEquation closing;
  if (!model.evaluate(action, w_.path, &closing) || !action.finite()) return false;
  action_ = action.action();
  energy_ = -action.slope_duration();
  energy_unit_ = std::abs(energy_) + std::abs(action_) / w_.path.duration();
  if (energy_unit_ == 0) energy_unit_ = 1;
  const auto solve = [&](double excess, Move& move) {
    closing.value = excess + energy_;
    model.solve(action, &closing, move.step);
    move.parameter = std::exchange(move.step.duration, 0);
  };
  solve(0, correction);
  solve(energy_unit_, direction);
  direction.add(correction, -1);
  inertia_ = model.inertia(threshold_);
  action_slope_ = -energy_ * direction.parameter;
  return true;
}

/// H δx = −∂g/∂p, and what closes a free duration with it, by gradients beside the path with the factors
/// there are. Ends that depend on p move along a line.
bool Branch::linearise_parameter() {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  ClosingEquation equation;
  const ClosingEquation* closing = closing_equation(problem_, w_.path, equation);
  if (!model.evaluate(action, w_.path, closing) || !action.finite()) return false;
  action_ = action.action();
  energy_ = -action.slope_duration();
  inertia_ = model.inertia(threshold_);
  model.solve(action, closing, correction.step);
  correction.parameter = 0;
  closing_sign_ = 1;
  if (closing) {
    equation.value -= 1 + std::abs(equation.value);
    model.solve(action, closing, direction.step);
    closing_sign_ = direction.step.duration - correction.step.duration < 0 ? -1 : 1;
  }
  Move before;
  const double by = small * unit_;
  const double after_action = solve_beside(by, direction), before_action = solve_beside(-by, before);
  if (!std::isfinite(after_action) || !std::isfinite(before_action)) return false;
  direction.add(before, -1);
  direction.scale(1 / (2 * by));
  direction.parameter = 1;
  action_slope_ = (after_action - before_action) / (2 * by);
  if (problem_.duration.free) action_slope_ -= energy_ * direction.step.duration;
  return true;
}

/// The step from the path, as it would lie in the problem beside, to that problem's extremal. Returns the
/// action there; NaN if there is no such problem.
double Branch::solve_beside(double by, Move& move) {
  const std::optional<Problem> problem = family_.at(coordinate_ + by);
  if (!problem) return NAN;
  beside_.bind(problem->lagrangian);
  DiscreteAction& action = w_.iteration.action();
  at_ = w_.path;
  fit_path(*problem);
  action.substitute(*problem->lagrangian, beside_.at(w_.path.degree()));
  w_.iteration.model().evaluate_gradient(action, w_.path);
  ClosingEquation equation;
  w_.iteration.model().solve(action, closing_equation(*problem, w_.path, equation), move.step);
  add_scaled(move.step.nodes, 1, w_.path.nodes(), at_.nodes());
  move.step.duration += w_.path.duration() - at_.duration();
  move.parameter = by;
  action.substitute(*problem_.lagrangian, *tables_);
  w_.path.copy_values(at_);
  w_.path.load_ends();
  return action.finite() ? action.action() : NAN;
}

double Branch::varied() const { return family_.varied == Varied::energy ? energy_ : coordinate(); }

double Branch::change(bool along) const {
  if (family_.varied == Varied::energy) return along ? energy_unit_ : 0;
  return along ? direction.parameter : correction.parameter;
}

int Branch::orientation(double onward) const {
  const bool negative = (inertia_.negative % 2 != 0) != (onward * direction.parameter * closing_sign_ < 0);
  return negative ? -1 : 1;
}

double Branch::dot(const Move& a, const Move& b) const {
  double sum = 0;
  for (std::size_t k = 0; k < a.step.nodes.size(); ++k) sum += a.step.nodes[k] * b.step.nodes[k];
  const double unit = by_duration() ? units_.duration : unit_;
  return sum / (units_.extent * units_.extent * static_cast<double>(a.step.nodes.size())) +
         a.step.duration * b.step.duration / (units_.duration * units_.duration) +
         a.parameter * b.parameter / (unit * unit);
}

}  // namespace extremal
