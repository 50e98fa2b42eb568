#include "solve/search/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "solve/adapt/others_to_try.hpp"
#include "solve/external/external_solver.hpp"
#include "solve/homotopy/duration_homotopy.hpp"
#include "solve/homotopy/force_homotopy.hpp"
#include "solve/newton/ends.hpp"
#include "solve/periodic/equilibrium.hpp"
#include "solve/search/balance.hpp"
#include "solve/search/continuum.hpp"
#include "solve/search/descent.hpp"
#include "solve/search/family.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::search;

namespace {

constexpr const char* from_guess = "newton from the guess";

}  // namespace

Search::Search(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem),
      guess_(&problem),
      options_(options),
      w_(workspace),
      refinement_(problem, options, workspace, outcome_),
      family_steps_of_flows_(limits::continuum::most_steps_in_all) {
  std::swap(path_, w_.spare);
}

Search::~Search() { std::swap(path_, w_.spare); }

bool Search::collapsed() const {
  return shrank(problem_, scales(path_, refinement_.tables()).range, outcome_.first_range);
}

/// Pursues the path.
Search::Pursuit Search::pursue(const char* strategy) {
  outcome_.strategy = strategy;
  outcome_.elsewhere = strategy != from_guess;
  run_external_solver(options_.method, problem_, refinement_.tables(), path_, options_.deadline,
                      [this] { return refinement_.count_step(); });
  Refinement::Result result = refinement_.pursue();
  // A path far from the guess may be wild, and resolved by accident only. A minimiser is none.
  const auto minimal = [&] {
    return !problem_.paired && !problem_.phase && w_.iteration.model().inertia(0).negative == 0;
  };
  const bool far = ran_away(problem_, magnitude_, scales(path_, refinement_.tables()).magnitude);
  if (result == Refinement::Result::converged && far && problem_.periodic) {
    outcome_.message = "the orbit moved far away, to where forces vanish";
    result = Refinement::Result::failed;
  } else if (result == Refinement::Result::converged && outcome_.elsewhere &&
             ((far && !minimal()) || !refinement_.holds_on_other_elements())) {
    unheld_ = path_;
    result = Refinement::Result::failed;
  }
  outcome_.elsewhere = outcome_.elsewhere || far;
  if (collapsed()) {
    outcome_.message = shrank_to_rest;
    met_.insert(Met::equilibrium);
    result = Refinement::Result::failed;
  }
  const bool converged = result == Refinement::Result::converged;
  const bool doubtful = converged ? !refinement_.confirmed() : refinement_.suspicious();
  // Neither a closed orbit nor one to infinity has ends that could be conjugate.
  const auto doubted = !problem_.has_ends() ? Refinement::Result::failed : Refinement::Result::unreachable;
  if (converged && doubtful) return {doubted, doubtful};
  return {converged && acceptance_ ? accepted() : result, doubtful};
}

/// Few elements and doubles are faster, and often good enough. Where all attempts fail, what the first one
/// met tells whether others may lead to an extremal.
Search::Pursuit Search::pursue_guess(const char* strategy) {
  const Pursuit first = pursue(strategy);
  const std::vector<double> mesh = mesh_;
  Pursuit result = first;
  for (const auto more : {&Search::search_on_steps_of_motion, &Search::search_with_double_digits}) {
    if (result.result == Refinement::Result::converged || options_.deadline.passed()) return result;
    if (!(this->*more)()) continue;
    refinement_.allow(allowance_);
    result = pursue(strategy);
  }
  if (result.result == Refinement::Result::converged) return result;
  mesh_ = mesh;
  return first;
}

