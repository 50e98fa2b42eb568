#include "solve/search/from_other_ends.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/search/limits.hpp"
#include "solve/search/near_guess.hpp"

namespace extremal {

using namespace limits::from_other_ends;

namespace {

/// Values of the relation for which the ends, moved by `share` of their way to the mean, would satisfy it.
void move_ends(const Problem& problem, const std::vector<double>& ends, double share, Problem& moved) {
  const int n = problem.coordinates();
  moved.boundary.value = problem.boundary.value;
  for (const Triplet& entry : problem.boundary.matrix) {
    const int a = entry.column % n;
    const double way = 0.5 * (ends[n + a] - ends[a]);
    moved.boundary.value[entry.row] += entry.value * share * (entry.column < n ? way : -way);
  }
  moved.ends = solve_relation(moved.boundary);
}

/// From a path with other ends, on its own elements, or on fewer where it was sharper with ends before.
bool refine_from(Pursuit& pursuit, const Path& other, const char* strategy) {
  Workspace& w = pursuit.w;
  const std::vector<double> mesh(other.mesh().begin(), other.mesh().end());
  const ElementTables& own = pursuit.open(mesh, other.degree());
  w.resolution.measure(other, own);
  const Resolution::Error aim{finest * scales(other, own).q, INFINITY, INFINITY};
  const Plan fewer = w.planner.plan(w.resolution, mesh, own,
                                    {.aim = aim,
                                     .tolerated = aim,
                                     .raised_degree = other.degree(),
                                     .least_degree = Refinement::first_degree + 1,
                                     .highest_degree = other.degree(),
                                     .most_elements = other.elements(),
                                     .strongest_cut = 1,
                                     .strongest_growth = strongest_growth});
  if (lavish * fewer.degree * fewer.mesh.size() < other.degree() * mesh.size() && !fewer.mesh.empty())
    pursuit.path.resample_from(other, pursuit.open(fewer.mesh, fewer.degree), fewer.mesh);
  else
    pursuit.path.copy_values(other);
  pursuit.refinement.take(pursuit.tables());
  pursuit.refinement.rebind();
  return pursuit.found(strategy);
}

bool solved_near_guess(Pursuit& pursuit) {
  GuessMesh guess(pursuit.problem);
  return pursue_near_guess(pursuit, guess).status == Status::converged;
}

}  // namespace

Trial through_other_ends(Pursuit& pursuit, const std::vector<double>& ends) {
  const Problem& problem = pursuit.problem;
  Refinement& refinement = pursuit.refinement;
  if (problem.periodic || problem.ends.free > 0 || problem.duration.free || problem.paired ||
      problem.infinite || problem.manifold)
    return Trial::none;
  const int left = refinement.steps_left();  // for what comes after
  const auto allow = [&](int steps) {
    refinement.allow(std::min(steps, pursuit.options.max_iterations - pursuit.outcome.attempts));
  };
  allow(pursuit.allowance());
  Problem nearer = problem;
  nearer.guess = {};
  SolveOptions options = pursuit.options;
  options.tolerance = std::max(options.tolerance, between);
  std::optional<Path> known;
  options.progress = {};  // the steps are counted here
  double share = first_share, part = first_part, tried = 1;
  while (!refinement.exhausted() && share > least_share && share < largest_share && part < largest_part) {
    const double next = known ? share * part : share;
    move_ends(problem, ends, next, nearer);
    Pursuit between_ends(nearer, options, pursuit.w);
    options.max_iterations = refinement.steps_left();
    between_ends.be_like(pursuit);
    between_ends.renew(effort);
    const bool reached = known ? refine_from(between_ends, *known, "") : solved_near_guess(between_ends);
    for (int k = between_ends.outcome.attempts; k > 0 && refinement.steps_left() > 0; --k)
      refinement.count_step();
    if (reached) {
      known = between_ends.path;
      share = next;
      part = std::max(part * part, smallest_part);
      if (share > nearer_by * tried) continue;
      tried = share;
      if (refine_from(pursuit, *known, "from ends nearer to each other")) return Trial::found;
    } else if (known) {
      part = std::sqrt(part);
    } else {
      share = 0.5 * (1 + share);
    }
  }
  refinement.rebind();
  allow(left);
  return Trial::in_vain;
}

}  // namespace extremal
