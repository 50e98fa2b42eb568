#include "solve/search/by_homotopy.hpp"

#include <algorithm>

#include "solve/homotopy/duration_homotopy.hpp"
#include "solve/homotopy/force_homotopy.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

Trial through_other_durations(Pursuit& pursuit, const GuessMesh& guess) {
  const Problem& problem = pursuit.problem;
  if (pursuit.exhausted() || problem.duration.free || problem.paired || problem.infinite ||
      !problem.lagrangian->structure().autonomous)
    return Trial::none;
  const auto count = [&] { return pursuit.count_step(); };
  guess.start(pursuit, limits::search::homotopy_degree);
  DurationHomotopy homotopy(problem, pursuit.path, pursuit.w, count);
  Trial trial = Trial::none;
  for (const double duration : natural_durations(problem, pursuit.path, pursuit.w, pursuit.tables())) {
    guess.start(pursuit, limits::search::homotopy_degree);
    pursuit.path.set_duration(duration);
    trial = Trial::in_vain;
    if (!homotopy.trace(pursuit.tables())) continue;
    pursuit.refinement.rebind();
    if (pursuit.found("homotopy in the duration")) return Trial::found;
  }
  return trial;
}

int steps_for_weaker_forces(const Pursuit& pursuit) {
  const Problem& problem = pursuit.problem;
  const bool suits = !problem.duration.free && !problem.paired && !problem.infinite && !problem.phase &&
                     !problem.manifold && problem.has_ends() && !problem.lagrangian->kinks();
  return suits ? static_cast<int>(limits::search::share_of_forces * pursuit.allowance()) : 0;
}

Trial through_weaker_forces(Pursuit& pursuit, const GuessMesh& guess) {
  const int kept = steps_for_weaker_forces(pursuit);
  if (kept == 0) return Trial::none;
  pursuit.refinement.allow(std::min(kept, pursuit.options.max_iterations - pursuit.outcome.attempts),
                           limits::search::share_of_forces);
  const auto count = [&] { return pursuit.count_step(); };
  Trial trial = Trial::none;
  for (const double spread : limits::search::force_spreads) {
    const auto weakened = WeakenedLagrangian::about(pursuit.problem, spread);
    if (!weakened || pursuit.exhausted()) continue;
    guess.start(pursuit, limits::search::homotopy_degree);
    ForceHomotopy homotopy(pursuit.problem, pursuit.path, pursuit.w, count, weakened);
    trial = Trial::in_vain;
    if (!homotopy.trace(pursuit.tables())) continue;
    pursuit.refinement.rebind();
    if (pursuit.found("homotopy in the strength of the nonlinear forces")) return Trial::found;
  }
  pursuit.refinement.rebind();
  return trial;
}

}  // namespace extremal