/// Whether the path that meets the tolerance is an extremal: if not, another guess may lead to one.
Refinement::Result Search::accepted() {
  outcome_.status = Status::converged;
  Acceptance::Verdict verdict = acceptance_->judge(outcome_);
  for (int cut = 0; verdict == Acceptance::Verdict::coarse_at_ends && cut < most_cuts_at_ends; ++cut) {
    refinement_.rebind();
    if (refinement_.pursue_with_shorter_ends() != Refinement::Result::converged) break;
    verdict = acceptance_->judge(outcome_);
  }
  if (verdict == Acceptance::Verdict::accepted) return Refinement::Result::converged;
  outcome_.status = Status::not_converged;
  refinement_.rebind();
  if (acceptance_->too_loose()) refinement_.allow(0);
  return verdict == Acceptance::Verdict::hopeless ? Refinement::Result::unreachable
                                                  : Refinement::Result::failed;
}

bool Search::found(const char* strategy) {
  if (refinement_.exhausted()) return false;
  meet_ends(problem_, path_);
  return pursue(strategy).result == Refinement::Result::converged;
}

/// Downhill in windows, from the path that there is.
bool Search::descend(int most, double close) {
  if (refinement_.tables().unknowns() > most_dense_unknowns) return false;
  Descent descent(path_, w_, [&] { return refinement_.count_step() && --most > 0; });
  return descent.run(refinement_.tables(), close);
}

bool Search::by_descent(const std::vector<double>& mesh) {
  if (refinement_.exhausted() || problem_.paired) return false;
  start(mesh, bend_);
  // Others may need fewer steps.
  return descend(refinement_.steps_left() / 2, limits::descent::close) && found("minimisation in windows");
}

/// From durations in which the guess is nearly a motion, through extremals of all durations between.
bool Search::through_other_durations() {
  if (refinement_.exhausted() || problem_.duration.free || problem_.paired || problem_.infinite ||
      !problem_.lagrangian->structure().autonomous)
    return false;
  const auto count = [this] { return refinement_.count_step(); };
  start(mesh_, bend_, homotopy_degree);
  DurationHomotopy homotopy(problem_, path_, w_, count);
  for (const double duration : natural_durations(problem_, path_, w_, refinement_.tables())) {
    start(mesh_, bend_, homotopy_degree);
    path_.set_duration(duration);
    met_.insert(Met::other_durations);
    if (!homotopy.trace(refinement_.tables())) continue;
    refinement_.rebind();
    if (found("homotopy in the duration")) return true;
  }
  return false;
}

/// Steps kept for weaker forces; 0 where they are not tried.
int Search::kept_for_forces() const {
  const bool suits = !problem_.duration.free && !problem_.paired && !problem_.infinite && !problem_.phase &&
                     !problem_.manifold && problem_.has_ends() && !problem_.lagrangian->kinks();
  return suits ? static_cast<int>(share_of_forces * allowance_) : 0;
}

/// From the extremal of a quadratic Lagrangian, through those of weaker nonlinear forces.
bool Search::through_weaker_forces() {
  const int kept = kept_for_forces();
  if (kept == 0) return false;
  refinement_.allow(std::min(kept, options_.max_iterations - outcome_.attempts), share_of_forces);
  const auto count = [this] { return refinement_.count_step(); };
  for (const double spread : force_spreads) {
    const auto weakened = WeakenedLagrangian::about(*guess_, spread);
    if (!weakened || refinement_.exhausted()) continue;
    start(mesh_, bend_, homotopy_degree);
    ForceHomotopy homotopy(problem_, path_, w_, count, weakened);
    met_.insert(Met::weaker_forces);
    if (!homotopy.trace(refinement_.tables())) continue;
    refinement_.rebind();
    if (found("homotopy in the strength of the nonlinear forces")) return true;
  }
  refinement_.rebind();
  return false;
}

/// A guess that asks for more elements than there may be would ask again.
bool Search::from_finer_elements() {
  if (refinement_.exhausted()) return false;
  const std::vector<double> finer = halved(mesh_);
  if (finer.size() > most_first_elements + 1) return false;
  start(finer, bend_);
  return found("newton from the guess on finer elements") || by_descent(finer);
}

