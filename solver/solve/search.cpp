#include "solve/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/descent.hpp"
#include "solve/homotopy.hpp"
#include "solve/method.hpp"

namespace extremal {

namespace {

/// Elements are at most this long in units of 1/ω, ω the local frequency along the guess.
constexpr double longest_element = 2.0;
/// Coarse elements may not follow a family of extremals as it grows.
constexpr int homotopy_degree = 8;
constexpr int most_first_elements = 1 << 12;
/// Elements follow a guess to this, relative to its range, a motion to between these by the tolerance; they
/// follow velocities to so many times that, and become at most so many at a time.
constexpr double guess_goal = 1e-5, best_guess_goal = 1e-8, slope_goal = 100, guess_cut = 4;
constexpr double guess_floor = 0.25;
constexpr int most_passes = 10, highest_guess_degree = 12;
/// A path of chance that needs more elements than this comes too near a singularity.
constexpr int most_launched = 128;
/// A singularity is near where elements differ so much.
constexpr double collision = 100;
/// A mesh whose elements differ less than this is not worth starting again for.
constexpr double mild_grading = 3;
/// Newton steps in all, times unknowns of the first mesh: what other guesses may cost.
constexpr double most_work = 1e7;
constexpr double least_steps = 100;
/// Tries to move the default guess to where L is finite.
constexpr unsigned most_bends = 8;
/// A periodic path that is so much smaller than the guess is at rest.
constexpr double rest = 1e-6;
/// Starts with noise that are cheaper than other durations are; and at most.
constexpr unsigned first_noises = 8, most_noises = 10000, collision_noises = 100;
/// Of the guess's extent, in turn.
constexpr double noise_sizes[] = {0.1, 0.3, 0.6};

constexpr const char* from_guess = "newton from the guess";

int first_elements(const Frequency& frequency) {
  const double wanted = std::min<double>(frequency.phase() / longest_element, most_first_elements);
  return lanes * std::max(1, static_cast<int>(std::ceil(wanted / lanes)));
}

}  // namespace

Search::Search(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem),
      guess_(&problem),
      options_(options),
      w_(workspace),
      refinement_(problem, options, workspace, outcome_) {}

void Search::start(const std::vector<double>& mesh, const Bend& bend, int degree) {
  refinement_.open(mesh, degree);
  start_path(*guess_, ends_, refinement_.tables(), w_.path);
  bend_path(problem_, bend, refinement_.tables(), w_.path);
}

/// Puts the guess on a mesh that follows the frequency along it. The default guess is moved aside until L
/// is finite on it; false if it never is.
bool Search::begin() {
  ends_ = starting_ends(*guess_);
  mesh_ = uniform_mesh(lanes);
  for (unsigned seed = 0; seed <= most_bends; ++seed) {
    bend_ = {0.1 * seed, seed};
    start(mesh_, bend_);
    measure_frequency(problem_, w_.iteration.action(), refinement_.tables(), w_.path, w_.frequency);
    if (w_.frequency.finite()) break;
    if (guess_->guess.given() || seed == most_bends) return false;
  }
  int elements = first_elements(w_.frequency);
  const double floor = guess_->guess.given() ? guess_floor : 1.0;
  // A sketch of an orbit may pass a collision; elements that follow it there serve no other path.
  colliding_ = problem_.periodic && !guess_->guess.motion && elements > most_launched &&
               w_.frequency.grading(floor) > collision;
  if (colliding_) elements = most_launched;
  if (elements > lanes || w_.frequency.grading(floor) >= mild_grading) {
    mesh_ = w_.frequency.mesh(elements, floor);
    start(mesh_, bend_);
  }
  if (guess_->guess.motion) resolve_guess();
  return true;
}

/// A good guess is worth what elements keep of it. Whether those there were did not keep it.
bool Search::resolve_guess() {
  bool finer_found = false;
  const double goal =
      guess_->guess.motion ? std::clamp(options_.tolerance, best_guess_goal, guess_goal) : guess_goal;
  const int samples = static_cast<int>(guess_->guess.tau.size());
  for (int pass = 0; pass < most_passes; ++pass) {
    const ElementTables& tables = refinement_.tables();
    const int degree = w_.path.degree(), elements = w_.path.elements();
    w_.resolution.measure(w_.path, tables);
    const Resolution::Error error = w_.resolution.at(degree);
    const Scales size = scales(w_.path, tables);
    const Resolution::Error aim{goal * size.q, slope_goal * goal * size.v};
    if ((error.q <= aim.q && error.v <= aim.v) || elements * degree >= samples) break;
    measure_frequency(problem_, w_.iteration.action(), tables, w_.path, w_.frequency);
    if (const int wanted = first_elements(w_.frequency); w_.frequency.finite() && wanted > elements) {
      mesh_ = w_.frequency.mesh(wanted, guess_floor);
      start(mesh_, bend_, degree);
      finer_found = true;
      continue;
    }
    const Plan finer =
        w_.planner.plan(w_.resolution, w_.path.mesh(), tables,
                        {aim, aim, degree, degree, highest_guess_degree, most_first_elements, guess_cut});
    if (finer.degree == 0 || (finer.mesh.empty() && finer.degree == degree)) break;
    if (!finer.mesh.empty()) mesh_ = finer.mesh;
    start(mesh_, bend_, finer.degree);
    finer_found = true;
  }
  return finer_found;
}

/// An equilibrium has every period.
bool Search::collapsed() const {
  return extent_ > 0 && scales(w_.path, refinement_.tables()).range <= rest * extent_;
}

/// Pursues the path in the workspace.
Refinement::Result Search::pursue(const char* strategy) {
  outcome_.strategy = strategy;
  outcome_.elsewhere = strategy != from_guess;
  lead(options_.method, problem_, refinement_.tables(), w_.path, [this] { return refinement_.count_step(); });
  Refinement::Result result = refinement_.pursue();
  // A path far from the guess may be wild, and resolved by accident only.
  const bool far = problem_.ends.free > 0 &&
                   ran_away(problem_, magnitude_, scales(w_.path, refinement_.tables()).magnitude);
  if (result == Refinement::Result::converged && far && problem_.periodic) {
    outcome_.message = "the orbit ran away to where forces vanish";
    result = Refinement::Result::failed;
  } else if (result == Refinement::Result::converged && outcome_.elsewhere &&
             (far || !refinement_.holds_on_other_elements())) {
    unheld_ = w_.path;
    result = Refinement::Result::failed;
  }
  outcome_.elsewhere = outcome_.elsewhere || far;
  if (collapsed()) {
    outcome_.message = "the orbit shrank to a point of equilibrium";
    shrank_ = true;
    result = Refinement::Result::failed;
  }
  const bool converged = result == Refinement::Result::converged;
  doubtful_ = converged ? !refinement_.confirmed() : refinement_.suspicious();
  // What closes on itself has no ends to be conjugate.
  const auto doubted = problem_.periodic ? Refinement::Result::failed : Refinement::Result::unreachable;
  return converged && doubtful_ ? doubted : result;
}

bool Search::found(const char* strategy) {
  if (refinement_.exhausted()) return false;
  meet_ends(problem_, w_.path);
  return pursue(strategy) == Refinement::Result::converged;
}

/// Downhill in windows.
bool Search::by_descent(const std::vector<double>& mesh) {
  if (refinement_.exhausted()) return false;
  start(mesh, bend_);
  if (refinement_.tables().unknowns() > most_dense_unknowns) return false;
  int steps = refinement_.steps_left() / 2;  // others may need fewer
  Descent descent(problem_, w_, [&] { return refinement_.count_step() && --steps > 0; });
  return descent.run(refinement_.tables()) && found("minimisation in windows");
}

/// From durations in which the guess is nearly a motion, through extremals of all durations between.
bool Search::through_other_durations() {
  if (refinement_.exhausted() || problem_.duration.free || !problem_.lagrangian->structure().autonomous)
    return false;
  const auto count = [this] { return refinement_.count_step(); };
  start(mesh_, bend_, homotopy_degree);
  DurationHomotopy homotopy(problem_, w_, count);
  for (const double duration : natural_durations(problem_, w_, refinement_.tables())) {
    start(mesh_, bend_, homotopy_degree);
    w_.path.set_duration(duration);
    if (!homotopy.follow(refinement_.tables())) continue;
    refinement_.rebind();
    if (found("homotopy in the duration")) return true;
  }
  return false;
}

/// A guess that asks for more elements than there may be would ask again.
bool Search::from_finer_elements() {
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
    if (problem_.periodic && !place(fill)) {
      refinement_.count_step();
      continue;
    }
    if (found("newton from the guess plus smooth noise")) return true;
  }
  return false;
}

