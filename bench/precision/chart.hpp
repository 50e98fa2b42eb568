#pragma once

#include <string>
#include <vector>

#include "peers.hpp"
#include "records.hpp"

/// \file Time against true error as a picture.

namespace bench {

/// Draws a panel for each of six scenes of different kinds that were measured, as SVG, through gnuplot.
/// Throws std::runtime_error if there is nothing to draw or gnuplot fails.
void draw_chart(const std::string& path, const std::vector<SceneRecord>& scenes, const Peers& peers);

}  // namespace bench
