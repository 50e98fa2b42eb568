#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/search/limits.hpp"
#include "solve/search/search.hpp"

/// \file From ends that are nearer to each other to those wanted.

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

}  // namespace

/// Each time by so much of the way that is left that Newton's method still comes along: near a singularity,
/// or where a layer becomes thinner, that is an equal part of the way, not an equal length.
bool Search::through_other_ends() {
  if (problem_.periodic || problem_.ends.free > 0 || problem_.duration.free || problem_.paired ||
      problem_.infinite || problem_.manifold)
    return false;
  const int left = refinement_.steps_left();  // for what comes after
  const auto allow = [&](int steps) {
    refinement_.allow(std::min(steps, options_.max_iterations - outcome_.attempts));
  };
  allow(allowance_);
  Problem nearer = problem_;
  nearer.guess = {};
  SolveOptions options = options_;
  options.tolerance = std::max(options.tolerance, between);
  std::optional<Path> known;
  options.progress = {};  // the steps are counted here
  double share = first_share, part = first_part, tried = 1;
  met_.insert(Met::other_ends);
  while (!refinement_.exhausted() && share > least_share && share < largest_share && part < largest_part) {
    const double next = known ? share * part : share;
    move_ends(problem_, ends_, next, nearer);
    Search search(nearer, options, w_);
    options.max_iterations = refinement_.steps_left();
    search.be_like(*this);
    search.renew(effort);
    const bool reached =
        known ? search.refine_from(*known, "") : search.run_near_guess().status == Status::converged;
    for (int k = search.outcome().attempts; k > 0 && refinement_.steps_left() > 0; --k)
      refinement_.count_step();
    if (reached) {
      known = search.path();
      share = next;
      part = std::max(part * part, smallest_part);
      if (share > nearer_by * tried) continue;
      tried = share;
      if (refine_from(*known, "from ends nearer to each other")) return true;
    } else if (known) {
      part = std::sqrt(part);
    } else {
      share = 0.5 * (1 + share);
    }
  }
  refinement_.rebind();
  allow(left);
  return false;
}

/// From a path with other ends, on its own elements, or on fewer where it was sharper with ends before.
bool Search::refine_from(const Path& other, const char* strategy) {
  const std::vector<double> mesh(other.mesh().begin(), other.mesh().end());
  const ElementTables& own = open(mesh, other.degree());
  w_.resolution.measure(other, own);
  const Resolution::Error aim{finest * scales(other, own).q, INFINITY, INFINITY};
  const Plan fewer = w_.planner.plan(w_.resolution, mesh, own,
                                     {.aim = aim,
                                      .tolerated = aim,
                                      .raised_degree = other.degree(),
                                      .least_degree = Refinement::first_degree + 1,
                                      .highest_degree = other.degree(),
                                      .most_elements = other.elements(),
                                      .strongest_cut = 1,
                                      .strongest_growth = strongest_growth});
  if (lavish * fewer.degree * fewer.mesh.size() < other.degree() * mesh.size() && !fewer.mesh.empty())
    path_.resample_from(other, open(fewer.mesh, fewer.degree), fewer.mesh);
  else
    path_.copy_values(other);
  refinement_.take(tables());
  refinement_.rebind();
  return found(strategy);
}

}  // namespace extremal
