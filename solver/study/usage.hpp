#pragma once

#include "scene/scene.hpp"

/// \file Whether what a scene gives has an effect.

namespace extremal {

/// Throws UnknownName at a parameter, written in the scene or by --set, that no formula of the scene or of
/// its system names, and that is not continued. Parameters of a system file are not the scene's.
void check_parameters_used(const Scene& scene);

}  // namespace extremal
