#include "solve/phase_space_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "action/scheme.hpp"
#include "machine/clock.hpp"
#include "problem/phase_space.hpp"
#include "problem/point_range.hpp"
#include "problem/reduction.hpp"
#include "solution/guessed_by.hpp"
#include "solution/in_phase_space.hpp"
#include "solve/guess/hamilton_path.hpp"
#include "solve/limits.hpp"
#include "solve/periodic/equilibrium.hpp"

namespace extremal {

using namespace limits::phase_space;

namespace {

bool is_rectangle(const Scheme& scheme) {
  return scheme.quadrature == Quadrature::left || scheme.quadrature == Quadrature::right;
}

class PhaseSpaceSolve {
 public:
  PhaseSpaceSolve(const Problem& problem, const SolveOptions& options, const PhaseSpaceSolver& solve)
      : problem_(problem), options_(options), solve_(solve) {}

  Solution run() {
    if (options_.scheme && is_rectangle(*options_.scheme)) return run_rectangle();
    Solution solution = first();
    if (solution.converged() && options_.elements == 0) solution = with_exact_momenta(std::move(solution));
    observe_in_phase_space(problem_, solution);
    return solution;
  }

 private:
  /// By the midpoint rule with shifted points. Its error is told by the motion itself, as finer elements
  /// would have the same shift.
  Solution run_rectangle() {
    const double half = 0.5 * problem_.duration.value / options_.elements;
    const Problem shifted =
        with_shift(problem_, options_.scheme->quadrature == Quadrature::left ? half : -half);
    SolveOptions midpoint = options_;
    midpoint.scheme = scheme("midpoint");
    Solution solution = PhaseSpaceSolve(shifted, midpoint, solve_).first();
    if (!solution.converged()) return solution;
    const SolveOptions adaptive = options_.adaptive();
    const Problem near = problem_.initial ? problem_ : guessed_by(problem_, solution);
    const Solution motion = PhaseSpaceSolve(near, adaptive, solve_).first();
    if (!motion.converged()) {
      Solution refused;
      refused.message =
          "the error of the rectangles is not known, because without a scheme: " + motion.message;
      return after(solution, std::move(refused));
    }
    solution.error_estimate =
        largest_difference(solution.trajectory, motion.trajectory) + motion.error_estimate;
    solution.element_energies = shifted_energies(shifted, solution.trajectory);
    observe_in_phase_space(problem_, solution);
    return after(motion, std::move(solution));
  }

  /// The range is compared with that of the guess itself: a path near Hamilton's equations that takes its
  /// place may rest already.
  Solution solved(const Problem& problem, const SolveOptions& options, bool near_guess) {
    Solution solution = solve_(problem, options, near_guess);
    if (!solution.converged()) return solution;
    if (problem.periodic && shrank(problem, largest_range(solution.trajectory.nodes, problem.coordinates()),
                                   largest_range(problem_.guess.q, problem.coordinates())))
      return refused(fmt::format("{}; try a larger guess or another duration", shrank_to_rest), solution);
    const double defect = phase_defect(problem, solution.trajectory, solution.degree);
    const double allowed = std::clamp(defect_tolerances * options.tolerance, least_defect, most_defect);
    if (defect <= allowed) return solution;
    return refused(
        fmt::format("Hamilton's equations do not hold on the path found: within the duration it leaves "
                    "them by {:.1e} times its range; {}",
                    defect,
                    problem.periodic
                        ? "try another guess, also one that turns the other way"
                        : "the conditions at the ends may contradict each other, else try another guess"),
        solution);
  }

  static Solution refused(std::string message, const Solution& found) {
    Solution result;
    result.status = Status::no_solution_near;
    result.message = std::move(message);
    result.strategy = found.strategy;
    return after(found, std::move(result));
  }

  Solution first() {
    Solution solution = solved(problem_, options_, !problem_.initial);
    if (problem_.initial || solution.converged() || options_.deadline.passed()) return solution;
    const auto start = Clock::now();
    std::optional<Problem> near = near_hamilton_path(problem_, options_.deadline);
    if (near) near->reduction = reduction_of(*near);
    solution.seconds_solve += seconds_since(start);
    if (near) solution = after(solution, solved(*near, options_, false));
    // A named scheme has searched already.
    if (solution.converged() || options_.scheme || options_.deadline.passed()) return solution;
    return after(solution, solved(problem_, options_, false));
  }

  /// The tolerance is one of the largest range of any coordinate; the range of q may be smaller, or that of
  /// p.
  Solution with_exact_momenta(Solution solution) {
    const PhaseRanges ranges = phase_ranges(problem_, solution.trajectory);
    const double allowed = options_.tolerance * std::min(ranges.q, momentum_tolerances * ranges.p);
    const double most = std::max(ranges.q, ranges.p);
    if (!(allowed > 0) || solution.error_estimate <= allowed || problem_.initial) return solution;
    SolveOptions tighter = options_;
    tighter.tolerance = std::max(allowed / most, tightest_for_momenta);
    Solution better = solved(guessed_by(problem_, solution), tighter, true);
    if (!better.converged()) return solution;
    better.strategy = solution.strategy;
    return after(solution, std::move(better));
  }

  /// With the work of the one before.
  static Solution after(const Solution& before, Solution solution) {
    solution.iterations += before.iterations;
    solution.seconds_solve += before.seconds_solve;
    solution.seconds_analyse += before.seconds_analyse;
    return solution;
  }

  const Problem& problem_;
  const SolveOptions& options_;
  const PhaseSpaceSolver& solve_;
};

}  // namespace

Solution solve_in_phase_space(const Problem& problem, const SolveOptions& options,
                              const PhaseSpaceSolver& solve) {
  return PhaseSpaceSolve(problem, options, solve).run();
}

}  // namespace extremal