bool Search::from_noise(unsigned tries) {
  for (const unsigned last = seed_ + tries; seed_ < last && !refinement_.exhausted(); ++seed_) {
    const Bend bend{noise_sizes[seed_ % std::size(noise_sizes)], seed_};
    const auto fill = [&](const ElementTables& tables, Path& path) {
      start_path(*guess_, ends_, tables, path);
      bend_path(problem_, bend, tables, path);
    };
    if (!problem_.periodic) start(mesh_, bend);
    if (problem_.periodic && !open_fitting(fill)) {
      refinement_.count_step();
      continue;
    }
    met_.insert(Met::noise);
    if (found("newton from the guess plus smooth noise")) return true;
  }
  return false;
}

/// The default guess, where the user's fails.
bool Search::from_line() {
  if (!problem_.guess.given() || !problem_.has_ends() || problem_.duration.free) return false;
  Problem line = problem_;
  line.guess = {};
  guess_ = &line;
  const bool result =
      begin() != GuessKind::undefined && (found("newton from the straight line") || by_descent(mesh_));
  guess_ = &problem_;
  return result;
}

/// Extremals between ends, and orbits that neither a shift in time nor a symmetry moves: null directions are
/// then those of a family.
bool Search::may_be_family() const {
  if (problem_.has_ends()) return true;
  return problem_.periodic && !problem_.lagrangian->structure().autonomous && problem_.symmetries.empty() &&
         !problem_.paired;
}

/// Where the second variation is singular: the member nearest to the guess, if there is a family.
bool Search::on_family(bool resolved, int& steps_left) {
  if (problem_.duration.free || (!problem_.infinite && !may_be_family())) return false;
  if (problem_.lagrangian->kinks()) return false;
  if (refinement_.tables().unknowns() > most_dense_unknowns) return false;
  const std::string failure = outcome_.message;
  const auto fill = [&](const ElementTables& tables, const std::vector<double>& mesh, Path& path) {
    path.reset(tables, mesh, problem_.duration.value);
    start_path(*guess_, ends_, tables, path);
    bend_path(problem_, bend_, tables, path);
  };
  outcome_.strategy = "newton across a family from the guess";
  outcome_.elsewhere = false;
  const auto count = [&] {
    refinement_.count_step();
    return --steps_left > 0 && !options_.deadline.passed();
  };
  const Path found = path_;
  const auto resample = [&](const ElementTables& tables, const std::vector<double>& mesh, Path& path) {
    path.resample_from(found, tables, mesh);
  };
  const auto from = [&](const std::vector<double>& mesh, const FillGuess& start) {
    const FamilySearch result = nearest_of_family(problem_, options_, w_, mesh, fill, start, count, outcome_);
    no_family_ = no_family_ || result == FamilySearch::none;
    return result == FamilySearch::found;
  };
  // The guess may be a member, or near one; so may the path that was found. Where that is an extremal, its
  // elements resolve both.
  const bool finite = std::ranges::all_of(found.nodes(), [](double x) { return std::isfinite(x); });
  const std::vector<double> mesh(found.mesh().begin(), found.mesh().end());
  no_family_ = false;
  const bool one_of_family = !finite    ? from(mesh_, fill)
                             : resolved ? from(mesh, fill) || from(mesh, resample)
                                        : from(mesh, resample) || from(mesh_, fill);
  // A shift between rests that changes the action by less than roundoff makes no family. From rest to rest in
  // infinite time it is a symmetry.
  const bool shift_alone =
      problem_.infinite ? outcome_.family <= problem_.shifts_in_time() : Balance(problem_, path_).exists();
  if (one_of_family && !shift_alone) {
    outcome_.status = Status::converged;
    if (!acceptance_ || accepted() == Refinement::Result::converged) return true;
  }
  outcome_.family = 0;
  outcome_.status = Status::not_converged;
  outcome_.strategy = from_guess;
  outcome_.message = failure;
  refinement_.rebind();
  return false;
}

