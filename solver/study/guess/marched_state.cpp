#include "study/guess/marched_state.hpp"

#include "motion/flow.hpp"
#include "solution/guessed_by.hpp"
#include "solve/solve.hpp"

namespace extremal {
namespace {

/// Of q, relative: more digits than a guess needs.
constexpr double march_tolerance = 1e-10;
/// Cubic interpolation between so many samples of an element keeps about six digits.
constexpr int samples_an_element = 64;

Problem initial_problem_of(const Problem& problem, std::span<const double> q, std::span<const double> p) {
  Problem initial;
  initial.lagrangian = problem.lagrangian;
  initial.copies = problem.copies;
  initial.names = problem.names;
  initial.boundary.coordinates = problem.coordinates();
  for (int a = 0; a < problem.coordinates(); ++a) initial.boundary.fix(a, false, q[a]);
  initial.duration.value = problem.duration.value;
  initial.initial = InitialData{{q.begin(), q.end()}, {p.begin(), p.end()}};
  return make_problem(std::move(initial));
}

}  // namespace

std::optional<Guess> motion_across_kinks(const Problem& problem, std::span<const double> q,
                                         std::span<const double> v, const Deadline& deadline) {
  if (!problem.motion().kinks() || problem.manifold || problem.phase) return std::nullopt;
  if (!Flow::suits(problem.motion(), problem.motion_copies())) return std::nullopt;
  std::vector<double> p(q.size());
  if (!Flow(problem.motion(), problem.motion_copies()).momentum(q, v, 0, p)) return std::nullopt;
  const Solution motion =
      Solver().solve(initial_problem_of(problem, q, p), {.tolerance = march_tolerance, .deadline = deadline});
  if (!motion.converged()) return std::nullopt;
  Guess guess = guess_of(motion.trajectory, samples_an_element);
  guess.samples_a_step = samples_an_element;
  return guess;
}

}  // namespace extremal
