#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "solve/fit/fit.hpp"
#include "study/fit/fitted_scene.hpp"
#include "system/formula.hpp"

/// \file [fit]: what observations determine of a scene.

namespace extremal {

struct Study;

/// What a scene asks for.
struct FitRequest {
  FitTask task;                                    ///< but for the solver
  std::vector<std::string> parameters, open_ends;  ///< names of the unknowns, in their order
  /// The same without the guess of the scene, if that has one: from the observations. Throws SceneError.
  std::function<std::shared_ptr<const FitRequest>()> from_data = {};
  /// The same for another duration, where one is given and ends at T are open. Throws SceneError.
  std::function<std::shared_ptr<const FitRequest>(double duration)> lasting = {};
};

/// The path that was observed; no guess unless all coordinates were. Throws SceneError.
Guess observed_path(const FitTable& table, const std::string& scene, const System& system,
                    const Problem& problem);

/// Reads [fit] of a scene, of which the rest of the study stands; `load` makes problems of scenes like it.
/// Throws SceneError.
std::shared_ptr<FitRequest> read_fit(const Scene& scene, const Study& study, const ProblemOf& load);

/// Fits `repeat` times from the same guess, as run() solves; where a fit from the guess of the scene fails,
/// from the observations. Throws std::invalid_argument if repeat < 1, or
/// without a [fit].
FitResult run_fit(const Study& study, int repeat = 1,
                  const std::function<void(const FitStep&)>& progress = {});

/// The Lagrangian of the study becomes that with these values of the unknowns: momenta are read off with it.
/// Does nothing without a [fit].
void use_fitted(std::span<const double> values, Study& study);

}  // namespace extremal
