#pragma once

#include <vector>

#include "peers.hpp"
#include "records.hpp"

/// \file What was measured, as text on standard output.

namespace bench {

/// One line a tolerance.
void print_scene(const SceneRecord& scene);

/// Time at error: this library, the rivals of this run, the peers measured apart.
void print_summary(const std::vector<SceneRecord>& scenes, const Peers& peers);

/// Geometric means of others' times over ours at 1e-8 and 1e-11, over the boundary problems.
void print_means(const std::vector<SceneRecord>& scenes, const Peers& peers);

/// Error estimate over true error, one line a scene.
void print_honesty(const std::vector<SceneRecord>& scenes);

}  // namespace bench
