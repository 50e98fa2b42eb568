#include "solve/bordered/bordered_judge.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "problem/closing.hpp"
#include "problem/point_range.hpp"
#include "problem/symmetry.hpp"
#include "solution/extension_values.hpp"
#include "solution/observe.hpp"
#include "solve/accept/conditions.hpp"
#include "solve/accept/minimality.hpp"
#include "solve/accept/symmetries.hpp"
#include "solve/bordered/bordered_newton.hpp"
#include "solve/bordered/dependence.hpp"
#include "solve/bordered/limits.hpp"
#include "solve/mesh/conservation.hpp"
#include "solve/periodic/equilibrium.hpp"
#include "solve/periodic/moving_symmetries.hpp"
#include "solve/periodic/stability.hpp"

namespace extremal {

using namespace limits::bordered;

namespace {

Solution refused(std::string message) {
  Solution solution;
  solution.message = std::move(message);
  return solution;
}

std::shared_ptr<const ExtensionValues> read_extension_values(const Problem& problem,
                                                             const BorderedEquations& equations,
                                                             const BorderedState& state) {
  const Extension& extension = *problem.extension;
  const std::vector<double> constants = state.constants(problem.coordinates());
  auto values = std::make_shared<ExtensionValues>();
  for (int k = 0; k < extension.unknowns(); ++k)
    values->unknowns.emplace_back(extension.names[k], constants[k]);
  values->integral_multipliers.assign(constants.begin() + extension.unknowns(), constants.end());
  for (std::size_t w = 0; w < extension.waypoints.size(); ++w) {
    WaypointImpulse& impulse = values->waypoints.emplace_back();
    impulse.time = state.times[w];
    for (const auto& [a, value] : extension.waypoints[w].fixed)
      impulse.impulse.emplace_back(a, -equations.node_gradient(state.mesh.first[w + 1], a));
  }
  values->lagrangian = extension.at(constants);
  if (extension.manifold_at) values->manifold = extension.manifold_at(constants);
  return values;
}

/// What is wrong with conditions that should follow from the others and from constraints; empty: nothing.
std::string missed_condition(const Problem& problem, const BorderedState& state) {
  const std::size_t n = problem.coordinates(), all = n + problem.extension->constants();
  const std::vector<double> constants = state.constants(static_cast<int>(n));
  const Trajectory path = trajectory_of(state.path);
  std::vector<double> start(all), end(all), v(all), gradient(2 * all);
  path.at(0, start, v);
  path.at(path.duration(), end, v);
  for (const ImpliedCondition& implied : problem.extension->implied) {
    const double missed = implied.condition.function(start, end, gradient, {});
    double size = 1;
    for (std::size_t e = 0; e < 2 * all; ++e)
      size = std::max(size, std::abs(gradient[e] * (e < all ? start[e] : end[e - all])));
    if (!(std::abs(missed) <= largest_implied * size))
      return fmt::format(
          "'{}' is missed by {:.3g}: the constraints and what else is given at the ends determine what it "
          "says; leave it out, or leave out another condition",
          implied.text, missed);
  }
  return {};
}

/// Between waypoints the momenta of L + Σ ν g are continuous along the elements, and its energy is.
std::optional<Refusal> legs_fail(const Problem& problem, const SolveOptions& options,
                                 const BorderedState& state, const Trajectory& path,
                                 const Solution& solution) {
  const Lagrangian& lagrangian = *solution.extension->lagrangian;
  const bool rests = path_size(state, problem.coordinates()).rests,  // energies there are roundoff
      conserved = lagrangian.structure().autonomous && !problem.paired && !options.scheme && !rests;
  for (int l = 0; l < state.mesh.legs(); ++l) {
    const int first = state.mesh.first[l], last = state.mesh.first[l + 1];
    if (auto fails = has_broken_node(problem, lagrangian, path, first, last)) return fails;
    if (!conserved) continue;
    const Trajectory leg = leg_of(path, state.mesh, l);
    const Survey found = survey(lagrangian, leg);
    if (found.finite && !conserves_energy(found, leg, options.tolerance))
      return energy_drifts(found.energy_drift, options.tolerance);
  }
  return std::nullopt;
}

/// Windows of each leg, and times conjugate to its start. None where L depends on t: legs begin at other
/// times.
void read_legs(const Problem& held, const SolveOptions& options, const BorderedState& state,
               Solution& solution) {
  if (!held.lagrangian->structure().autonomous) {
    solution.message += "; windows are not found between waypoints where L depends on t";
    return;
  }
  SecondVariation variation;
  Solution whole = solution;
  whole.conjugate_times_known = true;
  for (int l = 0; l < state.mesh.legs(); ++l) {
    const double start = l > 0 ? state.times[l - 1] : 0;
    Solution leg = solution;
    leg.trajectory = leg_of(solution.trajectory, state.mesh, l);
    read_minimality(held, options, variation, leg);
    if (leg.windows.empty()) {
      solution.message = leg.message;
      if (!leg.morse_index) {
        solution.morse_index.reset();
        solution.minimizing = false;
      }
      return;
    }
    for (const auto& [from, to] : leg.windows) whole.windows.push_back({start + from, start + to});
    whole.windows.back()[1] = state.times[l];
    for (const double t : leg.conjugate_times) whole.conjugate_times.push_back(start + t);
    whole.conjugate_times_known = whole.conjugate_times_known && leg.conjugate_times_known;
    whole.certificate = leg.certificate;
  }
  solution = std::move(whole);
}

/// What a condition on the ends, with the gradient over (q(0), q(T)), is for each symmetry at a path.
Eigen::RowVectorXd along_symmetries(const std::vector<Generator>& symmetries, const Eigen::VectorXd& start,
                                    const Eigen::VectorXd& end, const Eigen::VectorXd& by_start,
                                    const Eigen::VectorXd& by_end) {
  const Eigen::Index n = start.size();
  Eigen::RowVectorXd row(std::ssize(symmetries));
  for (Eigen::Index s = 0; s < row.size(); ++s) {
    const Eigen::Map<const Eigen::MatrixXd> transposed(symmetries[s].matrix.data(), n, n);
    const Eigen::Map<const Eigen::VectorXd> shift(symmetries[s].shift.data(), n);
    row[s] = by_start.dot(transposed.transpose() * start + shift) +
             by_end.dot(transposed.transpose() * end + shift);
  }
  return row;
}

/// The continuous symmetries of L + Σ ν g that keep the relation, conditions and waypoints.
std::vector<Generator> symmetries_of(const Problem& held, const BorderedState& state,
                                     const Trajectory& path) {
  const std::vector<Generator> all = symmetries_about(held, path);
  if (all.empty()) return {};
  const Extension& extension = *held.extension;
  const int n = held.coordinates(), whole = n + extension.constants();
  const std::vector<double> constants = state.constants(n);
  Eigen::VectorXd start(whole), end(whole), v(n), gradient(2 * whole);
  const auto at = [&](double t, Eigen::VectorXd& q) {
    path.at(t, {q.data(), static_cast<std::size_t>(n)}, {v.data(), static_cast<std::size_t>(n)});
    std::ranges::copy(constants, q.begin() + n);
  };
  at(0, start);
  at(path.duration(), end);
  std::vector<Eigen::RowVectorXd> rows;
  for (const EndCondition& condition : extension.conditions) {
    condition.function({start.data(), start.data() + whole}, {end.data(), end.data() + whole},
                       {gradient.data(), gradient.data() + 2 * whole}, {});
    const double size = gradient.norm();
    rows.push_back(along_symmetries(all, start.head(n), end.head(n), gradient.head(n) / size,
                                    gradient.segment(whole, n) / size));
  }
  for (std::size_t w = 0; w < extension.waypoints.size(); ++w) {
    at(state.times[w], end);
    for (const auto& [a, value] : extension.waypoints[w].fixed)
      rows.push_back(along_symmetries(all, start.head(n), end.head(n), Eigen::VectorXd::Zero(n),
                                      Eigen::VectorXd::Unit(n, a)));
  }
  Eigen::MatrixXd values(std::ssize(rows), std::ssize(all));
  for (Eigen::Index r = 0; r < values.rows(); ++r) values.row(r) = rows[r];
  return symmetries_that_keep(values, all);
}

/// The path without constants, and the scheme of its elements if they are pinned.
struct ElementsOfPath {
  const Path& path;
  double size;
  const SchemeTables* pinned;
};

/// Multipliers, by a second variation that is assembled; of pinned elements by their own.
void read_multipliers(const Problem& held, const ElementsOfPath& elements, SecondVariation& variation,
                      Solution& solution) {
  ElementTables tables;
  if (held.periodic && elements.pinned) {
    tables.bind(*elements.pinned, *held.lagrangian);
    const ClosingMap closed = closing_map(held);
    variation.assemble_elements(held.lagrangian, solution.trajectory, elements.path, tables, &closed);
  }
  read_stability(held, variation, elements.size, solution);
}

/// With forces there is no second variation, but the orbit has multipliers.
void read_forced_stability(const Problem& held, const BorderedState& state, const ElementsOfPath& elements,
                           Solution& solution) {
  if (!held.periodic || state.mesh.legs() > 1) return;
  SecondVariation variation;
  variation.assemble(held.lagrangian, solution.trajectory, {}, nullptr, Definite::paired);
  read_multipliers(held, elements, variation, solution);
}

/// Windows, conjugate times and multipliers of L + Σ ν g with all constants held; with waypoints leg by leg.
void read_variation(const Problem& problem, const SolveOptions& options, const BorderedState& state,
                    const ElementsOfPath& elements, Solution& solution) {
  Problem held = problem;
  held.lagrangian = solution.extension->lagrangian;
  held.duration.value = state.times.back();
  if (problem.paired) return read_forced_stability(held, state, elements, solution);
  if (state.mesh.legs() > 1) {
    held.periodic = false;  // legs are not closed
    return read_legs(held, options, state, solution);
  }
  SecondVariation variation;
  const std::optional<int> index = solution.morse_index;
  const bool minimizing = solution.minimizing;
  read_minimality(held, options, variation, solution);
  // Integrals and conditions take directions from the index, which conjugate times do not.
  if (solution.morse_index) {
    solution.morse_index = index;
    solution.minimizing = minimizing;
  }
  read_multipliers(held, elements, variation, solution);
}

/// The largest difference at a node.
double node_distance(const BorderedState& a, const BorderedState& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.path.nodes().size(); ++i)
    largest = std::max(largest, std::abs(a.path.nodes()[i] - b.path.nodes()[i]));
  return largest;
}

/// Whether there are solutions after a finite step along a null direction to either side.
bool goes_on(BorderedEquations& equations, const BorderedState& state, const Eigen::VectorXd& direction,
             const Deadline& deadline) {
  const auto is_solution_beside = [&](double step) {
    BorderedState moved = state;
    if (!equations.apply(moved, direction, step)) return false;
    BorderedState beside = moved;
    const auto spent = [&] { return deadline.passed(); };
    return converge(equations, beside, spent, [](double, double) {}).converged &&
           equations.residual() <= largest_residual && equations.mismatch() <= largest_mismatch &&
           node_distance(beside, moved) <= most_pull_back * node_distance(moved, state);
  };
  return is_solution_beside(family_step) && is_solution_beside(-family_step);
}

/// Conditions may leave a continuum of solutions, and constants open with it; conjugate legs another.
void tell_continuum(const Problem& problem, const SolveOptions& options, BorderedEquations& equations,
                    BorderedState state, Solution& solution) {
  const Freedom freedom = freedom_of(equations, state);
  // Of two copies both the motion and the adjoint field have each direction.
  const int count = problem.paired ? (freedom.count() + 1) / 2 : freedom.count();
  if (count == 0) return;
  std::vector<std::string> open;
  for (std::size_t k = 0; k < freedom.moves.size(); ++k)
    if (freedom.moves[k]) open.push_back(fmt::format("'{}'", problem.extension->names[k]));
  const char* plural = count > 1 ? "s" : "";
  if (!open.empty()) {
    solution.message += fmt::format(
        "; solutions beside this one meet the conditions as well, in {} direction{}: they do not "
        "determine {}, and this is one of a continuum near the guess; another condition selects one",
        count, plural, fmt::join(open, ", "));
  } else if (problem.periodic) {
    solution.message += one_of_a_continuum(count);
  } else if (solution.message.find(family_of_symmetries) == std::string::npos) {
    for (int j = 0; j < count; ++j)
      if (!goes_on(equations, state, freedom.directions.col(j), options.deadline)) return;
    solution.message += fmt::format(
        "; the ends or the waypoints are conjugate, and this is one of a family of extremals, in {} "
        "direction{}, near the guess",
        count, plural);
  }
}

}  // namespace

