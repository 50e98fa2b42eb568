#include "solve/search/held_in_time.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "solve/adapt/finer_elements.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/newton/converge.hpp"
#include "solve/newton/resolve.hpp"
#include "solve/search/balance.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

namespace rest_limits = limits::balance;

namespace {

struct Placed {
  Path path;
  double change;  ///< of q, absolute
};

/// Of q, absolute: what elements of a higher degree change of the shifts for which energies agree.
double displaced_by_finer_elements(Pursuit& pursuit) {
  Path& finer =
      on_finer_elements(pursuit.problem, pursuit.path, pursuit.tables(), rest_limits::finer_by, pursuit.w);
  pursuit.w.iteration.hold_shifts(true);
  const NewtonReport report =
      converge(pursuit.w.iteration, finer, pursuit.w.levels.at(finer.degree()),
               {.steps = rest_limits::finer_steps}, [&] { return pursuit.count_step(); });
  if (!report.reached) return INFINITY;
  const Balance balance(pursuit.problem, finer, Balance::Accuracy::extrapolated);
  return balance.exists() ? balance.displacement() : INFINITY;
}

/// Moves the path to where 106 bits know it, on elements of a higher degree. Returns it on these, and what
/// those of a still higher one change of it; nothing where it is not isolated.
std::optional<Placed> moved_with_more_digits(Pursuit& pursuit, const std::vector<double>& ends) {
  const auto found = [&](int by) -> std::optional<Path> {
    Path finer = on_finer_elements(pursuit.problem, pursuit.path, pursuit.tables(), by, pursuit.w);
    if (!pursuit.refinement.count_step() || !resolve(pursuit.w.iteration, finer)) return std::nullopt;
    return finer;
  };
  const std::optional<Path> finest = found(2 * rest_limits::finer_by);
  std::optional<Path> finer = found(rest_limits::finer_by);
  if (!finest || !finer || finest->degree() == finer->degree()) return std::nullopt;
  const double T = pursuit.path.duration();
  const Trajectory there = trajectory_of(*finer);
  std::vector<double> v(pursuit.path.coordinates());
  fill_path(ends, pursuit.tables(), pursuit.path, [&](double tau, double* q) {
    there.at(std::min(tau, 1.0) * T, {q, v.size()}, v);
  });
  const double change = largest_change(*finer, *finest);
  return Placed{*std::move(finer), change};
}

}  // namespace

bool hold_in_time(Pursuit& pursuit, const std::vector<double>& ends, const char* strategy,
                  const std::function<void()>& renew) {
  Acceptance* const acceptance = pursuit.judge_by(nullptr);
  const auto again = [&](bool held) {
    renew();
    pursuit.refinement.take(pursuit.tables());
    pursuit.outcome.shifts_held = held;
    pursuit.refinement.rebind();
    if (!held) pursuit.refinement.move_nodes();
    return pursuit.found(strategy);
  };
  // Linear elements hold a path where their errors exceed the energies of rests.
  if (const Balance rough(pursuit.problem, pursuit.path); rough.exists() && !rough.falls())
    rough.apply(pursuit.path);
  bool balance_found = false;
  double energy = INFINITY, shift = INFINITY;
  for (int pass = 0; pass < rest_limits::most_balances; ++pass) {
    again(true);  // where the balance is far off, elements may disagree
    if (pursuit.w.iteration.held_shifts() == 0) break;
    const Balance balance(pursuit.problem, pursuit.path, Balance::Accuracy::extrapolated);
    energy = balance.energy();
    shift = balance.largest_shift();
    balance_found = balance.exists() && !balance.falls();
    pursuit.outcome.shift_error = balance.error();
    if (!balance_found || !balance.apply(pursuit.path) || shift < rest_limits::balanced) break;
  }
  pursuit.judge_by(acceptance);
  if (!balance_found) {
    pursuit.outcome.shifts_held = false;
    return false;
  }
  if (energy > rest_limits::loose) {
    const Path balanced_path = pursuit.path;
    const ElementTables& tables = pursuit.tables();
    if (again(false)) return true;
    pursuit.path = balanced_path;
    pursuit.refinement.take(tables);
    pursuit.refinement.move_nodes();
    pursuit.refinement.keep_mesh();
    pursuit.refinement.set_digits(Refinement::Digits::doubled_where_lost);
    if (pursuit.found(strategy)) return true;
    // What holds it beyond roundoff may still be too weak for the tolerance.
    pursuit.path = balanced_path;
    pursuit.refinement.take(tables);
  }
  const double range = scales(pursuit.path, pursuit.tables()).range;
  // Elements err in energies by about the square of their error.
  const double part = pursuit.outcome.error / range;
  renew();
  if (const std::optional<Placed> placed = energy > std::max(rest_limits::least_resolved, part * part)
                                               ? moved_with_more_digits(pursuit, ends)
                                               : std::nullopt) {
    pursuit.judge_by(nullptr);
    again(true);  // elements of its own degree shift it a little
    pursuit.judge_by(acceptance);
    pursuit.outcome.shift_error = placed->change + largest_change(pursuit.path, placed->path);
  } else {
    pursuit.outcome.shift_error += displaced_by_finer_elements(pursuit);
  }
  // Beside the largest energy of a rest, as those have that paths turn about, its length holds nothing.
  const bool known =
      shift <= rest_limits::most_error && pursuit.outcome.shift_error <= rest_limits::most_error * range;
  const bool result = known && again(true);
  pursuit.outcome.shifts_held = result;
  return result;
}

}  // namespace extremal
