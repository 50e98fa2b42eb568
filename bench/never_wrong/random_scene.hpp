#pragma once

#include <cstdint>
#include <string>

#include "catalogue.hpp"

/// \file Scenes from seeds.

namespace bench {

struct RandomScene {
  std::string system;
  std::string kind;    ///< of its ends: "fixed", "natural", "mixed", "coupled", "periodic", "free", "search",
                       ///< "family"; "kept" from a file
  bool known = false;  ///< made from a motion, so that it has a solution
  std::string text = {};  ///< TOML
};

/// The scene number `index` of a seed; `only` names a system, empty for any. `scratch` is a file that may be
/// written over.
RandomScene random_scene(std::uint64_t seed, std::uint64_t index, const std::string& only,
                         const std::string& scratch);

/// The scene in a file, as one that was kept.
RandomScene read_scene_file(const std::string& path);

/// Throws std::runtime_error if it cannot be written.
void write_text(const std::string& path, const std::string& text);

}  // namespace bench
