#include "solve/search/continuum.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "solve/mesh/conservation.hpp"
#include "solve/search/family.hpp"
#include "solve/search/limits.hpp"

namespace extremal {

using namespace limits::continuum;

namespace {

/// Goes to a member whose distance from the guess is stationary. The null directions of the path are others
/// than those of the member: they are found again where steps have led. `near` if the path is near a member.
bool reach_member(ExtremalFamily& family, Path& path, double unit, bool near) {
  if (!near) {
    if (!family.find_null(path, softer, 1)) return false;
    if (!std::isfinite(family.step(path, true)) || !family.converge(path, true)) return false;
  }
  int without = 0;
  for (int round = 0; round < most_slides; ++round) {
    if (!family.find_null(path, null_eigenvalue)) return false;
    // Far from an extremal no direction need be null: a few whole steps lead nearer.
    if (family.null_directions() == 0) {
      if (++without == most_null_rounds) return false;
      for (int k = 0; k < whole_steps; ++k)
        if (!(family.step(path, false) > near_extremal * unit)) break;
      continue;
    }
    const double size = family.slide(path);
    if (size <= nearly * unit) return family.converge(path, true);
    if (!std::isfinite(size) || !family.converge(path, false)) return false;
  }
  return false;
}

/// Whether elements of a higher degree find the same member; `moved` becomes by how much theirs differs.
bool confirmed_by_higher_degree(const Problem& problem, Workspace& w, const Path& path, const Path& guess,
                                int null_directions, const std::function<bool()>& count, double& moved) {
  const ElementTables& finer = w.levels.at(family_degree + raised);
  const std::vector<double>& up = w.levels.raise(family_degree, family_degree + raised);
  Path higher, higher_guess;
  higher.interpolate_from(path, finer, up);
  higher_guess.interpolate_from(guess, finer, up);
  ExtremalFamily check(problem, count);
  check.reset(finer, higher_guess);
  if (!check.find_null(higher, null_eigenvalue) || check.null_directions() != null_directions) return false;
  if (!check.converge(higher, true)) return false;
  moved = 0;
  for (std::size_t k = 0; k < path.nodes().size(); ++k)
    moved = std::max(moved, std::abs(higher.nodes()[k] - path.nodes()[k]));
  return true;
}

std::vector<double> halves_of(const std::vector<double>& mesh) {
  std::vector<double> halves{0};
  for (std::size_t k = 1; k < mesh.size(); ++k) {
    halves.push_back(0.5 * (mesh[k - 1] + mesh[k]));
    halves.push_back(mesh[k]);
  }
  return halves;
}

/// Goes to the member nearest to the guess. Says what was met if there is no family.
FamilySearch reach_nearest(ExtremalFamily& family, Path& path, double unit) {
  if (!reach_member(family, path, unit, false)) return FamilySearch::not_reached;
  for (int k = 0; k < most_nearer; ++k) {
    if (!(family.force(path) <= largest_no_force)) return FamilySearch::none;
    std::optional<Path> closer;
    if (!family.extends(path, family.no_force(path), closer)) return FamilySearch::not_reached;
    if (!closer) return FamilySearch::found;
    path = *std::move(closer);
    if (!reach_member(family, path, unit, true)) return FamilySearch::not_reached;
  }
  return FamilySearch::not_reached;
}

const char* family_message(const Problem& problem) {
  if (problem.periodic)
    return "converged; this is one of a family of orbits of this period, the nearest to the guess";
  return problem.ends.free == 0
             ? "converged; the ends are conjugate, and this is one of a family of extremals with these ends, "
               "the nearest to the guess"
             : "converged; this is one of a family of extremals that satisfy the conditions at the ends, the "
               "nearest to the guess";
}

}  // namespace

FamilySearch nearest_of_family(const Problem& problem, const SolveOptions& options, Workspace& w,
                               std::vector<double> mesh, const FillGuess& fill, const FillGuess& start,
                               const std::function<bool()>& count, Outcome& outcome) {
  const ElementTables& tables = w.levels.at(family_degree);
  if (w.levels.at(family_degree + raised).unknowns() > most_dense_unknowns) return FamilySearch::not_reached;
  while (mesh.size() < 5) mesh = halves_of(mesh);
  Path guess, path;
  for (int halving = 0; halving <= most_family_halvings; ++halving) {
    if (halving > 0) mesh = halves_of(mesh);
    if (static_cast<int>(mesh.size()) > most_family_elements) return FamilySearch::not_reached;
    fill(tables, mesh, guess);
    if (halving == 0) {
      start(tables, mesh, path);
    } else {
      const Path before = path;
      path.resample_from(before, tables, mesh);
    }
    ExtremalFamily family(problem, count);
    family.reset(tables, guess);
    const FamilySearch reached = reach_nearest(family, path, unit_of(path, tables));
    if (reached == FamilySearch::not_reached) return reached;
    w.resolution.measure(path, tables);
    const Scales size = scales(path, tables);
    const Resolution::Error error = w.resolution.at(family_degree);
    const double allowed = family_share * options.tolerance, unit = unit_of(guess, tables);
    // A path of roundoff is at rest, and has no size.
    const bool at_rest = size.q <= roundoff_of_guess * unit;
    const double extent = at_rest ? unit : size.q;
    const bool moves = size.v * path.duration() > roundoff_of_guess * unit;
    if (!at_rest && error.q > allowed * size.q) continue;
    if (moves && error.v > momentum_tolerances * allowed * size.v) continue;
    if (reached == FamilySearch::none) return reached;
    double moved = 0;
    if (!confirmed_by_higher_degree(problem, w, path, guess, family.null_directions(), count, moved))
      return FamilySearch::not_reached;
    if (moved > allowed * extent) continue;
    outcome.index_across = family.index(path);
    outcome.family = family.dimension();
    outcome.tables = &tables;
    outcome.error = error.q + moved;
    outcome.tolerance = options.tolerance * extent;
    outcome.path = std::move(path);
    outcome.message = family_message(problem);
    return FamilySearch::found;
  }
  return FamilySearch::not_reached;
}

}  // namespace extremal