/// The default guess, where the user's leads nowhere.
bool Search::from_line() {
  if (!problem_.guess.given() || problem_.periodic || problem_.duration.free) return false;
  Problem line = problem_;
  line.guess = {};
  guess_ = &line;
  const bool result = begin() && (found("newton from the straight line") || by_descent(mesh_));
  guess_ = &problem_;
  return result;
}

const ElementTables& Search::open(const std::vector<double>& mesh, int degree) {
  refinement_.open(mesh, degree);
  return refinement_.tables();
}

bool Search::settle(const ElementTables& tables, const char* strategy) {
  refinement_.take(tables);
  const bool result = found(strategy);
  outcome_.status = result ? Status::converged : Status::not_converged;
  return result;
}

bool Search::place(const std::function<void(const ElementTables&, Path&)>& fill) {
  fill(open(uniform_mesh(2 * lanes), Refinement::first_degree), w_.path);
  measure_frequency(problem_, w_.iteration.action(), refinement_.tables(), w_.path, w_.frequency);
  const int elements = first_elements(w_.frequency);
  if (!w_.frequency.finite() || elements > most_launched) return false;
  fill(open(w_.frequency.mesh(elements, guess_floor), Refinement::first_degree), w_.path);
  return true;
}

void Search::be_like(const Search& other) {
  magnitude_ = other.magnitude_;
  extent_ = other.extent_;
  allowance_ = other.allowance_;
}

