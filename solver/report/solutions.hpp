#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/layout.hpp"

/// \file Several solutions in one picture.

namespace extremal {

/// All solutions, the first one first.
std::vector<const Samples*> solutions_of(const Picture& picture);

/// The waypoints of a solution, counted from 0.
const std::vector<WaypointImpulse>& waypoints_of(const Picture& picture, std::size_t solution);

/// The paths of the bodies of one solution, in distinct colours.
std::vector<BodyPath> body_paths(const Samples& samples, const Bodies& bodies,
                                 const std::vector<WaypointImpulse>& waypoints = {});
/// Whether every body ends where it began.
bool returns(const Samples& samples, const Bodies& bodies);

/// What is drawn of a picture: a lone coordinate with its velocity, paths of bodies, maps, or coordinates
/// against time.
enum class Form { lone, paths, map, curves };
Form form_of(const Picture& picture);

/// Forces of contacts and of constraints that are not zero throughout, of the first solution, if they are
/// few.
struct ForceCurves {
  std::vector<const Column*> columns;
  std::vector<std::string> names;
};
ForceCurves force_curves(const Picture& picture);

/// "S = 1.235" with as many digits as tell neighbours apart, but no more than eight.
std::vector<std::string> action_texts(const Column& actions);

/// Colours by which solutions are told apart, with what explains them: a legend of a few, a scale of many.
struct SolutionColours {
  std::vector<Colour> colours;
  std::vector<LegendEntry> legend;
  std::optional<Axis> scale;
};
SolutionColours solution_colours(const Picture& picture);

/// A motion in space that keeps to a plane or a line, without the axes across it; nothing of any other.
std::optional<Picture> flattened(const Picture& picture, const Bodies& bodies);

/// A map of each solution below the other, one row for each of some coordinates.
Figure map_figure(const Picture& picture, const AxisName& name, const std::string& row_name,
                  const std::vector<std::size_t>& members);

}  // namespace extremal
