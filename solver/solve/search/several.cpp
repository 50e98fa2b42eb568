#include "solve/search/several.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "problem/recurrence.hpp"
#include "solve/newton/ends.hpp"
#include "solve/periodic/repetition.hpp"
#include "solve/periodic/stability.hpp"
#include "solve/search/distinct.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::several;

Several::Several(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem),
      options_(options),
      w_(workspace),
      search_(problem, options, workspace),
      pursuit_(search_.pursuit()),
      guess_(search_.guess()),
      path_(pursuit_.path),
      loops_(problem, options, workspace, pursuit_),
      motions_(pursuit_, guess_),
      starts_(problem),
      closing_(problem) {
  if (problem.periodic && !problem.lagrangian->structure().autonomous && closing_map(problem).identity())
    period_ = recurrence_time(problem);
}

/// Whether an orbit is one of a shorter period, run through several times. One that a symmetry of L closes
/// after m segments may repeat itself after any number of these.
bool Several::repeats(const Solution& candidate) const {
  if (!problem_.periodic || !problem_.lagrangian->structure().autonomous) return false;
  const ClosingMap map = closing_map(problem_);
  const int segments = segments_to_close(map);
  if (segments == 0) return false;
  const double size = scales(path_, *pursuit_.outcome.tables).q;
  const int parts = repetitions(candidate.trajectory, map, segments, distinct_distance(candidate, size));
  return parts == 0 || segments % parts != 0;
}

/// The number of the extremal that the search found, which is added if it is new; -1 if it is none.
int Several::keep() {
  Solution candidate;
  candidate.trajectory = trajectory_of(path_);
  candidate.error_estimate = pursuit_.outcome.error;
  const bool held = pursuit_.outcome.shifts_held;
  if (held) candidate.error_estimate = held_apart * scales(path_, pursuit_.tables()).q;
  const int number =
      find([&](const Solution& other) { return same_path(candidate, other, options_.tolerance, scale_); });
  if (number >= 0) return number;
  Acceptance acceptance(problem_, options_, w_);
  acceptance.judge(pursuit_.outcome);
  too_loose_ = too_loose_ || acceptance.too_loose();
  candidate = acceptance.result(pursuit_.outcome);
  analysing_ += candidate.seconds_analyse;
  return candidate.converged() ? add(std::move(candidate), held) : -1;
}

/// The same for a solution that was accepted. Those whose shifts are `held` are members of a continuum each,
/// but all of them were shifted to where energies agree.
int Several::add(Solution candidate, bool held) {
  candidate.seconds_solve = seconds_since(start_) - analysing_;
  if (repeats(candidate)) {
    if (!repeating_) repeating_ = std::move(candidate);
    return -1;
  }
  const bool closed = problem_.periodic && problem_.lagrangian->structure().autonomous;
  const bool placed =
      problem_.paired || !problem_.boundary.momenta.empty() || !problem_.boundary.costs.empty();
  const int number = find([&](const Solution& other) {
    if (closed) return same_orbit(candidate, other, options_.tolerance);
    return (!placed &&
            same_but_for_place(*problem_.lagrangian, candidate, other, period_, options_.tolerance)) ||
           (!held && same_continuum(candidate, other, options_.tolerance));
  });
  if (number >= 0) return number;
  found_.push_back(std::move(candidate));
  traced_.emplace_back(families_, 0);
  pursuit_.renew(patience);
  in_vain_ = returns_ = 0;
  if (static_cast<int>(found_.size()) == most_) enough_at_ = seed_;
  return static_cast<int>(found_.size()) - 1;
}

int Several::refine_and_keep(const ElementTables& tables, const char* strategy) {
  meet_ends(problem_, path_);
  return pursuit_.refine(tables, strategy) ? keep() : -1;
}

