#include "solve/search/near_guess.hpp"

#include "solve/search/limits.hpp"
#include "solve/search/on_family.hpp"

namespace extremal {

namespace {

/// Of infinite duration: steps may leave open more than a shift in time, which is that of a family.
bool joins_family(Pursuit& pursuit, const GuessMesh& guess, bool converged) {
  int steps = limits::continuum::most_steps_in_all;
  return (!converged || leaves_open(pursuit)) &&
         reach_nearest_member(pursuit, guess, converged, steps) == FamilySearch::found;
}

}  // namespace

const Outcome& pursue_near_guess(Pursuit& pursuit, GuessMesh& guess) {
  if (guess.prepare(pursuit) == GuessMesh::Kind::undefined) return pursuit.unless_spent();
  const Problem& problem = pursuit.problem;
  Outcome& outcome = pursuit.outcome;
  // Between fixed ends a path may well be at rest.
  if (problem.ends.free > 0) outcome.first_range = scales(pursuit.path, pursuit.tables()).range;
  Pursuit::Result end = guess.pursue(pursuit, newton_from_guess);
  if (problem.infinite && joins_family(pursuit, guess, end.converged()))
    end.result = Refinement::Result::converged;
  outcome.hidden = end.result == Refinement::Result::unreachable && !end.doubtful;
  if (end.converged() && !outcome.elsewhere) outcome.status = Status::converged;
  return outcome;
}

}  // namespace extremal
