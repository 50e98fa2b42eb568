#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/search/limits.hpp"
#include "solve/search/search.hpp"

/// \file Elements for a guess.

namespace extremal {

using namespace limits::guess_mesh;

namespace {

/// Of the integrator that a motion comes from.
std::size_t steps_of(const Guess& motion) { return (motion.tau.size() - 1) / motion.samples_a_step; }

}  // namespace

int Search::first_elements(const Frequency& frequency) {
  const double wanted = std::min<double>(frequency.phase() / longest_element, most_first_elements);
  return most_lanes * std::max(1, static_cast<int>(std::ceil(wanted / most_lanes)));
}

void Search::start(const std::vector<double>& mesh, const Bend& bend, int degree) {
  refinement_.open(mesh, degree);
  start_path(*guess_, ends_, refinement_.tables(), path_);
  bend_path(problem_, bend, refinement_.tables(), path_);
}

/// Puts the guess on a mesh that follows the frequency along it. The default guess is moved aside until L
/// is finite on it.
Search::GuessKind Search::begin() {
  ends_ = starting_ends(*guess_);
  mesh_ = uniform_mesh(most_lanes);
  for (unsigned seed = 0; seed <= most_bends; ++seed) {
    bend_ = {0.1 * seed, seed};
    start(mesh_, bend_);
    measure_frequency(problem_, w_.iteration.action(), refinement_.tables(), path_, w_.frequency);
    if (w_.frequency.finite()) break;
    if (guess_->guess.given() || seed == most_bends || options_.deadline.passed())
      return GuessKind::undefined;
  }
  int elements = first_elements(w_.frequency);
  const double floor = guess_->guess.given() ? guess_floor : 1.0;
  // A sketch of an orbit may pass a collision; elements for it serve no other path.
  const bool colliding = problem_.periodic && !guess_->guess.motion() && elements > most_launched &&
                         w_.frequency.grading(floor) > collision;
  if (colliding) elements = most_launched;
  if (elements > path_.elements() || w_.frequency.grading(floor) >= mild_grading) {
    mesh_ = w_.frequency.mesh(elements, floor);
    start(mesh_, bend_);
  }
  if (guess_->guess.motion() && !mesh_of_motion()) resolve_guess();
  end_at_kinks_of_guess();
  phase_ = std::max(1.0, w_.frequency.phase());
  return colliding ? GuessKind::colliding : GuessKind::usable;
}

/// Elements end where the guess crosses kinks of L. Coarse ones would miss crossings that follow each other.
void Search::end_at_kinks_of_guess() {
  const Kinks* const kinks = refinement_.tables().kinks();
  if (!kinks || !guess_->guess.given()) return;
  const std::vector<double> mesh(path_.mesh().begin(), path_.mesh().end());
  const int degree = path_.degree(), samples = static_cast<int>(guess_->guess.tau.size());
  start(uniform_mesh(std::clamp(samples / degree, least_sampled, most_sampled)), bend_, degree);
  const std::vector<double> times = crossings(*kinks, path_);
  mesh_ = with_nodes(mesh, times);
  start(mesh_, bend_, degree);
  if (times.empty() || refinement_.mesh_kept()) return;
  // Forces that jump inside an element look like a high frequency there.
  measure_frequency(problem_, w_.iteration.action(), refinement_.tables(), path_, w_.frequency);
  if (!w_.frequency.finite()) return;
  mesh_ = with_nodes(w_.frequency.mesh(first_elements(w_.frequency), guess_floor), times);
  start(mesh_, bend_, degree);
}

/// A motion that took its integrator so many steps passes one encounter after the other, which elements would
/// find one by one: each of them covers as many steps. So they do beside a collision, where the frequency
/// asks for more. False elsewhere.
bool Search::mesh_of_motion() {
  const std::size_t wanted = steps_of(guess_->guess) / steps_an_element;
  const std::size_t elements = (wanted / most_lanes + 1) * most_lanes;
  const bool many = wanted >= least_kept && wanted <= most_kept;
  const bool collides = w_.frequency.grading(guess_floor) > collision;
  if (!many && !(collides && elements < static_cast<std::size_t>(path_.elements()))) return false;
  put_on_motion(elements);
  if (many) refinement_.keep_mesh();
  return true;
}

/// On elements of equally many samples each: they are as long as the steps of the integrator.
void Search::put_on_motion(std::size_t elements) {
  const std::vector<double>& tau = guess_->guess.tau;
  const std::size_t samples = tau.size() - 1;
  mesh_.resize(elements + 1);
  for (std::size_t k = 0; k <= elements; ++k) mesh_[k] = tau[k * samples / elements];
  start(mesh_, bend_, kept_degree);
}

/// A motion that passes a singularity closely is resolved there by the steps of its integrator; coarser
/// elements follow it only relative to its whole range. They are kept, whatever the tolerance. False where
/// they are already, or for other guesses.
bool Search::search_on_steps_of_motion() {
  if (!guess_->guess.motion() || refinement_.mesh_kept()) return false;
  const std::size_t elements = (steps_of(guess_->guess) / most_lanes + 1) * most_lanes;
  if (elements <= static_cast<std::size_t>(path_.elements()) || elements > most_kept) return false;
  put_on_motion(elements);
  refinement_.keep_mesh();
  return true;
}

/// The same elements for the same motion, with factors that have more digits; false if it was not followed.
/// Errors of the elements are amplified as roundoff is: where the first step amplifies all that doubles have
/// lost, their degree is higher.
bool Search::search_with_double_digits() {
  if (!refinement_.mesh_kept()) return false;
  start(mesh_, bend_, kept_degree);
  const bool lost = refinement_.loses_digits();
  if (lost) start(mesh_, bend_, exact_degree);
  refinement_.set_digits(lost ? Refinement::Digits::doubled : Refinement::Digits::doubled_where_lost);
  refinement_.keep_mesh();
  return true;
}

/// Elements that resolve a good guess; false if those there were do.
bool Search::resolve_guess() {
  bool finer_found = false;
  const double goal =
      guess_->guess.motion() ? std::clamp(options_.tolerance, best_guess_goal, guess_goal) : guess_goal;
  const int samples = static_cast<int>(guess_->guess.tau.size());
  for (int pass = 0; pass < most_passes; ++pass) {
    const ElementTables& tables = refinement_.tables();
    const int degree = path_.degree(), elements = path_.elements();
    w_.resolution.measure(path_, tables);
    const Resolution::Error error = w_.resolution.at(degree);
    const Scales size = scales(path_, tables);
    const Resolution::Error aim{goal * size.q, slope_goal * goal * size.v};
    if ((error.q <= aim.q && error.v <= aim.v) || elements * degree >= samples) break;
    measure_frequency(problem_, w_.iteration.action(), tables, path_, w_.frequency);
    if (const int wanted = first_elements(w_.frequency); w_.frequency.finite() && wanted > elements) {
      mesh_ = w_.frequency.mesh(wanted, guess_floor);
      start(mesh_, bend_, degree);
      finer_found = true;
      continue;
    }
    const Plan finer =
        w_.planner.plan(w_.resolution, path_.mesh(), tables,
                        {aim, aim, degree, degree, highest_guess_degree, most_first_elements, guess_cut});
    if (finer.degree == 0 || (finer.mesh.empty() && finer.degree == degree)) break;
    if (!finer.mesh.empty()) mesh_ = finer.mesh;
    start(mesh_, bend_, finer.degree);
    finer_found = true;
  }
  return finer_found;
}

bool Search::open_fitting(const std::function<void(const ElementTables&, Path&)>& fill, int degree) {
  fill(open(uniform_mesh(sketch_elements), Refinement::first_degree), path_);
  measure_frequency(problem_, w_.iteration.action(), refinement_.tables(), path_, w_.frequency);
  const int elements = first_elements(w_.frequency);
  if (!w_.frequency.finite() || elements > most_launched) return false;
  fill(open(w_.frequency.mesh(elements, guess_floor), degree), path_);
  return true;
}

}  // namespace extremal
