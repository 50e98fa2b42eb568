#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

/// \file System files: a Lagrangian with its documentation, to be used by scenes.

namespace extremal {

/// A system file's name and the first line of its [about].
struct SystemFile {
  std::string name, path, about;
};

/// Every system file in the directories of EXTREMAL_PROBLEMS (and systems/ in them), installed and in the
/// source, by name; the first of a name counts. Files that cannot be read or are scenes are left out.
std::vector<SystemFile> system_files();

/// The [system] of the file that `use` names, with or without ".toml": beside the scene, then as above.
/// Scenes are passed over, so that a scene may have the name of its system. Throws UnknownName, or SceneError
/// if the file is no system file.
SystemTable read_system(const Text& use, const std::string& scene_path);

}  // namespace extremal
