#include "solve/search/gradient_flow.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/mesh/resolution.hpp"
#include "solve/newton/ends.hpp"
#include "solve/search/balance.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::gradient_flow;

GradientFlow::GradientFlow(const Problem& problem, Path& path, Workspace& workspace,
                           std::function<bool()> count)
    : problem_(problem),
      path_(path),
      w_(workspace),
      count_(std::move(count)),
      tables_(linear_elements(workspace.levels)),
      action_(workspace.iteration.action()) {}

const ElementTables& GradientFlow::linear_elements(Levels& levels) {
  return levels.finer(levels.at(1).scheme());
}

namespace {

int affordable_steps(int coordinates, int elements) {
  return static_cast<int>(std::min<double>(most_steps, most_work / (elements * std::pow(coordinates, 3))));
}

}  // namespace

int GradientFlow::elements_for(const Problem& problem) {
  if (problem.periodic || problem.paired || problem.duration.free) return 0;
  const int n = problem.coordinates(), count = std::clamp(most_nodal_values / n, least_elements, elements);
  return affordable_steps(n, count) < least_steps ? 0 : count / most_lanes * most_lanes;
}

/// S_h with what momenta that are given add.
double GradientFlow::value() const {
  double sum = action_.action();
  const std::span<const double> momenta = action_.momenta();
  const std::size_t n = path_.coordinates();
  for (std::size_t a = 0; a < n && !momenta.empty(); ++a)
    sum += momenta[a] * path_.node(0)[a] - momenta[n + a] * path_.node(path_.elements())[a];
  return sum;
}

bool GradientFlow::evaluate() {
  action_.evaluate(path_);
  shift_ = 0;
  return action_.finite() && std::isfinite(value());
}

bool GradientFlow::begin() {
  w_.iteration.reset(problem_, tables_, path_.elements());
  times_.reset(problem_, tables_, path_.elements());
  system_.reset(problem_.ends, path_.elements(), path_.coordinates(), false);
  saved_ = path_;
  if (path_.elements() < 3 || !evaluate()) return false;
  measure_mass();
  return std::ranges::all_of(mass_, [](double m) { return m > 0 && std::isfinite(m); });
}

/// L_q'q' of each coordinate, the mean along the path.
void GradientFlow::measure_mass() {
  const std::size_t n = path_.coordinates();
  const Lagrangian& lagrangian = *problem_.lagrangian;
  mass_.assign(n, 0);
  if (lagrangian.structure().quadratic) {
    for (const Triplet& m : lagrangian.structure().mass)
      if (m.row == m.column) mass_[m.row] += m.value;
    return;
  }
  std::vector<double> v(n);
  for (int k = 0; k < mass_samples; ++k) {
    const int i = k * path_.elements() / mass_samples;
    const double h = (path_.mesh()[i + 1] - path_.mesh()[i]) * path_.duration();
    for (std::size_t a = 0; a < n; ++a) v[a] = (path_.node(i + 1)[a] - path_.node(i)[a]) / h;
    const PointValues values = evaluate_at(lagrangian, {path_.node(i), n}, v,
                                           path_.mesh()[i] * path_.duration(), Order::hessian, w_.scratch);
    for (std::size_t a = 0; a < n; ++a) mass_[a] += values.vv[a * n + a] / mass_samples;
  }
}

