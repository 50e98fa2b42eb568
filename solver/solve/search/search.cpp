#include "solve/search/search.hpp"

#include <fmt/format.h>

#include <cstddef>

#include "solve/adapt/others_to_try.hpp"
#include "solve/periodic/equilibrium.hpp"
#include "solve/search/by_homotopy.hpp"
#include "solve/search/from_motions.hpp"
#include "solve/search/from_other_ends.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/near_guess.hpp"
#include "solve/search/on_family.hpp"
#include "solve/search/other_guesses.hpp"

namespace extremal {

Search::Search(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem), pursuit_(problem, options, workspace), guess_(problem), flow_(pursuit_, guess_) {}

const Outcome& Search::run_near_guess() { return pursue_near_guess(pursuit_, guess_); }

/// Newton's method from the guess, and across a family that it may be near.
Search::End Search::from_guess() {
  const Pursuit::Result first = guess_.pursue(pursuit_, newton_from_guess);
  End end{first.result, first.doubtful, false};
  if (end.converged()) {
    come_nearest_to_guess(pursuit_, guess_);
    return end;
  }
  // What the path before has spent does not count.
  int steps = limits::continuum::most_steps_in_all;
  const FamilySearch family = reach_nearest_member(pursuit_, guess_, false, steps);
  if (family == FamilySearch::found) return {Refinement::Result::converged, false, false};
  end.no_family = family == FamilySearch::none;
  return end;
}

/// Between rests roundoff hides where an extremal is, from Newton's method alone.
bool Search::from_hidden() {
  const Outcome hidden = pursuit_.outcome;
  pursuit_.refinement.allow(pursuit_.allowance());
  if (flow_.run()) return true;
  pursuit_.outcome = hidden;
  pursuit_.refinement.rebind();
  return false;
}

/// Cheapest first; but where the user has given a guess, paths near it before noise.
bool Search::by_other_starts(GuessMesh::Kind kind, std::set<Route>& tried) {
  NoisyGuesses noisy;
  const auto by = [&](Route route, Trial trial) {
    if (trial != Trial::none) tried.insert(route);
    return trial == Trial::found;
  };
  const auto by_noise = [&](unsigned tries) { return by(Route::noise, noisy.run(pursuit_, guess_, tries)); };
  const bool given = problem_.guess.given();
  if (pursuit_.options.deadline.passed()) return false;
  if (kind == GuessMesh::Kind::colliding && by_noise(limits::search::collision_noises)) return true;
  if (from_resolved_guess(pursuit_, guess_)) return true;
  if (by_descent(pursuit_, guess_, guess_.mesh())) return true;
  if (flow_.run()) return true;
  if (from_finer_elements(pursuit_, guess_)) return true;
  if (from_settled_motion(pursuit_, guess_)) return true;
  if (!given && by_noise(limits::search::first_noises)) return true;
  if (by(Route::other_durations, through_other_durations(pursuit_, guess_))) return true;
  if (from_line(pursuit_, guess_)) return true;
  if (by(Route::other_ends, through_other_ends(pursuit_, guess_.ends()))) return true;
  const int kept = steps_for_weaker_forces(pursuit_);
  guess_.begin(pursuit_);
  pursuit_.refinement.keep(kept);
  if (by_noise(limits::search::most_noises)) return true;
  guess_.begin(pursuit_);
  if (by(Route::motions, from_motions(pursuit_, guess_, kept))) return true;
  // What it finds may be far.
  return by(Route::weaker_forces, through_weaker_forces(pursuit_, guess_));
}

bool Search::from_others(GuessMesh::Kind kind) {
  const std::string failure = pursuit_.outcome.message;
  if (kind == GuessMesh::Kind::colliding) pursuit_.refinement.allow(pursuit_.allowance());
  std::set<Route> tried;
  if (by_other_starts(kind, tried)) return true;
  report_failure(failure, tried);
  pursuit_.return_to_unheld();
  return false;
}

void Search::report_failure(const std::string& failure, const std::set<Route>& tried) {
  constexpr const char* texts[] = {", through other durations", ", through other ends", ", from smooth noise",
                                   ", from motions that miss the end", ", through weaker forces"};
  Outcome& outcome = pursuit_.outcome;
  if (pursuit_.met_equilibrium()) {
    outcome.status = Status::no_solution_near;
    outcome.message = fmt::format("{} from the guess and from others; try {}", shrank_to_rest,
                                  others_to_try(problem_, "a larger guess", "another duration"));
    return;
  }
  std::string routes;
  for (const Route route : tried) routes += texts[static_cast<std::size_t>(route)];
  outcome.status = Status::iteration_limit;
  outcome.message =
      fmt::format("{} Newton steps from the guess ({}){} found no extremal; try {}", outcome.iterations,
                  failure, routes, others_to_try(problem_, "a better guess", "a shorter duration"));
}

/// Where the second variation is singular, and nothing was found.
void Search::report_singular(const End& end) {
  Outcome& outcome = pursuit_.outcome;
  if ((end.doubtful || end.no_family) && problem_.has_ends()) {
    outcome.status = Status::conjugate_ends;
    outcome.message =
        end.no_family
            ? "the ends are conjugate along a path near the guess: its second variation is singular, and a "
              "force along its null directions remains that no step removes, so that there is neither an "
              "extremal nor a family of them near; move an end, change the duration, or try another guess"
            : "the second variation is singular or nearly so: the ends may be conjugate: there may be no "
              "extremal, or a whole family of them; move an end or change the duration";
  }
  if (end.no_family && problem_.periodic) {
    outcome.status = Status::no_solution_near;
    outcome.message =
        "the second variation is singular, or nearly so, along a path near the guess, and a force along its "
        "null directions remains: what drives the motion is in resonance, and no orbit of this period is "
        "found near, nor a family of them; change the duration or the force, or try a better guess";
  }
}

const Outcome& Search::run(Acceptance* acceptance) {
  const GuessMesh::Kind kind = guess_.prepare(pursuit_);
  if (kind == GuessMesh::Kind::undefined) return pursuit_.unless_spent();
  pursuit_.judge_by(acceptance);
  End end = from_guess();
  const bool may_hide = !problem_.guess.given() && problem_.has_ends();
  if (end.result == Refinement::Result::unreachable && may_hide && from_hidden())
    end.result = Refinement::Result::converged;
  if (end.result == Refinement::Result::failed && from_others(kind))
    end.result = Refinement::Result::converged;
  if (end.converged())
    pursuit_.outcome.status = Status::converged;
  else
    report_singular(end);
  pursuit_.judge_by(nullptr);
  return pursuit_.unless_spent();
}

}  // namespace extremal
