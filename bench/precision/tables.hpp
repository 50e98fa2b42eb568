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

/// Error estimate over true error, one line a scene.
void print_honesty(const std::vector<SceneRecord>& scenes);

/// The least over the columns of peer_time; nothing where no peer has a time.
std::optional<double> best_peer(const Peers& peers, const std::string& scene, double error);

}  // namespace bench