/// Of ∫ φ_k L_qq at the nodes, which a constant displacement leaves of the second variation, by Gershgorin.
/// A rest of a low rate counts as much in the harmonic mean as it lasts, however steep others are.
void GradientFlow::measure_curvature() {
  const std::size_t n = path_.coordinates();
  const Chain& chain = action_.nodes.chain;
  const std::span<const double> mesh = path_.mesh();
  const int blocks = chain.blocks();
  double least = 0, most = 0, reciprocals = 0;
  for (int k = 0; k < blocks; ++k) {
    const double h = 0.5 * (mesh[k + 2] - mesh[k]) * path_.duration();
    const double* const before = k > 0 ? chain.lower(k - 1) : action_.nodes.first_lower.data();
    const double* const after = k + 1 < blocks ? chain.lower(k) : action_.nodes.last_lower.data();
    double largest = 1 / (path_.duration() * path_.duration());
    for (std::size_t a = 0; a < n; ++a) {
      double diagonal = 0, rest = 0;
      for (std::size_t b = 0; b < n; ++b) {
        const std::size_t i = a * n + b, j = b * n + a;
        const double sum = chain.diagonal(k)[i] + 0.5 * (before[i] + before[j] + after[i] + after[j]);
        const double entry = sum / (h * std::sqrt(mass_[a] * mass_[b]));
        (a == b ? diagonal : rest) += a == b ? entry : std::abs(entry);
      }
      least = std::min(least, diagonal - rest);
      largest = std::max(largest, std::abs(diagonal) + rest);
    }
    most = std::max(most, largest);
    reciprocals += h / largest;
  }
  curvature_ = -least;
  stiffness_ = most;
  softness_ = path_.duration() / reciprocals;
}

/// The equations of the nodes become those of a step with τ = 1/reciprocal.
void GradientFlow::shift_to(double reciprocal) {
  NodeEquations& nodes = action_.nodes;
  const std::size_t n = path_.coordinates(), last = path_.elements();
  const std::span<const double> mesh = path_.mesh();
  for (std::size_t k = 0; k <= last; ++k) {
    const double h = 0.5 * (mesh[std::min(k + 1, last)] - mesh[k > 0 ? k - 1 : 0]) * path_.duration();
    double* const block = k == 0      ? nodes.first.data()
                          : k == last ? nodes.last.data()
                                      : nodes.chain.diagonal(static_cast<int>(k) - 1);
    for (std::size_t a = 0; a < n; ++a) block[a * n + a] += (reciprocal - shift_) * h * mass_[a];
  }
  shift_ = reciprocal;
}

/// Whether the equations are positive definite, and factored then.
bool GradientFlow::factor() {
  return system_.factor(action_.nodes, nullptr) && system_.inertia(0).negative == 0;
}

/// The step; returns its largest component.
double GradientFlow::solve() {
  system_.solve(action_.nodes, nullptr, step_.nodes, step_.duration, false);
  action_.expand_step(step_.nodes, 0, step_.inner);
  double size = 0;
  for (double x : step_.nodes) size = std::isfinite(x) ? std::max(size, std::abs(x)) : INFINITY;
  return size;
}

/// Of value() along the step.
double GradientFlow::slope() const {
  const NodeEquations& nodes = action_.nodes;
  double sum = 0;
  for (std::size_t i = 0; i < step_.nodes.size(); ++i) sum += nodes.gradient[i] * step_.nodes[i];
  const std::size_t n = path_.coordinates(), last = step_.nodes.size() - n;
  for (std::size_t e = 0; e < nodes.end_parts.size(); ++e)
    sum += nodes.end_parts[e] * step_.nodes[e < n ? e : last + e - n];
  return sum;
}

void GradientFlow::apply(double factor) {
  path_.add(step_.nodes, step_.inner, factor);
  keep_ends(problem_.ends, path_);
  path_.load_ends();
}

