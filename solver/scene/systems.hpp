#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

/// \file System files: a Lagrangian with its documentation, to be used by scenes; and the scenes of the
/// library.

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

/// An entry of [about].
struct AboutEntry {
  std::string name;
  std::vector<std::string> texts;
};

struct SystemDescription {
  std::string name, path;
  std::vector<AboutEntry> about;  ///< in the order of the file
  SystemTable system;
  std::vector<std::string> scenes;  ///< paths of the scenes that use it
};

/// The system file of a name in the working folder or as above. Throws as read_system does; `command` is
/// what the name was given to.
SystemDescription describe_system(const std::string& name, const std::string& command);

/// A scene of the library, and the name of the system file that it uses, if it does.
struct SceneFile {
  std::string name, path, system;
};

/// Every scene in the directories that find_scene() looks into, by name; the first of a name counts.
std::vector<SceneFile> scene_files();

/// The path of a scene of the library, with or without ".toml": in the directories of EXTREMAL_PROBLEMS (and
/// scenes/ in them), installed and in the source; "" if there is none.
std::string find_scene(const std::string& name);

}  // namespace extremal
