#include "solve/search/on_family.hpp"

#include <algorithm>
#include <cmath>

#include "solve/search/balance.hpp"
#include "solve/search/family.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

namespace {

/// Extremals between ends, and orbits that neither a shift in time nor a symmetry moves: null directions are
/// then those of a family.
bool may_be_family(const Problem& problem) {
  if (problem.has_ends()) return true;
  return problem.periodic && !problem.lagrangian->structure().autonomous && problem.symmetries.empty() &&
         !problem.paired;
}

/// A shift between rests that changes the action by less than roundoff makes no family. From rest to rest in
/// infinite time it is a symmetry.
bool is_shift_alone(const Pursuit& pursuit) {
  const Problem& problem = pursuit.problem;
  return problem.infinite ? pursuit.outcome.family <= problem.shifts_in_time()
                          : Balance(problem, pursuit.path).exists();
}

struct Ways {
  bool found = false;
  bool none = false;  ///< along one of them a force remains that no step removes
};

/// From the guess, which may be a member, or near one; so may the path that was found. Where that is an
/// extremal, its elements resolve both.
Ways from_guess_or_path(Pursuit& pursuit, const GuessMesh& guess, bool resolved, int& steps_left) {
  const Problem& problem = pursuit.problem;
  const Path path_found = pursuit.path;
  const auto fill = [&](const ElementTables& tables, const std::vector<double>& mesh, Path& path) {
    path.reset(tables, mesh, problem.duration.value);
    guess.fill(guess.bend(), tables, path);
  };
  const auto resample = [&](const ElementTables& tables, const std::vector<double>& mesh, Path& path) {
    path.resample_from(path_found, tables, mesh);
  };
  const auto count = [&] {
    pursuit.count_step();
    return --steps_left > 0 && !pursuit.options.deadline.passed();
  };
  Ways ways;
  const auto from = [&](const std::vector<double>& mesh, const FillGuess& start) {
    const FamilySearch result =
        nearest_of_family(problem, pursuit.options, pursuit.w, mesh, fill, start, count, pursuit.outcome);
    ways.none = ways.none || result == FamilySearch::none;
    return result == FamilySearch::found;
  };
  const bool finite = std::ranges::all_of(path_found.nodes(), [](double x) { return std::isfinite(x); });
  const std::vector<double> mesh(path_found.mesh().begin(), path_found.mesh().end());
  ways.found = !finite    ? from(guess.mesh(), fill)
               : resolved ? from(mesh, fill) || from(mesh, resample)
                          : from(mesh, resample) || from(guess.mesh(), fill);
  return ways;
}

}  // namespace

FamilySearch reach_nearest_member(Pursuit& pursuit, const GuessMesh& guess, bool resolved, int& steps_left) {
  const Problem& problem = pursuit.problem;
  if (problem.duration.free || (!problem.infinite && !may_be_family(problem)) ||
      problem.lagrangian->kinks() || pursuit.tables().unknowns() > most_dense_unknowns)
    return FamilySearch::not_reached;
  Outcome& outcome = pursuit.outcome;
  const std::string failure = outcome.message;
  outcome.strategy = "newton across a family from the guess";
  outcome.elsewhere = false;
  const Ways ways = from_guess_or_path(pursuit, guess, resolved, steps_left);
  if (ways.found && !is_shift_alone(pursuit)) {
    outcome.status = Status::converged;
    if (!pursuit.acceptance() || pursuit.judge() == Refinement::Result::converged) return FamilySearch::found;
  }
  outcome.family = 0;
  outcome.status = Status::not_converged;
  outcome.strategy = newton_from_guess;
  outcome.message = failure;
  pursuit.refinement.rebind();
  return ways.none ? FamilySearch::none : FamilySearch::not_reached;
}

void come_nearest_to_guess(Pursuit& pursuit, const GuessMesh& guess) {
  const Problem& problem = pursuit.problem;
  const Acceptance* const acceptance = pursuit.acceptance();
  if (!acceptance || acceptance->nullity() == 0 || !may_be_family(problem) || problem.manifold ||
      problem.phase || pursuit.outcome.shifts_held)
    return;
  const Outcome accepted = pursuit.outcome;
  int steps = limits::continuum::most_steps_in_all;
  if (reach_nearest_member(pursuit, guess, true, steps) == FamilySearch::found) return;
  pursuit.outcome = accepted;
  pursuit.refinement.rebind();
}

bool leaves_open(Pursuit& pursuit) {
  const auto count = [&] { return pursuit.count_step(); };
  ExtremalFamily family(pursuit.problem, count);
  family.reset(pursuit.tables(), pursuit.path);
  const bool known = family.find_null(pursuit.path, limits::continuum::null_eigenvalue);
  pursuit.refinement.rebind();
  return known && family.null_directions() > pursuit.problem.shifts_in_time();
}

}  // namespace extremal
