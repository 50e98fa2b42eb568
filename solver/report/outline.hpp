#pragma once

#include <string>

#include "study/inspection.hpp"

/// \file A scene to begin with.

namespace extremal {

/// The text of a scene of a system: one of the library's, else ends at 0 and 1. Comments tell what the system
/// is and what each key means, those that the scene does not have included. Throws SceneError where a scene
/// of the library cannot be read.
std::string commented_scene(const SystemDescription& system);

}  // namespace extremal
