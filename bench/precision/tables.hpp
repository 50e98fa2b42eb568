#pragma once

#include <optional>
#include <string>
#include <vector>

#include "peers.hpp"
#include "records.hpp"

/// \file What was measured, as text on standard output.

namespace bench {

/// "-" where there is none.
std::string microseconds(std::optional<double> seconds);
/// Of another's time to ours.
std::string ratio(std::optional<double> other, std::optional<double> ours);

/// One line a tolerance.
void print_scene(const SceneRecord& scene);

/// Time at error: this library, the rivals of this run, the peers measured apart.
void print_summary(const std::vector<SceneRecord>& scenes, const Peers& peers);

/// Geometric means of others' times over ours at 1e-8 and 1e-11, over the boundary problems.
void print_means(const std::vector<SceneRecord>& scenes, const Peers& peers);

/// Error estimate over true error, one line a scene.
void print_honesty(const std::vector<SceneRecord>& scenes);

}  // namespace bench
