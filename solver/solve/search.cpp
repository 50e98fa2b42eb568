#include "solve/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Elements are at most this long in units of 1/ω, ω the local frequency along the guess.
constexpr double longest_element = 2.0;
constexpr int most_first_elements = 1 << 12;
/// A mesh whose elements differ less than this is not worth starting again for.
constexpr double mild_grading = 3;
/// Newton steps in all, times unknowns of the first mesh: what other guesses may cost.
constexpr double most_work = 1e6;
constexpr double least_steps = 100;
/// Tries to move the default guess to where L is finite.
constexpr unsigned most_bends = 8;
/// Of the guess's extent, in turn.
constexpr double noise_sizes[] = {0.1, 0.3, 0.6};

int first_elements(const Frequency& frequency) {
  const double wanted = std::min<double>(frequency.phase() / longest_element, most_first_elements);
  return lanes * std::max(1, static_cast<int>(std::ceil(wanted / lanes)));
}

}  // namespace

Search::Search(const Problem& problem, const SolveOptions& options, Workspace& workspace)
    : problem_(problem),
      options_(options),
      w_(workspace),
      refinement_(problem, options, workspace, outcome_) {}

void Search::start(const std::vector<double>& mesh, const Bend& bend) {
  refinement_.open(mesh);
  start_path(problem_, ends_, refinement_.tables(), w_.path);
  bend_path(bend, refinement_.tables(), w_.path);
}

/// Puts the guess on a mesh that follows the frequency along it. The default guess is moved aside until L
/// is finite on it; false if it never is.
bool Search::begin(std::vector<double>& mesh, Bend& bend) {
  mesh = uniform_mesh(lanes);
  for (unsigned seed = 0; seed <= most_bends; ++seed) {
    bend = {0.1 * seed, seed};
    start(mesh, bend);
    measure_frequency(problem_, w_.iteration.action(), refinement_.tables(), w_.path, w_.frequency);
    if (w_.frequency.finite()) break;
    if (problem_.guess.given() || seed == most_bends) return false;
  }
  const int elements = first_elements(w_.frequency);
  const double floor = problem_.guess.given() ? 0.25 : 1.0;
  if (elements == lanes && w_.frequency.grading(floor) < mild_grading) return true;
  mesh = w_.frequency.mesh(elements, floor);
  start(mesh, bend);
  return true;
}

/// Finer elements first, then the guess with noise, while the steps allowed last.
Refinement::Result Search::from_other_guesses(const std::vector<double>& mesh, const Bend& bend) {
  const std::string first_failure = outcome_.message;
  start(halved(mesh), bend);
  Refinement::Result result = refinement_.pursue();
  for (unsigned k = 0; result == Refinement::Result::failed && !refinement_.exhausted(); ++k) {
    outcome_.strategy = "newton from the guess plus smooth noise";
    start(mesh, {noise_sizes[k % std::size(noise_sizes)], k});
    result = refinement_.pursue();
  }
  if (result == Refinement::Result::failed) {
    outcome_.status = Status::iteration_limit;
    outcome_.message = fmt::format(
        "{} Newton steps from the guess and others found no extremal (from the guess: {}); "
        "try a better guess or a shorter duration",
        outcome_.iterations, first_failure);
  }
  return result;
}

Outcome Search::run() {
  ends_ = starting_ends(problem_);
  outcome_.message = "the action is not finite along the guess";
  std::vector<double> mesh;
  Bend bend;
  if (!begin(mesh, bend)) return outcome_;
  const double unknowns = static_cast<double>(refinement_.tables().unknowns()) * w_.path.elements();
  refinement_.allow(
      std::min(options_.max_iterations, static_cast<int>(std::max(least_steps, most_work / unknowns))));
  Refinement::Result result = refinement_.pursue();
  if (result == Refinement::Result::failed) result = from_other_guesses(mesh, bend);
  const bool converged = result == Refinement::Result::converged;
  if (converged) outcome_.status = Status::converged;
  if (converged ? !refinement_.confirmed() : refinement_.suspicious()) {
    outcome_.status = Status::conjugate_ends;
    outcome_.message =
        "the second variation is singular or nearly so: the ends may be conjugate, with no extremal or a "
        "family of them; move an end or the duration";
  }
  return outcome_;
}

}  // namespace extremal
