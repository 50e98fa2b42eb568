#pragma once

#include "scene/scene.hpp"
#include "study/extension.hpp"
#include "study/study.hpp"

namespace extremal {

/// Throws SceneError where a scene asks for what a Hamiltonian in phase space excludes.
void check_phase_space(const Scene& scene, const ExtendedScene& parts, Purpose purpose);

}  // namespace extremal