/// One step downhill from a path that was evaluated, and stays so.
GradientFlow::Result GradientFlow::step() {
  measure_curvature();
  const double before = value(), ordered = faithful * curvature_;
  double size = 0;
  range_ = scales(path_, tables_).q;
  for (;;) {
    if (!count_()) return Result::failed;
    shift_to(wanted_);
    const bool definite = factor();
    if (definite) size = solve();
    const bool too_long = wanted_ < ordered && size > short_step * range_;
    if (definite && std::isfinite(size) && !too_long) break;
    const double longer =
        definite && std::isfinite(size) ? std::clamp(size / (short_step * range_), least_cut, cut) : cut;
    wanted_ = std::max(longer * wanted_, least_shift * stiffness_);
    if (!(wanted_ < most_shift * std::max(stiffness_, 1 / (path_.duration() * path_.duration()))))
      return Result::failed;
  }
  const double descent = slope();
  size_ = size;
  // Stationary, or nearly so along the directions that a shift leaves.
  const double final = final_shift * softness_;
  if (size * std::max(wanted_, final) <= close * range_ * final) return Result::minimal;
  const double factor = std::min(1.0, range_ > 0 ? longest_step * range_ / size : 1.0);
  saved_.copy_values(path_);
  apply(factor);
  const double allowed = before + sufficient * factor * descent + roundoff * std::abs(before);
  if (!evaluate() || !(value() <= allowed)) {
    path_.copy_values(saved_);
    path_.load_ends();
    if (!evaluate()) return Result::failed;
    if (size <= close * range_) return Result::minimal;
    wanted_ = std::max(cut * wanted_, least_shift * stiffness_);
    return Result::moved;
  }
  // Steps that are short relative to the path may be longer in time than the curvature allows.
  const double part = size / (short_step * range_);
  wanted_ = part > 1 ? std::max(wanted_ / growth, ordered) : wanted_ * std::max(1 / growth, std::sqrt(part));
  return Result::moved;
}

bool GradientFlow::run(double away) {
  T_ = path_.duration();
  staged_ = least_energy_ > 0;
  if (!begin() || (staged_ && !(equalise_energies() && redistribute()))) return false;
  measure_curvature();
  if (away != 0 && !leave_saddle(away, 0)) return false;
  wanted_ = faithful * curvature_;
  const double first = scales(path_, tables_).magnitude;
  const int affordable = affordable_steps(path_.coordinates(), path_.elements());
  double range_before = INFINITY, relaxed = 1;
  for (int steps = 1, left = 0; steps <= affordable; ++steps) {
    const Result result = step();
    if (result == Result::failed) return false;
    if (result == Result::minimal) {
      const double least = staged_ ? negative_of_stage : negative;
      if (!leave_saddle(side_ * kick, least) && !lengthen() && !shorten_rest()) return true;
      left = steps;
      continue;
    }
    relaxed *= wanted_ / (wanted_ + softness_);
    if (scales(path_, tables_).magnitude > runaway * std::max(first, range_)) return false;
    if ((steps - left) % patient_steps == 0) {
      // The action may have no minimum.
      if (curvature_ > 0 && range_ > growing * range_before && size_ > short_step * range_) return false;
      range_before = range_;
      // Rests are measured where the flow has had the time to straighten them.
      if (relaxed < close) shorten_rest();
      relaxed = 1;
    }
    if (steps % steps_a_mesh == 0 && !((least_energy_ == 0 || equalise_energies()) && redistribute()))
      return false;
  }
  // An interface that creeps through the elements; what holds it is found on better ones.
  return size_ <= short_step * range_;
}

/// Gives the time of a rest to others, if the action falls then: by less than the flow sees between long
/// rests, or as slowly as an interface moves. Whether it did; the path is evaluated then.
bool GradientFlow::shorten_rest() {
  if (rests_shortened_ == most_falls) return false;
  const Balance balance(problem_, path_);
  if (!balance.falls() || !balance.fall(path_) || !evaluate()) return false;
  ++rests_shortened_;
  wanted_ = faithful * curvature_;
  return true;
}

/// Of the elements, their corners kept. False if the path is no longer evaluated.
bool GradientFlow::equalise_energies() {
  const double before = value();
  const Path path = path_;
  if (!times_.apply(path_, T_, least_energy_)) return true;
  if (evaluate() && (path_.duration() < T_ || path.duration() < T_ || value() < before)) return true;
  path_ = path;
  return evaluate();
}

/// The next stage, of less energy and more time; the last has all of it, and times are those of the flow.
/// False where there is none.
bool GradientFlow::lengthen() {
  if (least_energy_ == 0) return false;
  least_energy_ = path_.duration() < T_ ? less_energy * least_energy_ : 0;
  if (least_energy_ < last_energy) least_energy_ = 0;
  if (path_.duration() < T_ && !times_.apply(path_, T_, least_energy_)) {
    path_.set_duration(T_);
    path_.load_ends();
  }
  if (!evaluate() || !redistribute()) return false;
  measure_curvature();
  if (least_energy_ == 0) wanted_ = faithful * curvature_;
  return true;
}

