#include "solve/accept/isolation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "solve/accept/limits.hpp"
#include "solve/adapt/finer_elements.hpp"
#include "solve/newton/resolve.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

namespace extremal {

using namespace limits::isolation;

namespace {

/// With doubles, where roundoff does not hide the eigenvalue. Beside a path at which it vanishes a step
/// halves it.
bool isolated_to_roundoff(NewtonIteration& newton, Path& path, double eigenvalue) {
  const std::optional<Stepped> next = take_step(newton, path);
  return next && next->contracted && std::abs(next->eigenvalue) > roundoff &&
         same_eigenvalue(eigenvalue, next->eigenvalue);
}

/// `index` was computed with 106 bits. If that of doubles differs by one, roundoff has changed the sign of
/// the least eigenvalue there. If it differs by more, elements do not resolve Jacobi fields, and pieces told
/// it. Where eigenvalues count as zero the sign of the least one is none of the index.
void set_index(int index, Solution& solution) {
  if (!solution.morse_index || solution.nullity.value_or(0) > 0 ||
      std::abs(*solution.morse_index - index) != 1)
    return;
  solution.morse_index = index;
  solution.minimizing = index == 0;
  solution.windows.clear();
  solution.conjugate_times.clear();
  solution.conjugate_times_known = false;
  solution.certificate = Certificate::none;
  solution.message += "; its index is known with 106 bits only, so windows and conjugate times are not told";
}

}  // namespace

bool soft(const Problem& problem, const Outcome& outcome, const Path& path, double eigenvalue, double error) {
  // Along free ends and durations natural conditions and double roots are judged by what is left of them.
  const bool held = problem.periodic || problem.infinite || problem.duration.free || problem.paired ||
                    problem.ends.free > 0;
  const double size = scales(path, *outcome.tables).q;
  return !held && outcome.family == 0 && std::abs(eigenvalue) < honest * doubt_of_eigenvalue(size, error);
}

void judge_isolation(const Problem& problem, const Path& path, const Outcome& outcome, double eigenvalue,
                     Workspace& w, Solution& solution) {
  const auto begin = [&](int by) -> Path& {
    Path& finer = on_finer_elements(problem, path, *outcome.tables, by, w);
    w.iteration.hold_shifts(outcome.shifts_held);
    return finer;
  };
  Path& finer = begin(raised);
  w.iteration.extend();
  bool found = isolated_to_roundoff(w.iteration, finer, eigenvalue);
  std::optional<int> index;
  if (!found) {
    const auto resolved_on = [&](int by) {
      begin(by);
      return resolve(w.iteration, finer);
    };
    // An eigenvalue that depends on the elements is theirs. One of doubles may be roundoff, which tells
    // nothing.
    const std::optional<Resolved> other =
        std::abs(eigenvalue) > roundoff ? Resolved{path.degree(), eigenvalue, 0} : resolved_on(2 * raised);
    const std::optional<Resolved> own = other ? resolved_on(raised) : std::nullopt;
    found = own && own->degree != other->degree && same_eigenvalue(other->eigenvalue, own->eigenvalue);
    if (found) index = own->index;
  }
  const double change = largest_change(path, finer);
  if (found && change <= std::max(outcome.tolerance, honest * solution.error_estimate)) {
    if (change <= outcome.tolerance) solution.error_estimate = std::max(solution.error_estimate, change);
    if (index) set_index(*index, solution);
    return;
  }
  solution.status = Status::not_converged;
  solution.message = fmt::format(
      "the path is not isolated, to its error: hardly a force holds it along one direction, as a shift in "
      "time of a part of it (the least eigenvalue of its second variation, by the diagonal, is {:.1e}, and "
      "another on finer elements); try a shorter duration",
      eigenvalue);
}

}  // namespace extremal
