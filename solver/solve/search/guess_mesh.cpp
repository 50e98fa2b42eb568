#include "solve/search/guess_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::guess_mesh;

namespace {

/// Of the integrator that a motion comes from.
std::size_t steps_of(const Guess& motion) { return (motion.tau.size() - 1) / motion.samples_a_step; }

int first_elements(const Frequency& frequency) {
  const double wanted = std::min<double>(frequency.phase() / longest_element, most_first_elements);
  return most_lanes * std::max(1, static_cast<int>(std::ceil(wanted / most_lanes)));
}

/// Along the path.
const Frequency& measure_frequency(Pursuit& pursuit) {
  Workspace& w = pursuit.w;
  measure_frequency(pursuit.problem, w.iteration.action(), pursuit.tables(), pursuit.path, w.frequency);
  return w.frequency;
}

}  // namespace

bool open_fitting(Pursuit& pursuit, const std::function<void(const ElementTables&, Path&)>& fill,
                  int degree) {
  fill(pursuit.open(uniform_mesh(sketch_elements), Refinement::first_degree), pursuit.path);
  const Frequency& frequency = measure_frequency(pursuit);
  const int elements = first_elements(frequency);
  if (!frequency.finite() || elements > most_launched) return false;
  fill(pursuit.open(frequency.mesh(elements, guess_floor), degree), pursuit.path);
  return true;
}

void GuessMesh::fill(const Bend& bend, const ElementTables& tables, Path& path) const {
  start_path(*guess_, ends_, tables, path);
  bend_path(problem_, bend, tables, path);
}

void GuessMesh::start(Pursuit& pursuit, const std::vector<double>& mesh, const Bend& bend, int degree) const {
  fill(bend, pursuit.open(mesh, degree), pursuit.path);
}

void GuessMesh::start(Pursuit& pursuit, int degree) const { start(pursuit, mesh_, bend_, degree); }

GuessMesh::Kind GuessMesh::begin(Pursuit& pursuit) {
  const Frequency& frequency = pursuit.w.frequency;
  ends_ = starting_ends(*guess_);
  mesh_ = uniform_mesh(most_lanes);
  for (unsigned seed = 0; seed <= most_bends; ++seed) {
    bend_ = {0.1 * seed, seed};
    start(pursuit);
    if (measure_frequency(pursuit).finite()) break;
    if (guess_->guess.given() || seed == most_bends || pursuit.options.deadline.passed())
      return Kind::undefined;
  }
  int elements = first_elements(frequency);
  const double floor = guess_->guess.given() ? guess_floor : 1.0;
  // A sketch of an orbit may pass a collision; elements for it serve no other path.
  const bool colliding = problem_.periodic && !guess_->guess.motion() && elements > most_launched &&
                         frequency.grading(floor) > collision;
  if (colliding) elements = most_launched;
  if (elements > pursuit.path.elements() || frequency.grading(floor) >= mild_grading) {
    mesh_ = frequency.mesh(elements, floor);
    start(pursuit);
  }
  if (guess_->guess.motion() && !mesh_of_motion(pursuit, frequency)) resolve(pursuit);
  end_at_kinks(pursuit);
  phase_ = std::max(1.0, frequency.phase());
  return colliding ? Kind::colliding : Kind::usable;
}

GuessMesh::Kind GuessMesh::prepare(Pursuit& pursuit) {
  pursuit.outcome.message = "the action is not finite along the guess";
  const Kind kind = begin(pursuit);
  if (kind != Kind::undefined) pursuit.measure_first_path();
  return kind;
}

Pursuit::Result GuessMesh::pursue(Pursuit& pursuit, const char* strategy) {
  const Pursuit::Result first = pursuit.pursue(strategy);
  const std::vector<double> mesh = mesh_;
  Pursuit::Result result = first;
  for (const auto more : {&GuessMesh::put_on_steps_of_motion, &GuessMesh::take_more_digits}) {
    if (result.converged() || pursuit.options.deadline.passed()) return result;
    if (!(this->*more)(pursuit)) continue;
    pursuit.refinement.allow(pursuit.allowance());
    result = pursuit.pursue(strategy);
  }
  if (result.converged()) return result;
  mesh_ = mesh;
  return first;
}

/// Elements end where the guess crosses kinks of L. Coarse ones would miss crossings that follow each other.
void GuessMesh::end_at_kinks(Pursuit& pursuit) {
  const Kinks* const kinks = pursuit.tables().kinks();
  if (!kinks || !guess_->guess.given()) return;
  const std::vector<double> mesh(pursuit.path.mesh().begin(), pursuit.path.mesh().end());
  const int degree = pursuit.path.degree(), samples = static_cast<int>(guess_->guess.tau.size());
  start(pursuit, uniform_mesh(std::clamp(samples / degree, least_sampled, most_sampled)), bend_, degree);
  const std::vector<double> times = crossings(*kinks, pursuit.path);
  mesh_ = with_nodes(mesh, times);
  start(pursuit, degree);
  if (times.empty() || pursuit.refinement.mesh_kept()) return;
  // Forces that jump inside an element look like a high frequency there.
  const Frequency& frequency = measure_frequency(pursuit);
  if (!frequency.finite()) return;
  mesh_ = with_nodes(frequency.mesh(first_elements(frequency), guess_floor), times);
  start(pursuit, degree);
}

