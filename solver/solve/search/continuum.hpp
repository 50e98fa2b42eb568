#pragma once

#include <functional>
#include <vector>

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Extremals that form a family, as between conjugate ends.

namespace extremal {

/// Puts the guess on elements over a mesh.
using FillGuess =
    std::function<void(const ElementTables& tables, const std::vector<double>& mesh, Path& path)>;

enum class FamilySearch {
  found,
  none,         ///< the second variation is singular, but a force along its null directions remains
  not_reached,  ///< neither was found
};

/// The member of a family of extremals that is nearest to the guess in L2, to the tolerance. Its ends satisfy
/// the boundary relation. Steps of Newton's method leave out the null directions of the second variation;
/// along these the path goes to where its distance from the guess is least. There is a family if no force
/// along the null directions is left, neither there nor at members on both sides. Steps begin at the path
/// that `start` fills. Unless one is found the outcome is of no use. `count` counts a step; false ends the
/// attempt.
FamilySearch nearest_of_family(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                               std::vector<double> mesh, const FillGuess& fill, const FillGuess& start,
                               const std::function<bool()>& count, Outcome& outcome);

}  // namespace extremal
