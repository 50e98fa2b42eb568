#include "solve/branch/branch.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "action/energies.hpp"
#include "linear/dense.hpp"
#include "machine/simd.hpp"
#include "solve/branch/limits.hpp"
#include "solve/mesh/roundoff.hpp"
#include "solve/newton/agreement.hpp"
#include "solve/newton/ends.hpp"
#include "solve/newton/residual_test.hpp"

namespace extremal {

using namespace limits::branch;

namespace {

void add_scaled(std::vector<double>& to, double factor, std::span<const double> a,
                std::span<const double> b) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * (a[k] - b[k]);
}

}  // namespace

Branch::Branch(const ProblemFamily& family, Path& path, Workspace& workspace)
    : family_(family),
      path_(path),
      w_(workspace),
      problem_(family.problem),
      unit_(std::abs(family.to - family.from)) {
  if (by_duration()) problem_.duration = {.value = 0, .free = true, .energy = 0, .where = {}};
}

bool Branch::set_coordinate(double coordinate) {
  if (by_duration()) {
    if (!(coordinate > 0)) return false;
    path_.set_duration(coordinate);
    if (!tables_ || tables_->scheme().degree != path_.degree()) bind();
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
  tables_ = &w_.levels.at(path_.degree());
  w_.iteration.reset(problem_, *tables_, path_.elements());
  w_.iteration.end_at({});
  if (folds_ == true) w_.iteration.model().set_null_below(0);
  factored_ = false;
}

/// Ends, and a duration that is given, are the problem's exactly.
void Branch::fit_path(const Problem& problem) {
  if (!problem.duration.free) path_.set_duration(problem.duration.value);
  meet_ends(problem, path_);
}

bool Branch::apply(const Move& move, double factor) {
  const double duration = path_.duration() + factor * move.step.duration;
  defined_ = duration > 0;
  if (!defined_) return false;
  const double coordinate = this->coordinate() + factor * move.parameter;
  std::vector<Corner> corners;
  if (tables_->kinks()) {
    const ClosingMap closed = problem_.periodic ? closing_map(problem_) : ClosingMap{};
    corners = corners_of(*tables_->kinks(), path_, problem_.periodic ? &closed : nullptr);
  }
  path_.add(move.step.nodes, move.step.inner, factor);
  if (!by_duration()) path_.set_duration(duration);
  path_.load_ends();
  // A path may leave a surface that it has crossed twice. Forces that do not jump there need no corner.
  if (!move_corners(path_, corners, move.step.nodes, factor) && forces_jump(corners)) return false;
  const std::vector<double> before = ends();
  defined_ = set_coordinate(coordinate);
  if (!defined_) return false;
  ends_ = ends();
  for (std::size_t e = 0; e < ends_.size(); ++e) ends_[e] -= before[e];
  stretch_ = by_duration() ? 0 : path_.duration() - duration;
  return true;
}

/// q(0), q(T).
std::vector<double> Branch::ends() const {
  const int n = path_.coordinates();
  std::vector<double> both(path_.node(0), path_.node(0) + n);
  both.insert(both.end(), path_.node(path_.elements()), path_.node(path_.elements()) + n);
  return both;
}

double Branch::drift(const Move& tangent) const {
  const std::size_t n = ends_.size() / 2, last = tangent.step.nodes.size() - n;
  double sum = 0;
  for (std::size_t a = 0; a < n; ++a)
    sum += weight(0) * tangent.step.nodes[a] * ends_[a] +
           weight(path_.elements()) * tangent.step.nodes[last + a] * ends_[n + a];
  return sum / (units_.extent * units_.extent * static_cast<double>(n)) +
         tangent.step.duration * stretch_ / (units_.duration * units_.duration);
}

bool Branch::linearise(Factors factors) {
  if (factors == Factors::anew) {
    inertia_.reset();
    with_duration_.reset();
    measure_phases(problem_, path_, tables_->scheme(), true, phases_);
    if (!problem_.paired) phases_ = independent(phases_);  // along a circle a rotation is a shift of time
    for (const Move& direction : family_directions_) hold_along(direction);
    for (const Move& direction : held_) hold_along(direction);
    w_.iteration.model().set_phases(phases_.count > 0 ? &phases_ : nullptr);
  }
  const bool solved = by_duration() ? linearise_duration(factors) : linearise_parameter();
  if (problem_.paired) {
    make_agree(correction.step, problem_.coordinates());
    make_agree(direction.step, problem_.coordinates());
  }
  const double length = solved ? dot(direction, direction) : 0;
  return std::isfinite(length) && length > 0 && std::isfinite(dot(correction, correction));
}

/// Nothing along a direction in the mean over τ.
void Branch::hold_along(const Move& direction) {
  const std::size_t n = path_.coordinates();
  std::vector<double> weighted = direction.step.nodes;
  for (std::size_t i = 0; i < weighted.size(); ++i) weighted[i] *= weight(static_cast<int>(i / n));
  phases_.add(weighted);
  if (!problem_.paired) return;
  // Of two copies the direction holds the mean alone: their difference is held by what it is across.
  negate_second(weighted);
  phases_.add(weighted);
}

/// Of two copies at each node.
void Branch::negate_second(std::vector<double>& nodes) const {
  const std::size_t n = path_.coordinates();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (i % n >= n / 2) nodes[i] = -nodes[i];
}

/// In the mean over τ, as phases_ hold it.
void Branch::take_across_phases(Move& move) const {
  const Eigen::Index count = phases_.count, size = std::ssize(move.step.nodes), n = path_.coordinates();
  if (count == 0) return;
  const Eigen::Map<const Eigen::MatrixXd> weighted(phases_.directions.data(), size, count);
  Eigen::MatrixXd directions = weighted;
  for (Eigen::Index i = 0; i < size; ++i) directions.row(i) /= weight(static_cast<int>(i / n));
  Eigen::Map<Eigen::VectorXd> nodes(move.step.nodes.data(), size);
  nodes -= directions * solved(weighted.transpose() * directions, weighted.transpose() * nodes);
}

bool Branch::evaluate(const ClosingEquation* closing, Factors factors) {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  if (factors == Factors::anew)
    factored_ = model.evaluate(action, path_, closing);
  else
    model.evaluate_gradient(action, path_);
  defined_ = action.finite();
  if (!factored_ || !defined_) return false;
  note_action();
  return true;
}

void Branch::note_action() {
  const DiscreteAction& action = w_.iteration.action();
  action_ = action.action();
  energy_ = -action.slope_duration();
  // At rest there are no momenta, but forces that cancel leave roundoff.
  const double roundoff = force_roundoff * w_.iteration.stiffness() * largest_coordinate(path_);
  residual_ = action.residual() > roundoff ? action.residual() / action.momentum_scale() : 0;
  momenta_.assign(action.start_gradient().begin(), action.start_gradient().end());
  for (double& p : momenta_) p = -p;
  momenta_.insert(momenta_.end(), action.end_gradient().begin(), action.end_gradient().end());
  const NodeEquations& nodes = action.nodes;
  forces_ = nodes.gradient;
  const std::size_t n = nodes.end_parts.size() / 2, last = forces_.size() - n;
  for (std::size_t a = 0; a < n; ++a) {
    forces_[a] += nodes.end_parts[a];
    forces_[last + a] += nodes.end_parts[n + a];
  }
}

double Branch::force_along(const Move& direction) const {
  std::vector<double> along = direction.step.nodes;
  if (problem_.paired) negate_second(along);  // the derivative by the difference of the copies
  return std::inner_product(along.begin(), along.end(), forces_.begin(), 0.0);
}

/// Where what closes the equations hardly changes along them, as the energy of paths that rest for ever
/// longer at a saddle, the duration does.
bool Branch::linearise_duration(Factors factors) {
  if (!solve_closed(factors)) return false;
  if (factors == Factors::anew && dot(direction, direction) * least_closing * least_closing > 1) {
    closing_ = closed_by_duration();
    if (!solve_closed(factors)) return false;
  }
  const DiscreteAction& action = w_.iteration.action();
  const bool by_energy = closing_.row.empty();
  along_ = by_energy ? energy_unit_ : energy_change(direction);
  const double length = std::sqrt(dot(direction, direction));
  free_ = {direction.parameter / (units_.duration * length), along_ / (energy_unit_ * length)};
  if (w_.iteration.model().left_out() > 0) free_.energy = NAN;
  off_ = by_energy
             ? 0
             : energy_change(correction) - action.nodes.border_part - action.nodes.border_gradient - energy_;
  action_slope_ = -energy_ * direction.parameter + work_of_momenta(direction);
  return true;
}

/// Correction and direction, along which what closes the equations changes by its unit.
bool Branch::solve_closed(Factors factors) {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  if (!evaluate(&closing_, factors)) return false;
  const bool anew = factors == Factors::anew, by_energy = closing_.row.empty();
  if (anew) energy_unit_ = energy_unit(action, path_.duration());
  closing_.value = by_energy ? energy_ : 0;
  solve_with_duration(model, action, closing_, correction);
  if (!anew) return true;
  const double unit = closing_.by_duration != 0 ? units_.duration : units_.extent;
  closing_.value = by_energy ? energy_ + energy_unit_ : -unit;
  solve_with_duration(model, action, closing_, direction);
  direction.add(correction, -1);
  return true;
}

ClosingEquation Branch::closed_by_duration() const {
  return {.row = std::vector<double>(2 * static_cast<std::size_t>(path_.coordinates()), 0.0),
          .by_duration = 1};
}

/// Of E = −∂S/∂T, to first order.
double Branch::energy_change(const Move& move) const {
  const NodeEquations& nodes = w_.iteration.action().nodes;
  return -std::inner_product(move.step.nodes.begin(), move.step.nodes.end(), nodes.border.begin(),
                             nodes.corner * (by_duration() ? move.parameter : move.step.duration));
}

/// Where the energy has an extremum along the branch, the equations that it closes are singular. So are those
/// that a displacement of the ends closes, where they do not move, and at folds those that the duration does.
ClosingEquation Branch::closing(const Move& onward) const {
  if (!by_duration() || tables_->unknowns() > most_dense_unknowns) return {};
  const std::size_t n = path_.coordinates(), last = onward.step.nodes.size() - n;
  std::vector<double> row(onward.step.nodes.begin(), onward.step.nodes.begin() + n);
  row.insert(row.end(), onward.step.nodes.begin() + last, onward.step.nodes.end());
  const double length = std::sqrt(std::inner_product(row.begin(), row.end(), row.begin(), 0.0)),
               of_ends = length / units_.extent, of_energy = std::abs(energy_change(onward)) / energy_unit_,
               of_duration = std::abs(onward.parameter) / units_.duration;
  if (std::max(of_ends, of_energy) < least_closing * of_duration) return closed_by_duration();
  if (!(of_ends > of_energy)) return {};
  for (double& x : row) x /= length;
  return {.row = std::move(row)};
}

/// H δx = −∂g/∂p, and the equation that closes a free duration with it, by gradients beside the path with the
/// factors there are. Ends that depend on p move along a line.
bool Branch::linearise_parameter() {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  ClosingEquation equation;
  const ClosingEquation* closing = closing_equation(problem_, path_, equation);
  if (!evaluate(closing, Factors::anew)) return false;
  model.solve(action, closing, correction.step);
  if (!folds_) folds_ = model.left_out() == 0;
  correction.parameter = 0;
  free_ = {};
  if (closing) {
    const double growth = 1 + std::abs(equation.value);
    equation.value -= growth;
    model.solve(action, closing, direction.step);
    direction.parameter = 0;
    direction.add(correction, -1);
    const double length = std::sqrt(dot(direction, direction));
    free_.duration = direction.step.duration / (units_.duration * length);
    energy_unit_ = energy_unit(action, path_.duration());
    if (model.left_out() > 0)
      free_.energy = NAN;
    else if (closing->row.empty())
      free_.energy = -growth / (energy_unit_ * length);
    else if (tables_->unknowns() <= most_dense_unknowns)
      free_.energy = energy_change(direction) / (energy_unit_ * length);
  }
  if (!respond_to_parameter()) return false;
  action_slope_ += work_of_momenta(direction);
  if (problem_.duration.free) action_slope_ -= energy_ * direction.step.duration;
  return true;
}

/// The step per parameter, and the slope of the action.
bool Branch::respond_to_parameter() {
  const auto quotient = [this](double by, Move& change, double& slope) {
    Move before;
    const double after_action = solve_beside(by, change), before_action = solve_beside(-by, before);
    if (!std::isfinite(after_action) || !std::isfinite(before_action)) return false;
    change.add(before, -1);
    change.scale(1 / (2 * by));
    slope = (after_action - before_action) / (2 * by);
    return std::isfinite(dot(change, change));
  };
  Move wider;
  double slope = 0, wider_slope = 0;
  const double by = wide * unit_;
  defined_ = true;
  if (quotient(by, direction, slope) && quotient(2 * by, wider, wider_slope)) {
    wider.add(direction, -1);
    if (dot(wider, wider) <= most_curved * most_curved * dot(direction, direction)) {
      // The error of both grows with the square of the change (Richardson).
      direction.add(wider, -1.0 / 3);
      direction.parameter = 1;
      action_slope_ = slope - (wider_slope - slope) / 3;
      return true;
    }
  }
  defined_ = quotient(narrow * unit_, direction, action_slope_);
  direction.parameter = 1;
  return defined_;
}

/// p(T)·δq(T) − p(0)·δq(0) of momenta that are given: S is not stationary in these ends.
double Branch::work_of_momenta(const Move& move) const {
  const std::span<const double> momenta = problem_.boundary.momenta;
  const std::size_t n = momenta.size() / 2, last = move.step.nodes.size() - n;
  double work = 0;
  for (std::size_t a = 0; a < n; ++a)
    work += momenta[n + a] * move.step.nodes[last + a] - momenta[a] * move.step.nodes[a];
  return work;
}

/// The step from the path, as it would lie in the problem beside, to that problem's extremal. Returns the
/// action there; NaN if there is no such problem.
double Branch::solve_beside(double by, Move& move) {
  const std::optional<Problem> problem = family_.at(coordinate_ + by);
  if (!problem) return NAN;
  beside_.bind(problem->lagrangian);
  DiscreteAction& action = w_.iteration.action();
  at_ = path_;
  fit_path(*problem);
  action.substitute(*problem->lagrangian, beside_.at(path_.degree()));
  action.give_momenta(problem->boundary.momenta);
  w_.iteration.model().evaluate_gradient(action, path_);
  ClosingEquation equation;
  w_.iteration.model().solve(action, closing_equation(*problem, path_, equation), move.step);
  add_scaled(move.step.nodes, 1, path_.nodes(), at_.nodes());
  move.step.duration += path_.duration() - at_.duration();
  move.parameter = by;
  action.substitute(*problem_.lagrangian, *tables_);
  action.give_momenta(problem_.boundary.momenta);
  path_.copy_values(at_);
  path_.load_ends();
  return action.finite() ? action.action() : NAN;
}

double Branch::step_under(const ElementTables& quadrature) {
  QuadraticModel& model = w_.iteration.model();
  DiscreteAction& action = w_.iteration.action();
  action.substitute(*problem_.lagrangian, quadrature);
  model.evaluate_gradient(action, path_);
  Move move;
  ClosingEquation equation = closing_;
  if (by_duration()) {
    equation.value = equation.row.empty() ? energy_ : 0;
    solve_with_duration(model, action, equation, move);
  } else {
    model.solve(action, closing_equation(problem_, path_, equation), move.step);
  }
  action.substitute(*problem_.lagrangian, *tables_);
  move.add(direction, -dot(direction, move) / dot(direction, direction));
  return action.finite() ? largest(move) : INFINITY;
}

double Branch::varied() const { return family_.varied == Varied::energy ? energy_ : coordinate(); }

double Branch::change(bool along) const {
  if (family_.varied == Varied::energy) return along ? along_ : off_;
  return along ? direction.parameter : correction.parameter;
}

double Branch::varied_unit() const {
  switch (family_.varied) {
    case Varied::energy:
      return energy_unit_;
    case Varied::duration:
      return units_.duration;
    case Varied::parameter:
      break;
  }
  return unit_;
}

void Branch::respond(const Move& onward, Move& response, int which) {
  const std::size_t n = path_.coordinates(), count = path_.elements() + 1;
  std::vector<double> load(count * n);
  for (std::size_t k = 1; k + 1 < count; ++k)
    for (std::size_t a = 0; a < n; ++a) {
      const double tau = path_.mesh()[k], weight = path_.mesh()[k + 1] - path_.mesh()[k - 1];
      load[k * n + a] = weight * (std::cos(1 + 2.4 * a + 5.1 * tau + which * (0.7 + 1.1 * a + 0.9 * tau)) +
                                  std::sin(2 + 1.3 * a + 17.3 * tau + which * (1.9 + 0.6 * a + 2.3 * tau)));
    }
  if (problem_.paired) {  // a force, which is the derivative by the difference of the copies
    for (std::size_t i = 0; i < load.size(); ++i)
      if (i % n >= n / 2) load[i] = load[i - n / 2];
    negate_second(load);
  }
  ClosingEquation equation;
  const ClosingEquation* closing = by_duration() ? &closing_ : closing_equation(problem_, path_, equation);
  w_.iteration.second_variation()->respond(w_.iteration.action(), closing, load, response.step);
  if (problem_.paired) make_agree(response.step, problem_.coordinates());
  response.parameter = by_duration() ? std::exchange(response.step.duration, 0) : 0;
  response.add(direction, -dot(onward, response) / dot(onward, direction));
}

/// Of node k in the mean over τ.
double Branch::weight(int k) const {
  const std::span<const double> mesh = path_.mesh();
  return 0.5 * (mesh[std::min(k + 1, path_.elements())] - mesh[std::max(k - 1, 0)]);
}

double Branch::dot(const Move& a, const Move& b) const {
  const std::size_t n = path_.coordinates();
  double sum = 0;
  for (int k = 0; k <= path_.elements(); ++k) {
    double product = 0;
    for (std::size_t i = k * n; i < (k + 1) * n; ++i) product += a.step.nodes[i] * b.step.nodes[i];
    sum += weight(k) * product;
  }
  const double unit = by_duration() ? units_.duration : unit_;
  return sum / (units_.extent * units_.extent * static_cast<double>(n)) +
         a.step.duration * b.step.duration / (units_.duration * units_.duration) +
         a.parameter * b.parameter / (unit * unit);
}

double Branch::largest(const Move& move) const {
  double most = 0;
  for (const double x : move.step.nodes) most = std::max(most, std::abs(x));
  for (const double x : move.step.inner) most = std::max(most, std::abs(x));
  const double unit = by_duration() ? units_.duration : unit_;
  return std::max({most / units_.extent, std::abs(move.step.duration) / units_.duration,
                   std::abs(move.parameter) / unit});
}

}  // namespace extremal
