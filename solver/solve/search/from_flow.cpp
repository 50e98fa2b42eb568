#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "solve/adapt/finer_elements.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/resolve.hpp"
#include "solve/search/balance.hpp"
#include "solve/search/gradient_flow.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/search.hpp"

/// \file Paths that the gradient flow of the action leads to.

namespace extremal {

namespace flow_limits = limits::gradient_flow;
namespace rest_limits = limits::balance;

/// Downhill along the gradient flow of the action. A flow keeps symmetries of its first path, which may lead
/// to a saddle, or to rests that hardly end: one of a bent path does not.
bool Search::by_gradient_flow(double side) {
  if (flow_from_guess(bend_, side) || (stages() && flow_from_guess(bend_, side, true))) {
    leave_saddles();
    return true;
  }
  return acceptance_ && (flow_aside(INFINITY) || (stages() && flow_aside(INFINITY, true)));
}

/// Whether the flow may begin with less time. A guess of the user has the times of its rests.
bool Search::stages() const { return problem_.lagrangian->structure().autonomous && !guess_->guess.given(); }

/// From the guess bent by noise, more and more, to an extremal of less action.
bool Search::flow_aside(double action, bool staged) {
  const unsigned most = problem_.coordinates() > 1 ? flow_limits::bends_aside : 0;
  for (unsigned seed = 1; seed <= most && !options_.deadline.passed(); ++seed)
    if (flow_from_guess({flow_limits::bend_aside * seed, seed}, 1, staged) &&
        acceptance_->solution().action < action)
      return true;
  return false;
}

bool Search::flow_from_guess(const Bend& bend, double side, bool staged) {
  const int elements = GradientFlow::elements_for(problem_);
  if (elements == 0) return false;
  const ElementTables& linear = GradientFlow::linear_elements(w_.levels);
  const std::vector<double> mesh = uniform_mesh(elements);
  refinement_.open(mesh, 1);
  path_.reset(linear, mesh, problem_.duration.value);
  start_path(*guess_, ends_, linear, path_);
  bend_path(problem_, bend, linear, path_);
  return flow_from(0, side, staged);
}

/// Saddles that were accepted are left for extremals of less action.
void Search::leave_saddles() {
  for (int left = 0; left < flow_limits::most_saddles; ++left) {
    if (!acceptance_ || acceptance_->solution().morse_index.value_or(0) == 0) return;
    const Solution saddle = acceptance_->solution();
    const Outcome found = outcome_;
    const auto left_to = [&](double side) {
      return descend_from(saddle.trajectory, side) && acceptance_->solution().action < saddle.action;
    };
    if (left_to(1) || left_to(-1) || flow_aside(saddle.action)) continue;
    acceptance_->put_back(saddle);
    outcome_ = found;
    refinement_.rebind();
    return;
  }
}

bool Search::descend_from(const Trajectory& saddle, double side) {
  const int elements = GradientFlow::elements_for(problem_);
  if (elements == 0) return false;
  const ElementTables& linear = GradientFlow::linear_elements(w_.levels);
  const double T = saddle.duration();
  const int parts = std::max(1, elements / saddle.elements());
  std::vector<double> mesh;
  for (int k = 0; k < saddle.elements(); ++k)
    for (int j = 0; j < parts; ++j)
      mesh.push_back((saddle.times[k] + (saddle.times[k + 1] - saddle.times[k]) * j / parts) / T);
  mesh.push_back(1);
  const std::size_t n = saddle.coordinates;
  std::vector<double> ends(2 * n), v(n);
  saddle.at(0, {ends.data(), n}, v);
  saddle.at(T, {ends.data() + n, n}, v);
  refinement_.open(mesh, 1);
  path_.reset(linear, mesh, T);
  fill_path(ends, linear, path_, [&](double tau, double* q) { saddle.at(std::min(tau * T, T), {q, n}, v); });
  const bool result = flow_from(side, side);
  outcome_.status = result ? Status::converged : Status::not_converged;
  return result;
}

bool Search::descend_from_guess(double side) {
  const bool result = by_gradient_flow(side);
  outcome_.status = result ? Status::converged : Status::not_converged;
  return result;
}

/// From the path, which is on linear elements, to a minimiser, and by Newton's method on elements made of
/// several of those to the tolerance.
bool Search::flow_from(double away, double side, bool staged) {
  constexpr const char* strategy = "minimisation by the gradient flow";
  // A search for several solutions renews its effort with each.
  const int most = acceptance_ ? options_.max_iterations : outcome_.attempts + allowance_;
  if (outcome_.attempts >= most) return false;
  const auto count = [&] {
    outcome_.record(w_.iteration, options_);
    return !options_.deadline.passed() && outcome_.attempts < most;
  };
  GradientFlow flow(problem_, path_, w_, count);
  flow.prefer(side);
  if (staged) flow.lengthen_by_stages();
  if (!flow.run(away * flow_limits::kick)) return false;
  // Newton's method may have spent all on long intervals, where its equations are nearly singular.
  const auto renew = [&] {
    refinement_.allow_at_least(std::min(allowance_, most - outcome_.attempts), flow_limits::share);
  };
  MonotoneCubic curve;
  curve.fit(path_);
  const std::span<const double> nodes = curve.mesh();
  std::vector<double> mesh;
  for (std::size_t k = 0; k + 1 < nodes.size(); k += flow_limits::nodes_an_element) mesh.push_back(nodes[k]);
  mesh.push_back(1);
  mesh = graded(std::move(mesh), flow_limits::steepest_grading);
  const auto reopen = [&](int degree) {
    refinement_.open(mesh, degree);
    curve.fill(refinement_.tables(), path_);
  };
  reopen(Refinement::first_degree);
  renew();
  if (found(strategy)) return true;
  reopen(Refinement::first_degree);
  // Minimisers that are a family, as arcs in all planes through both ends, are one degenerate minimum.
  if (family_steps_of_flows_ > 0) {
    const bool none = no_family_;
    if (on_family(false, family_steps_of_flows_)) return true;
    no_family_ = none;
    reopen(Refinement::first_degree);
  }
  if (held_in_time(strategy, renew)) return true;
  // Linear elements hold a path where forces are smaller than their errors.
  reopen(flow_limits::finishing_degree);
  renew();
  return descend(flow_limits::most_steps, flow_limits::finished) && found(strategy);
}

/// Of q, absolute: what elements of a higher degree change of the shifts for which energies agree.
double Search::displaced_by_finer_elements() {
  Path& finer = on_finer_elements(problem_, path_, refinement_.tables(), rest_limits::finer_by, w_);
  w_.iteration.hold_shifts(true);
  const NewtonReport report = converge(w_.iteration, finer, w_.levels.at(finer.degree()),
                                       {.steps = rest_limits::finer_steps}, [this] { return count_step(); });
  if (!report.reached) return INFINITY;
  const Balance balance(problem_, finer, Balance::Accuracy::extrapolated);
  return balance.exists() ? balance.displacement() : INFINITY;
}

/// Moves the path to where 106 bits know it, on elements of a higher degree. Returns it on these, and what
/// those of a still higher one change of it; nothing where it is not isolated.
std::optional<Search::Placed> Search::moved_with_more_digits() {
  const auto found = [&](int by) -> std::optional<Path> {
    Path finer = on_finer_elements(problem_, path_, refinement_.tables(), by, w_);
    if (!refinement_.count_step() || !resolve(w_.iteration, finer)) return std::nullopt;
    return finer;
  };
  const std::optional<Path> finest = found(2 * rest_limits::finer_by);
  std::optional<Path> finer = found(rest_limits::finer_by);
  if (!finest || !finer || finest->degree() == finer->degree()) return std::nullopt;
  const double T = path_.duration();
  const Trajectory there = trajectory_of(*finer);
  std::vector<double> v(path_.coordinates());
  fill_path(ends_, refinement_.tables(), path_, [&](double tau, double* q) {
    there.at(std::min(tau, 1.0) * T, {q, v.size()}, v);
  });
  const double change = largest_change(*finer, *finest);
  return Placed{*std::move(finer), change};
}

/// A path between equilibria that its ends hardly hold in time: converged across its shifts first, then
/// shifted to where the action of all rests is least, and tried without or, where roundoff hides their
/// energy, with its shifts held.
bool Search::held_in_time(const char* strategy, const std::function<void()>& renew) {
  Acceptance* const acceptance = std::exchange(acceptance_, nullptr);
  const auto again = [&](bool held) {
    renew();
    refinement_.take(refinement_.tables());
    outcome_.shifts_held = held;
    refinement_.rebind();
    if (!held) refinement_.move_nodes();
    return found(strategy);
  };
  // Linear elements hold a path where their errors exceed the energies of rests.
  if (const Balance rough(problem_, path_); rough.exists() && !rough.falls()) rough.apply(path_);
  bool balance_found = false;
  double energy = INFINITY, shift = INFINITY;
  for (int pass = 0; pass < rest_limits::most_balances; ++pass) {
    again(true);  // where the balance is far off, elements may disagree
    if (w_.iteration.held_shifts() == 0) break;
    const Balance balance(problem_, path_, Balance::Accuracy::extrapolated);
    energy = balance.energy();
    shift = balance.largest_shift();
    balance_found = balance.exists() && !balance.falls();
    outcome_.shift_error = balance.error();
    if (!balance_found || !balance.apply(path_) || shift < rest_limits::balanced) break;
  }
  acceptance_ = acceptance;
  if (!balance_found) {
    outcome_.shifts_held = false;
    return false;
  }
  if (energy > rest_limits::loose) {
    const Path balanced_path = path_;
    const ElementTables& tables = refinement_.tables();
    if (again(false)) return true;
    path_ = balanced_path;
    refinement_.take(tables);
    refinement_.move_nodes();
    refinement_.keep_mesh();
    refinement_.set_digits(Refinement::Digits::doubled_where_lost);
    if (found(strategy)) return true;
    // What holds it beyond roundoff may still be too weak for the tolerance.
    path_ = balanced_path;
    refinement_.take(tables);
  }
  const double range = scales(path_, refinement_.tables()).range;
  // Elements err in energies by about the square of their error.
  const double part = outcome_.error / range;
  renew();
  if (const std::optional<Placed> placed = energy > std::max(rest_limits::least_resolved, part * part)
                                               ? moved_with_more_digits()
                                               : std::nullopt) {
    acceptance_ = nullptr;
    again(true);  // elements of its own degree shift it a little
    acceptance_ = acceptance;
    outcome_.shift_error = placed->change + largest_change(path_, placed->path);
  } else {
    outcome_.shift_error += displaced_by_finer_elements();
  }
  // Beside the largest energy of a rest, as those have that paths turn about, its length holds nothing.
  const bool known =
      shift <= rest_limits::most_error && outcome_.shift_error <= rest_limits::most_error * range;
  const bool result = known && again(true);
  outcome_.shifts_held = result;
  return result;
}

}  // namespace extremal
