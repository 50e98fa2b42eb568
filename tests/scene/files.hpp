#pragma once

#include <string>
#include <vector>

#include "machine/folder.hpp"
#include "scene/scene.hpp"

/// \file The message that a scene gets.

namespace extremal::test {

class SceneFiles : public InFolder {
 protected:
  /// The message without the folder's name; "" if the scene is accepted.
  std::string message(const std::string& content, const std::vector<std::string>& sets = {}) {
    return message_of(write("scene.toml", content), sets);
  }
  std::string message_of(const std::string& path, const std::vector<std::string>& sets = {}) {
    try {
      read_scene(path, sets);
      return "";
    } catch (const SceneError& e) {
      return without_folder(e.what());
    }
  }
};

/// A complete scene, each line known: 1 [system], 4 [boundary].
inline const std::string pendulum =
    "[system]\n"
    "coordinates = [\"q\"]\n"
    "lagrangian = \"q'^2/2 + cos(q)\"\n"
    "[boundary]\n"
    "start = { q = 0 }\n"
    "end = { q = 1 }\n"
    "duration = 2\n";

}  // namespace extremal::test