/// Whether steps leave open more than a shift in time. The eigenvalues of such a path on a part of the time
/// axis are roundoff, of either sign.
bool Search::leaves_open() {
  const auto count = [this] { return refinement_.count_step(); };
  ExtremalFamily family(problem_, count);
  family.reset(refinement_.tables(), path_);
  const bool known = family.find_null(path_, limits::continuum::null_eigenvalue);
  refinement_.rebind();
  return known && family.null_directions() > problem_.shifts_in_time();
}

/// The path that was accepted may be one of a family, and another member nearer to the guess.
void Search::nearest_to_guess() {
  if (!acceptance_ || acceptance_->nullity() == 0 || !may_be_family() || problem_.manifold ||
      problem_.phase || outcome_.shifts_held)
    return;
  const Outcome accepted = outcome_;
  int steps = limits::continuum::most_steps_in_all;
  if (on_family(true, steps)) return;
  outcome_ = accepted;
  refinement_.rebind();
}

const ElementTables& Search::open(const std::vector<double>& mesh, int degree) {
  refinement_.open(mesh, degree);
  return refinement_.tables();
}

bool Search::refine(const ElementTables& tables, const char* strategy) {
  refinement_.take(tables);
  const bool result = found(strategy);
  outcome_.status = result ? Status::converged : Status::not_converged;
  return result;
}

void Search::be_like(const Search& other) {
  magnitude_ = other.magnitude_;
  outcome_.first_range = other.outcome_.first_range;
  allowance_ = other.allowance_;
}

void Search::renew(double share) { refinement_.allow(static_cast<int>(share * allowance_), share); }

/// Cheapest first; but where the user has given a guess, paths near it before noise.
bool Search::from_other_guesses(GuessKind guess) {
  if (options_.deadline.passed()) return false;
  if (guess == GuessKind::colliding && from_noise(collision_noises)) return true;
  if (problem_.guess.given() && !problem_.guess.motion() && resolve_guess() &&
      found("newton from the guess on finer elements"))
    return true;
  if (by_descent(mesh_) || by_gradient_flow() || from_finer_elements()) return true;
  if (from_settled_motion()) return true;
  if (!problem_.guess.given() && from_noise(first_noises)) return true;
  if (through_other_durations() || from_line() || through_other_ends()) return true;
  begin();
  refinement_.keep(kept_for_forces());
  if (from_noise(most_noises)) return true;
  begin();
  if (from_motions()) return true;
  // What it finds may be far.
  return through_weaker_forces();
}

/// Puts the guess on elements, and bounds the effort.
Search::GuessKind Search::prepare() {
  outcome_.message = "the action is not finite along the guess";
  const GuessKind guess = begin();
  if (guess == GuessKind::undefined) return guess;
  const Scales size = scales(path_, refinement_.tables());
  magnitude_ = size.magnitude;
  if (!problem_.has_ends()) outcome_.first_range = size.range;
  const double unknowns = static_cast<double>(refinement_.tables().unknowns()) * path_.elements();
  allowance_ = std::min(
      {options_.max_iterations, most_steps, static_cast<int>(std::max(least_steps, most_work / unknowns))});
  refinement_.allow(allowance_);
  return guess;
}

/// Where it is the budget that has ended the search.
const Outcome& Search::unless_spent() {
  if (outcome_.status == Status::converged || !options_.deadline.passed()) return outcome_;
  outcome_.status = Status::iteration_limit;
  outcome_.message = fmt::format("{} (solve.budget) is spent, in Newton steps: {}; raise it, or try {}",
                                 options_.deadline.budget_text(), outcome_.iterations,
                                 others_to_try(problem_, "a better guess", "a shorter duration"));
  return outcome_;
}

