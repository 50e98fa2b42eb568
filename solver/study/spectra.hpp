#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/flat_norm.hpp"
#include "analysis/motion_spectrum.hpp"
#include "scene/scene.hpp"

/// \file [spectrum]: the lines of a solution, and how far they are from those of another.

namespace extremal {

struct Study;

/// What a scene asks for.
struct SpectrumRequest {
  int lines = 0;  ///< of each coordinate; 0: as many as the tolerance asks for
  std::optional<std::vector<std::vector<PointMass>>> against;  ///< Σ A_k δ(ω_k) of each coordinate
};

/// Reads the result that `against` names, beside the scene. Throws SceneError where it has no spectrum.
SpectrumRequest read_spectrum(const SpectrumTable& table, const std::string& scene,
                              const std::vector<std::string>& names);

struct SolutionSpectrum {
  MotionSpectrum motion;
  std::vector<double> flat_norm;  ///< of the difference from `against`; empty without it
};

/// Throws SceneError at `elements`, as the scene gives them, where they are too few for a spectrum.
void check_samples(const Study& study, const Location& elements);

/// Of a converged solution. Equal elements of a named scheme have the lines of their discrete trajectory.
/// Throws std::invalid_argument where the elements of such a scheme are too few.
SolutionSpectrum spectrum_of(const Study& study, const SpectrumRequest& request, const Solution& solution);

/// What is to be added to the message of the solution: of which coordinates the lines do not describe the
/// motion.
std::string unresolved_lines(const Study& study, const SolutionSpectrum& spectrum, double duration);

}  // namespace extremal
