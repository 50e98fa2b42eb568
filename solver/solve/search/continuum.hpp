#pragma once

#include <functional>
#include <vector>

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Extremals between fixed ends that are conjugate, where they form a family.

namespace extremal {

/// Puts the guess on elements over a mesh.
using FillGuess =
    std::function<void(const ElementTables& tables, const std::vector<double>& mesh, Path& path)>;

/// The member of a family of extremals with these fixed ends that is nearest to the guess in L2, to the
/// tolerance. Steps of Newton's method leave out the null directions of the second variation; along these the
/// path goes to where its distance from the guess is stationary. There is a family if no force along the null
/// directions is left, neither there nor at members on both sides. Steps begin at the path that `start`
/// fills. False where there is none; the outcome is then of no use. `count` counts a step; false ends the
/// attempt.
bool nearest_of_family(const Problem& problem, const SolveOptions& options, Workspace& workspace,
                       std::vector<double> mesh, const FillGuess& fill, const FillGuess& start,
                       const std::function<bool()>& count, Outcome& outcome);

}  // namespace extremal