/// The largest |q| along the guess, or 1 where that is zero.
double Several::size_of_guess() {
  const ElementTables& tables = pursuit_.open(guess_.mesh(), Refinement::first_degree);
  start_path(problem_, guess_.ends(), tables, path_);
  const double size = scales(path_, tables).magnitude;
  return size > 0 ? size : 1;
}

/// Whether loops come back to known orbits as often as they would if no more of the wanted were missing.
bool Several::returns_suffice() const {
  if (!loops_.usable()) return true;
  return returns_ >= returns_each * static_cast<int>(found_.size()) ||
         seed_ >= (1 + spare_loops) * enough_at_;
}

bool Several::wanted() const {
  return !(static_cast<int>(found_.size()) >= most_ && returns_suffice()) &&
         in_vain_ < (loops_.usable() ? most_loops_in_vain : most_in_vain) && !pursuit_.exhausted();
}

/// What was done to find `all`.
std::string Several::searched(std::size_t all) const {
  std::string text = "from the guess";
  if (seed_ > 0) text += fmt::format(" and {} {}", seed_, loops_.usable() ? "random loops" : "others");
  if (traced_count_ > 0) text += fmt::format(", along {} families", traced_count_);
  if (scanned_ > 0) text += fmt::format(", from {} motions", scanned_);
  text += fmt::format(", {} Newton steps in all", pursuit_.outcome.iterations);
  if (options_.deadline.passed())
    text += fmt::format("; {} (solve.budget) is spent", options_.deadline.budget_text());
  const std::size_t kept = std::min<std::size_t>(all, most_);
  if (kept < static_cast<std::size_t>(most_))
    return fmt::format("{} of up to {} extremals found: no more {}; others may exist", kept, most_, text);
  return fmt::format("the {} of least action of {} extremals found {}; others may exist, also between them",
                     kept, all, text);
}

std::vector<Solution> Several::run(int most) {
  most_ = most;
  start_ = Clock::now();
  Acceptance acceptance(problem_, options_, w_);
  const Outcome& first = search_.run(&acceptance);
  const bool converged = first.status == Status::converged;
  Solution solution = acceptance.result(first);
  too_loose_ = acceptance.too_loose();
  analysing_ = acceptance.seconds();
  const auto solving = [&] { return seconds_since(start_) - analysing_; };
  solution.seconds_solve = solving();
  families_ = 1 + (problem_.periodic ? 0 : std::min(problem_.boundary.rows, most_rows));
  const bool begun = converged && add(solution) >= 0;
  std::optional<Solution> failed;
  if (!begun) failed = repeating_ ? std::move(*repeating_) : std::move(solution);
  if (!begun && !loops_.usable() && !motions_.has_curves() && !starts_.usable()) return {std::move(*failed)};
  scale_ = size_of_guess();
  if (begun) descend();
  bool complete = false;
  if (most_ > 1 || !begun) {
    const bool by_openings = closing_.usable() && scan_openings();
    // Curves of arrivals unfold what passages by a singularity fold; cells of starts need no curves.
    const bool starts_first = even_starts();
    complete = (starts_first && scan_starts()) || (motions_.has_curves() && trace_arrivals()) ||
               (!starts_first && starts_.usable() && scan_starts()) || by_openings;
  }
  if (!complete && (!found_.empty() || loops_.usable())) {
    pursuit_.renew(patience);
    if (begun) deflate();
    guess();
    while (wanted())
      if (!trace_families()) guess();
    descend();
  }
  if (found_.empty()) {
    if (failed->converged())
      failed->message += fmt::format(
          "; the duration is that of several turns: {} random loops led to no orbit that closes only after "
          "it",
          seed_);
    failed->seconds_solve = solving();
    return {std::move(*failed)};
  }
  if (most_ > 1 && motions_.usable() && !complete) scan();
  sort_by_action(found_);
  const std::size_t all = found_.size();
  if (all > static_cast<std::size_t>(most_)) found_.resize(most_);
  if (most_ > 1) found_.front().message += "; " + searched(all);
  return std::move(found_);
}

}  // namespace extremal