const Outcome& Search::run_near_guess() {
  if (prepare() == GuessKind::undefined) return unless_spent();
  // Between fixed ends a path may well be at rest.
  if (problem_.ends.free > 0) outcome_.first_range = scales(path_, refinement_.tables()).range;
  auto [result, doubtful] = pursue_guess(from_guess);
  if (problem_.infinite) {
    const bool converged = result == Refinement::Result::converged;
    int steps = limits::continuum::most_steps_in_all;
    if ((!converged || leaves_open()) && on_family(converged, steps)) result = Refinement::Result::converged;
  }
  outcome_.hidden = result == Refinement::Result::unreachable && !doubtful;
  if (result == Refinement::Result::converged && !outcome_.elsewhere) outcome_.status = Status::converged;
  return outcome_;
}

const Outcome& Search::run(Acceptance* acceptance) {
  const GuessKind guess = prepare();
  if (guess == GuessKind::undefined) return unless_spent();
  acceptance_ = acceptance;
  auto [result, doubtful] = pursue_guess(from_guess);
  // What the path before has spent does not count.
  int steps = limits::continuum::most_steps_in_all;
  if (result != Refinement::Result::converged && on_family(false, steps)) {
    result = Refinement::Result::converged;
    doubtful = false;
  } else if (result == Refinement::Result::converged) {
    nearest_to_guess();
  }
  // Between rests roundoff hides where an extremal is, from Newton's method alone.
  if (result == Refinement::Result::unreachable && !problem_.guess.given() && problem_.has_ends()) {
    const Outcome hidden = outcome_;
    refinement_.allow(allowance_);
    if (by_gradient_flow()) {
      result = Refinement::Result::converged;
    } else {
      outcome_ = hidden;
      refinement_.rebind();
    }
  }
  if (result == Refinement::Result::failed) {
    const std::string failure = outcome_.message;
    if (guess == GuessKind::colliding) refinement_.allow(allowance_);
    if (from_other_guesses(guess)) {
      result = Refinement::Result::converged;
    } else {
      outcome_.status = Status::iteration_limit;
      outcome_.message = fmt::format(
          "{} Newton steps from the guess ({}){}{}{}{}{} found no extremal; try {}", outcome_.iterations,
          failure, met_.contains(Met::other_durations) ? ", through other durations" : "",
          met_.contains(Met::other_ends) ? ", through other ends" : "",
          met_.contains(Met::noise) ? ", from smooth noise" : "",
          met_.contains(Met::motions) ? ", from motions that miss the end" : "",
          met_.contains(Met::weaker_forces) ? ", through weaker forces" : "",
          others_to_try(problem_, "a better guess", "a shorter duration"));
      if (met_.contains(Met::equilibrium)) {
        outcome_.status = Status::no_solution_near;
        outcome_.message = fmt::format("{} from the guess and from others; try {}", shrank_to_rest,
                                       others_to_try(problem_, "a larger guess", "another duration"));
      }
      // Where ends are conjugate, different elements find different members of a family.
      if (unheld_) std::swap(path_, *unheld_);
    }
  }
  if (result == Refinement::Result::converged) outcome_.status = Status::converged;
  if (result != Refinement::Result::converged && (doubtful || no_family_) && problem_.has_ends()) {
    outcome_.status = Status::conjugate_ends;
    outcome_.message =
        no_family_
            ? "the ends are conjugate along a path near the guess: its second variation is singular, and a "
              "force along its null directions remains that no step removes, so that there is neither an "
              "extremal nor a family of them near; move an end, change the duration, or try another guess"
            : "the second variation is singular or nearly so: the ends may be conjugate: there may be no "
              "extremal, or a whole family of them; move an end or change the duration";
  }
  if (result != Refinement::Result::converged && no_family_ && problem_.periodic) {
    outcome_.status = Status::no_solution_near;
    outcome_.message =
        "the second variation is singular, or nearly so, along a path near the guess, and a force along its "
        "null directions remains: what drives the motion is in resonance, and no orbit of this period is "
        "found near, nor a family of them; change the duration or the force, or try a better guess";
  }
  acceptance_ = nullptr;
  return unless_spent();
}

}  // namespace extremal