std::string residual_remains(double residual) {
  return fmt::format(
      "a residual of {:.1e} of the largest momentum remains: there is no extremal near; try "
      "another guess",
      residual);
}

Solution judge(const Problem& problem, const SolveOptions& options, BorderedEquations& equations,
               const Found& found, const Measured& measured) {
  const BorderedState& state = found.state;
  const double size = path_size(state, problem.coordinates()).value;
  if (!equations.evaluate(state, true)) return refused("the action is not finite along the path found");
  const double stretched = state.times.back() / problem.duration.value;
  if (!(size < most_growth * state.size_of_start) || !(stretched < most_growth))
    return refused("the path ran away from the guess; try another guess");
  // In no time all momenta are large, and what conditions leave is small beside them.
  if (!(stretched > 1 / most_growth))
    return refused("the duration shrinks to nothing: there is no extremal near; try another guess");
  if (!(equations.residual() <= largest_residual)) return refused(residual_remains(equations.residual()));
  if (!(equations.mismatch() <= largest_mismatch))
    return refused(
        std::isfinite(equations.mismatch())
            ? fmt::format("the conditions are missed by {:.1e}; try another guess", equations.mismatch())
            : "the conditions are not finite on the path found; try another guess");
  if (std::string fault = missed_condition(problem, state); !fault.empty()) return refused(std::move(fault));
  const double energy = equations.momentum() * size / state.times.back();
  if (!(equations.energy_jump() <=
        largest_residual * std::max(energy, std::abs(problem.duration.energy.value_or(0)))))
    return refused(fmt::format("the energy at a free time is missed by {:.1e}; try another guess",
                               equations.energy_jump()));
  if (std::string fault = dependence(equations, state, options.tolerance * size); !fault.empty())
    return refused(std::move(fault));
  if (!equations.evaluate(state, true)) return refused("the action is not finite along the path found");
  Solution solution;
  solution.status = Status::converged;
  solution.message = "converged";
  solution.extension = read_extension_values(problem, equations, state);
  const Path path = found.own_path();
  const Trajectory elements = trajectory_of(path);
  const auto range = [&](const std::vector<double>& q) { return largest_range(q, problem.coordinates()); };
  if (problem.periodic && shrank(problem, range(elements.nodes), range(problem.guess.q)))
    return refused(fmt::format("{}; try a larger guess or another duration", shrank_to_rest));
  solution.trajectory = measured.recovered ? trajectory_of(*measured.recovered) : elements;
  if (problem.paired)
    if (const std::optional<Refusal> fails = copies_differ(solution.trajectory, size))
      return refused(fails->message);
  const DiscreteAction& action = equations.action();
  const Extension& extension = *problem.extension;
  solution.action = action.action();
  for (int j = 0; j < extension.multipliers(); ++j)
    solution.action -= solution.extension->integral_multipliers[j] * extension.integrals[j];
  for (int a = 0; a < problem.coordinates(); ++a) {
    solution.momentum_start.push_back(-action.start_gradient()[a]);
    solution.momentum_end.push_back(action.end_gradient()[a]);
  }
  solution.residual = equations.residual();
  solution.error_estimate = measured.error;
  solution.degree = path.degree();
  solution.unknowns = equations.first_held();
  const Inertia inertia = equations.inertia();
  solution.morse_index = inertia.negative;
  solution.nullity = inertia.zero;
  solution.minimizing = inertia.negative == 0 && (inertia.zero == 0 || problem.periodic);
  observe_energy(*solution.extension->lagrangian, solution);
  if (const auto fails = legs_fail(problem, options, state, elements, solution))
    return refused(fails->message);
  if (inertia.negative == 0 && inertia.zero > 0 && !problem.periodic && !problem.paired &&
      problem.boundary.momenta.empty() && extension.end_terms.empty()) {
    Problem held = problem;
    held.lagrangian = solution.extension->lagrangian;
    held.duration.value = state.times.back();
    const std::vector<Generator> symmetries = symmetries_of(held, state, solution.trajectory);
    if (moving_symmetries(symmetries, solution.trajectory, false) >= inertia.zero) {
      solution.minimizing = true;
      solution.message += family_of_symmetries;
    }
  }
  const SchemeTables& scheme = found.own->scheme();
  const SchemeTables* pinned = options.elements > 0 ? &scheme : nullptr;
  read_variation(problem, options, state, {path, size, pinned}, solution);
  tell_continuum(problem, options, equations, state, solution);
  solution.pinned = options.scheme.has_value();
  if (solution.pinned)
    solution.element_energies =
        element_energies(*solution.extension->lagrangian, scheme.node, scheme.weight, elements);
  return solution;
}

}  // namespace extremal
