#include "solve/accept/conjugate_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/windows.hpp"
#include "solve/accept/limits.hpp"
#include "solve/accept/refuse.hpp"
#include "solve/adapt/finer_elements.hpp"
#include "solve/newton/converge.hpp"

namespace extremal {

using namespace limits::conjugate_ends;

namespace {

bool fixed(const Problem& problem) { return problem.ends.free == 0 && !problem.duration.free; }

/// By how much the nodes move when elements get a higher degree; infinite if Newton's method then fails.
double moved_by_finer_elements(const Problem& problem, const Path& path, const ElementTables& tables,
                               Workspace& w, double goal) {
  Path& other = on_finer_elements(problem, path, tables, finer, w);
  if (!converge(w.iteration, other, w.levels.at(other.degree()), {goal, steps}, {}).reached) return INFINITY;
  double moved = 0;
  for (std::size_t k = 0; k < path.nodes().size(); ++k)
    moved = std::max(moved, std::abs(other.nodes()[k] - path.nodes()[k]));
  return moved;
}

}  // namespace

void judge_conjugate_ends(const Problem& problem, const SolveOptions& options, const Path& path,
                          const ElementTables& tables, double distance, Workspace& w, Solution& solution) {
  const double T = solution.duration(), size = scales(path, tables).q;
  // Where conjugate times are many, one of them is never far.
  if (!fixed(problem) || distance > near * T / (1.0 + solution.conjugate_times.size())) return;
  const double known = size > 0 ? solution.error_estimate / size : 0;
  if (distance <= T * std::clamp(known, least_distance, largest_distance))
    return refuse(
        solution, Status::conjugate_ends,
        fmt::format("the ends are conjugate: a Jacobi field vanishes at t = 0 and, within the error, {:.1e} "
                    "from T = {:.10g}; there is no extremal or a family of them; move an end or change the "
                    "duration",
                    distance, T));
  const double moved = size > 0 && !options.scheme
                           ? moved_by_finer_elements(problem, path, tables, w, 0.1 * options.tolerance)
                           : 0;
  const double amplified = moved + roundoff * T / distance * size;
  solution.error_estimate += amplified;
  const double allowed = options.elements > 0 ? INFINITY : options.tolerance * size;
  if (amplified > 0.1 * allowed && !(solution.error_estimate <= allowed))
    refuse(solution, Status::not_converged,
           fmt::format(
               "the ends are nearly conjugate: a Jacobi field vanishes at t = 0 and {:.1e} from T = {:.10g}. "
               "This amplifies errors beyond the tolerance {:.1e}; move an end or change the duration",
               distance, T, options.tolerance));
}

bool failed_at_conjugate_ends(const Problem& problem, const Trajectory& last, SecondVariation& memory) {
  if (!fixed(problem) || problem.coordinates() > most_examined) return false;
  if (last.elements() > most_elements) return false;
  if (!memory.assemble(problem.lagrangian, last)) return false;
  return minimality(memory).distance <= suspicious * last.duration();
}

}  // namespace extremal