void Search::renew(double share) { refinement_.allow(static_cast<int>(share * allowance_), share); }

/// Cheapest first; but where the user has given a guess, what stays near it before noise.
bool Search::from_other_guesses() {
  if (colliding_ && from_noise(collision_noises)) return true;
  if (problem_.guess.given() && !problem_.guess.motion && resolve_guess() &&
      found("newton from the guess on finer elements"))
    return true;
  if (by_descent(mesh_) || from_finer_elements()) return true;
  if (!problem_.guess.given() && from_noise(first_noises)) return true;
  if (through_other_durations() || from_line()) return true;
  begin();
  return from_noise(most_noises);
}

Outcome Search::run() {
  outcome_.message = "the action is not finite along the guess";
  if (!begin()) return outcome_;
  const Scales size = scales(w_.path, refinement_.tables());
  magnitude_ = size.magnitude;
  if (problem_.periodic && problem_.lagrangian->structure().autonomous) extent_ = size.range;
  const double unknowns = static_cast<double>(refinement_.tables().unknowns()) * w_.path.elements();
  allowance_ =
      std::min(options_.max_iterations, static_cast<int>(std::max(least_steps, most_work / unknowns)));
  refinement_.allow(allowance_);
  Refinement::Result result = pursue(from_guess);
  const bool doubtful = doubtful_;
  if (result == Refinement::Result::failed) {
    const std::string failure = outcome_.message;
    if (colliding_) refinement_.allow(allowance_);
    if (from_other_guesses()) {
      result = Refinement::Result::converged;
    } else {
      outcome_.status = Status::iteration_limit;
      outcome_.message = fmt::format(
          "{} Newton steps from the guess ({}), through other durations and from smooth noise "
          "found no extremal; try a better guess or a shorter duration",
          outcome_.iterations, failure);
      if (shrank_) {
        outcome_.status = Status::no_solution_near;
        outcome_.message =
            "the orbit shrank to a point of equilibrium from the guess and from others; try a larger guess "
            "or "
            "another duration";
      }
      // Where ends are conjugate, elements tell different members of a family.
      if (unheld_) std::swap(w_.path, *unheld_);
    }
  }
  if (result == Refinement::Result::converged) outcome_.status = Status::converged;
  if (result != Refinement::Result::converged && doubtful && !problem_.periodic) {
    outcome_.status = Status::conjugate_ends;
    outcome_.message =
        "the second variation is singular or nearly so: the ends may be conjugate, with no extremal or a "
        "family of them; move an end or the duration";
  }
  return outcome_;
}

}  // namespace extremal