/// Nodes where the path is bent; the values move along a monotone cubic.
bool GradientFlow::redistribute() {
  curve_.fit(path_);
  const std::span<const double> tau = curve_.mesh();
  const std::size_t last = tau.size() - 1;
  std::vector<double> bend(last + 1, 0);
  for (std::size_t k = 1; k < last; ++k) {
    double sum = 0;
    for (int a = 0; a < path_.coordinates(); ++a) {
      const double before = (curve_.node(k, a) - curve_.node(k - 1, a)) / (tau[k] - tau[k - 1]);
      const double after = (curve_.node(k + 1, a) - curve_.node(k, a)) / (tau[k + 1] - tau[k]);
      sum += std::pow((after - before) / (0.5 * (tau[k + 1] - tau[k - 1])), 2);
    }
    bend[k] = std::pow(sum, 0.25);
  }
  bend[0] = bend[1];
  bend[last] = bend[last - 1];
  for (int pass = 0; pass < smoothings; ++pass) {
    double before = bend[0];
    for (std::size_t k = 1; k < last; ++k) {
      const double smooth = 0.25 * (before + 2 * bend[k] + bend[k + 1]);
      before = bend[k];
      bend[k] = smooth;
    }
  }
  density_.clear();
  for (std::size_t k = 0; k <= last; ++k) density_.add(tau[k], bend[k]);
  const std::vector<double> mesh = density_.mesh(static_cast<int>(last), floor);
  path_.reset(tables_, mesh, path_.duration());
  curve_.fill(tables_, path_);
  return evaluate();
}

/// Inverse iteration with the factors of a shift under which the second variation is positive definite; into
/// step_, in which the largest component is 1. Returns its eigenvalue by the mass. The gradient is lost.
double GradientFlow::lowest_eigenvalue() {
  NodeEquations& nodes = action_.nodes;
  const std::size_t n = path_.coordinates(), last = path_.elements();
  const std::span<const double> mesh = path_.mesh();
  Noise noise(0);
  step_.nodes.resize((last + 1) * n);
  for (std::size_t i = 0; i < step_.nodes.size(); ++i) step_.nodes[i] = 1 + noise();
  nodes.end_parts.clear();
  double growth = 0;
  for (int k = 0; k < inverse_iterations; ++k) {
    for (std::size_t j = 0; j <= last; ++j) {
      const double h = 0.5 * (mesh[std::min(j + 1, last)] - mesh[j > 0 ? j - 1 : 0]) * path_.duration();
      for (std::size_t a = 0; a < n; ++a) nodes.gradient[j * n + a] = -h * mass_[a] * step_.nodes[j * n + a];
    }
    growth = solve();
    if (!(growth > 0) || !std::isfinite(growth)) return INFINITY;
    for (double& x : step_.nodes) x /= growth;
  }
  return 1 / growth - shift_;
}

bool GradientFlow::leave_saddle(double size, double least) {
  shift_to(0);
  if (factor()) return false;
  double shift = least * stiffness_;
  shift_to(shift);
  if (least > 0 && factor()) return false;
  if (!(least > 0)) shift_to(shift = final_shift * stiffness_);
  for (; !factor(); shift_to(shift *= 2))
    if (!count_() || !(shift < most_shift * stiffness_)) return false;
  const bool saddle = lowest_eigenvalue() < -least * stiffness_;
  saved_.copy_values(path_);
  const double before = value();
  range_ = scales(path_, tables_).q;
  for (double part = 1; saddle && part > least_kick; part /= 2) {
    apply(part * size * range_);
    if (evaluate() && value() < before) {
      wanted_ = faithful * curvature_;
      return true;
    }
    path_.copy_values(saved_);
    path_.load_ends();
  }
  evaluate();
  return false;
}

}  // namespace extremal