/// A motion that took its integrator so many steps passes one encounter after the other, which elements would
/// find one by one: each of them covers as many steps. So they do beside a collision, where the frequency
/// asks for more. False elsewhere.
bool GuessMesh::mesh_of_motion(Pursuit& pursuit, const Frequency& frequency) {
  const std::size_t wanted = steps_of(guess_->guess) / steps_an_element;
  const std::size_t elements = (wanted / most_lanes + 1) * most_lanes;
  const bool many = wanted >= least_kept && wanted <= most_kept;
  const bool collides = frequency.grading(guess_floor) > collision;
  if (!many && !(collides && elements < static_cast<std::size_t>(pursuit.path.elements()))) return false;
  put_on_motion(pursuit, elements);
  if (many) pursuit.refinement.keep_mesh();
  return true;
}

/// On elements of equally many samples each: they are as long as the steps of the integrator.
void GuessMesh::put_on_motion(Pursuit& pursuit, std::size_t elements) {
  const std::vector<double>& tau = guess_->guess.tau;
  const std::size_t samples = tau.size() - 1;
  mesh_.resize(elements + 1);
  for (std::size_t k = 0; k <= elements; ++k) mesh_[k] = tau[k * samples / elements];
  start(pursuit, kept_degree);
}

/// A motion that passes a singularity closely is resolved there by the steps of its integrator; coarser
/// elements follow it only relative to its whole range. They are kept, whatever the tolerance. False where
/// they are already, or for other guesses.
bool GuessMesh::put_on_steps_of_motion(Pursuit& pursuit) {
  if (!guess_->guess.motion() || pursuit.refinement.mesh_kept()) return false;
  const std::size_t elements = (steps_of(guess_->guess) / most_lanes + 1) * most_lanes;
  if (elements <= static_cast<std::size_t>(pursuit.path.elements()) || elements > most_kept) return false;
  put_on_motion(pursuit, elements);
  pursuit.refinement.keep_mesh();
  return true;
}

/// The same elements for the same motion, with factors that have more digits; false if it was not followed.
/// Errors of the elements are amplified as roundoff is: where the first step amplifies all that doubles have
/// lost, their degree is higher.
bool GuessMesh::take_more_digits(Pursuit& pursuit) {
  if (!pursuit.refinement.mesh_kept()) return false;
  start(pursuit, kept_degree);
  const bool lost = pursuit.refinement.loses_digits();
  if (lost) start(pursuit, exact_degree);
  pursuit.refinement.set_digits(lost ? Refinement::Digits::doubled : Refinement::Digits::doubled_where_lost);
  pursuit.refinement.keep_mesh();
  return true;
}

bool GuessMesh::resolve(Pursuit& pursuit) {
  Workspace& w = pursuit.w;
  const Path& path = pursuit.path;
  bool finer_found = false;
  const double goal = guess_->guess.motion()
                          ? std::clamp(pursuit.options.tolerance, best_guess_goal, guess_goal)
                          : guess_goal;
  const int samples = static_cast<int>(guess_->guess.tau.size());
  for (int pass = 0; pass < most_passes; ++pass) {
    const ElementTables& tables = pursuit.tables();
    const int degree = path.degree(), elements = path.elements();
    w.resolution.measure(path, tables);
    const Resolution::Error error = w.resolution.at(degree);
    const Scales size = scales(path, tables);
    const Resolution::Error aim{goal * size.q, slope_goal * goal * size.v};
    if ((error.q <= aim.q && error.v <= aim.v) || elements * degree >= samples) break;
    const Frequency& frequency = measure_frequency(pursuit);
    if (const int wanted = first_elements(frequency); frequency.finite() && wanted > elements) {
      mesh_ = frequency.mesh(wanted, guess_floor);
      start(pursuit, degree);
      finer_found = true;
      continue;
    }
    const Plan finer =
        w.planner.plan(w.resolution, path.mesh(), tables,
                       {aim, aim, degree, degree, highest_guess_degree, most_first_elements, guess_cut});
    if (finer.degree == 0 || (finer.mesh.empty() && finer.degree == degree)) break;
    if (!finer.mesh.empty()) mesh_ = finer.mesh;
    start(pursuit, finer.degree);
    finer_found = true;
  }
  return finer_found;
}

}  // namespace extremal
