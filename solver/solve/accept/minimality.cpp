#include "solve/accept/minimality.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/bounds.hpp"
#include "analysis/limits.hpp"
#include "linear/dense.hpp"
#include "problem/closing.hpp"
#include "solve/accept/limits.hpp"
#include "solve/accept/sparse_windows.hpp"
#include "solve/adapt/finer_elements.hpp"
#include "solve/newton/zero_eigenvalue.hpp"

namespace extremal {

namespace {

/// L = ½ q'ᵀMq' − V(q, t), M constant.
bool is_natural(const Structure& s) { return s.quadratic && s.velocity_free && s.gyroscopic.empty(); }

/// The longest window that the bound of M⁻¹V'' allows, also of the discrete action in use.
double longest_window(const Problem& problem, const SolveOptions& options, const Solution& solution) {
  const double unit = 1 / std::sqrt(*problem.curvature), pi = std::numbers::pi;
  if (!std::isfinite(unit)) return unit;
  if (!options.scheme) return unit * std::min(pi, window_bound(lobatto(solution.degree), 1));
  const double elements = pi * unit / solution.duration() * solution.trajectory.elements();
  const int whole = static_cast<int>(std::clamp(elements, 1.0, 1e9));
  return unit * std::min(pi, window_bound(*options.scheme, whole));
}

/// Whether ∂²L/∂q'∂q' is positive definite; between the ends alone, where it is not at one of them.
enum class LegendreCondition { holds, between_ends, fails };

/// Legendre's condition, ∂²L/∂q'∂q' > 0, at the ends and in the middle of elements, or where they are many at
/// some of these points.
LegendreCondition legendre_condition(const Lagrangian& lagrangian, const Trajectory& trajectory) {
  constexpr int most_points = 64;
  const Structure& s = lagrangian.structure();
  const int n = s.coordinates;
  if (s.quadratic) {
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
    for (const Triplet& entry : s.mass) mass(entry.row, entry.column) += entry.value;
    return positive_definite(mass) ? LegendreCondition::holds : LegendreCondition::fails;
  }
  LegendreCondition result = LegendreCondition::holds;
  const int points = std::min(2 * trajectory.elements(), most_points);
  std::vector<double> q(n), v(n);
  Scratch scratch;
  for (int k = 0; k <= points; ++k) {
    const double t = trajectory.duration() * k / points;
    trajectory.at(t, q, v);
    const PointValues values = evaluate_at(lagrangian, q, v, t, Order::hessian, scratch);
    if (!positive_definite(Eigen::Map<const Eigen::MatrixXd>(values.vv.data(), n, n))) {
      if (k > 0 && k < points) return LegendreCondition::fails;
      result = LegendreCondition::between_ends;
    }
  }
  return result;
}

/// Without pieces that minimise. If L_vv is not positive definite there are none, and the negative
/// eigenvalues are as many as the mesh has room for. Where it is not resolved, null ones are as little known.
double without_pieces(LegendreCondition legendre, Solution& solution) {
  solution.message += legendre == LegendreCondition::holds
                          ? "; no index and no windows are told: its second variation is not resolved"
                          : "; ∂²L/∂q'∂q' is not positive definite along it, so no part of it is a minimum";
  solution.morse_index.reset();
  if (legendre == LegendreCondition::holds) solution.nullity.reset();
  solution.minimizing = false;
  return INFINITY;
}

/// Morse's theorem: with fixed ends the index is the number of conjugate times. These are found on pieces
/// that resolve Jacobi fields, which elements that resolve the path need not. Of pinned elements it is their
/// own.
void count_conjugate_times(const Problem& problem, const SolveOptions& options, int count,
                           Solution& solution) {
  if (problem.ends.free > 0 || options.elements > 0 || solution.nullity != 0) return;
  solution.morse_index = count;
  solution.minimizing = count == 0;
}

/// Of many coordinates, few of them coupled: windows alone, where all conjugate times would take too long.
/// False where they would not, and where windows are not found so.
bool read_windows_alone(const Problem& problem, const SolveOptions& options, Solution& solution) {
  using namespace limits::windows;
  const double n = problem.coordinates(), elements = solution.trajectory.elements();
  const bool suits = n > always_found && problem.has_ends() && options.elements == 0 && !problem.curvature &&
                     !problem.lagrangian->kinks();
  const auto too_many = [&](int times) { return (times + forms * elements) * n * n * n > most_work; };
  if (!suits || !too_many(solution.morse_index.value_or(0))) return false;
  const bool fixed = problem.ends.free == 0 && solution.nullity == 0;
  std::optional<SparseWindows> found =
      sparse_windows(problem, solution.trajectory, fixed ? solution.morse_index : std::optional<int>());
  if (!found || !too_many(found->conjugate_times)) return false;
  solution.windows = std::move(found->windows);
  solution.conjugate_times_known = found->conjugate_times == 0;
  solution.certificate = Certificate::sampled;
  count_conjugate_times(problem, options, found->conjugate_times, solution);
  if (found->conjugate_times > 0)
    solution.message += fmt::format("; the {} conjugate times are not found: they would take too long",
                                    found->conjugate_times);
  return true;
}

bool assemble_own(const Problem& problem, const OwnElements* own, const ClosingMap* closed,
                  SecondVariation& memory) {
  return own && own->tables.unknowns() <= most_dense_unknowns &&
         memory.assemble_elements(problem.lagrangian, own->trajectory, own->path, own->tables, closed) &&
         memory.definite();
}

}  // namespace

double read_minimality(const Problem& problem, const SolveOptions& options, SecondVariation& memory,
                       Solution& solution, const OwnElements* own) {
  std::optional<ClosingMap> closed;
  if (problem.periodic) closed = closing_map(problem);
  const ClosingMap* map = closed ? &*closed : nullptr;
  memory.clear();
  if (read_windows_alone(problem, options, solution)) return INFINITY;
  const bool of_own = assemble_own(problem, own, map, memory);
  const bool assembled = of_own || memory.assemble(problem.lagrangian, solution.trajectory, {}, map);
  if (memory.too_large()) {
    solution.message += "; windows are not found: the forms of its elements need too much memory";
    return INFINITY;
  }
  if (memory.too_many()) {
    solution.message += "; windows are not found: Jacobi fields vary too fast for its elements";
    return INFINITY;
  }
  const LegendreCondition legendre = legendre_condition(*problem.lagrangian, solution.trajectory);
  // As of a radius at zero. The index is that of the second variation all the same.
  if (legendre == LegendreCondition::between_ends && !problem.periodic) {
    solution.message += "; ∂²L/∂q'∂q' is singular at an end, so windows and conjugate times are not told";
    return INFINITY;
  }
  if (!assembled || legendre != LegendreCondition::holds) {
    if (problem.periodic) memory.assemble(problem.lagrangian, solution.trajectory, {}, map, Definite::none);
    return without_pieces(legendre, solution);
  }
  const bool bounded = problem.curvature && is_natural(problem.lagrangian->structure());
  Minimality found =
      bounded ? minimality(memory, longest_window(problem, options, solution)) : minimality(memory);
  // A bound that the trajectory itself refutes proves nothing.
  const bool refuted = bounded && !found.within_longest;
  if (refuted) found = minimality(memory);
  solution.windows = std::move(found.windows);
  // T as the sum of the elements' lengths may differ by roundoff.
  if (!solution.windows.empty()) solution.windows.back()[1] = solution.duration();
  solution.conjugate_times_known = found.conjugate_times.has_value();
  if (found.conjugate_times) {
    solution.conjugate_times = *std::move(found.conjugate_times);
    count_conjugate_times(problem, options, static_cast<int>(solution.conjugate_times.size()), solution);
  } else {
    solution.message += "; conjugate times are not found: they would take too long";
  }
  solution.certificate = bounded && !refuted ? Certificate::global : Certificate::sampled;
  // Elements do not hide that the ends of the extremal they stand for are conjugate.
  if (of_own && problem.ends.free == 0)
    return memory.assemble(problem.lagrangian, solution.trajectory) ? minimality(memory).distance : INFINITY;
  return found.distance;
}

void read_index_at_open_end(const Problem& problem, const Path& path, const Outcome& outcome, Workspace& w,
                            Solution& solution) {
  if (!solution.morse_index || !solution.windows.empty() || !uses_gauss(*problem.lagrangian)) return;
  w.iteration.reset(problem, w.levels.finer(outcome.tables->scheme()), path.elements());
  w.iteration.forget();
  const double size = scales(path, *outcome.tables).q;
  w.iteration.set_scale(size);
  solution.morse_index.reset();
  solution.nullity.reset();
  solution.minimizing = false;
  if (!w.iteration.factor(path)) return;
  const Inertia inertia =
      w.iteration.model().inertia(zero_eigenvalue_along(size, outcome.error, path.elements()));
  solution.morse_index = inertia.negative;
  solution.nullity = inertia.zero;
  solution.minimizing = inertia.negative == 0 && inertia.zero == 0;
}

void confirm_index(const Problem& problem, const Path& path, const Outcome& outcome, Workspace& w,
                   Solution& solution) {
  if (!solution.morse_index) return;
  const ElementTables& tables = *outcome.tables;
  const Path& finer = on_finer_elements(problem, path, tables, limits::minimality::confirming, w);
  w.iteration.hold_shifts(outcome.shifts_held);
  if (finer.degree() > path.degree() && w.iteration.factor(finer)) {
    const double zero = zero_eigenvalue_along(scales(path, tables).q, outcome.error, path.elements());
    if (w.iteration.model().inertia(zero).negative == *solution.morse_index) return;
  }
  solution.message += ", which do not tell its index";
  solution.morse_index.reset();
  solution.nullity.reset();
  solution.minimizing = false;
}

}  // namespace extremal
