#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/figure.hpp"
#include "report/plot.hpp"

/// \file From samples to a figure: what is drawn and where.

namespace extremal {

/// A coordinate, or the elements of one array in the order of the names.
struct Family {
  std::string name;                  ///< "x" of x[1], x[2], …
  std::vector<std::size_t> members;  ///< positions in the names
  std::vector<std::string> indices;  ///< "1", "2", …; empty for a lone coordinate
};

/// In the order in which they first appear.
std::vector<Family> families(const std::vector<std::string>& names);

/// Coordinates as places of bodies in the plane or in space.
struct Bodies {
  std::vector<std::string> axes;                 ///< two or three names
  std::vector<std::vector<std::size_t>> places;  ///< of each body, its coordinate along each axis
  std::vector<std::string> names;                ///< of the bodies; of a lone one empty
  bool lengths = true;                           ///< false: two coordinates, perhaps of different kinds
};

/// Of the largest extent: a coordinate that varies by less does not move.
inline constexpr double motionless = 1e-9;

/// Nothing unless the names are those of places, x, y and z for each body, or two in all: angles in an array
/// of three are no path in space.
std::optional<Bodies> bodies(const std::vector<std::string>& names);

/// The figure that write_plot describes.
Figure layout(const Picture& picture);

/// Time against error of a comparison, powers of ten. Throws std::invalid_argument if no error is known.
struct Comparison;
Figure layout(const Comparison& comparison);

/// A branch and orbits on it. Throws std::invalid_argument without points, or where the quantity is finite at
/// none.
struct BranchPicture;
struct FollowedBranch;
Figure layout(const BranchPicture& picture);

/// The panel of the diagram alone, its left upper corner at the top, and what its colours and marks stand
/// for. Throws likewise.
Panel branch_diagram(const BranchPicture& picture, std::vector<LegendEntry>& legend);
/// Of each point, by its stability or its index: as curves and dots of the diagram have it.
std::vector<Colour> branch_colours(const FollowedBranch& branch);

/// Amplitudes, powers of ten, against frequencies: a panel for each of the first coordinates. Throws
/// std::invalid_argument without any line.
Figure spectrum_layout(const Result& result);

/// Of each kind of observation, the first ones: what was observed and computed, and below what is left, in σ
/// where it is given. Throws std::invalid_argument without a fit.
Figure fit_layout(const Result& result, const Samples& samples, const Annotation& annotation);

/// Pixels left of a box that its numbers need.
double number_width(const Axis& axis);

/// Where panels begin, below title and legend.
double top_of_panels(const Figure& figure);
/// Below the last panel.
inline constexpr double bottom = 56;

/// A figure with title, legend and the picture's remarks, as wide as they need.
Figure headed_figure(const std::string& title, std::vector<LegendEntry> legend,
                     const std::vector<std::string>& remarks = {});

/// Beside what there is, the values that colours of curves stand for; as high as the first panel.
void add_key(Figure& figure, const Axis& scale);

/// An axis with the unit that a system gives it: of "x[1]" that of x, of "x'" that of x by that of t.
AxisName axis_name(const Annotation& annotation, const std::string& name);

/// Curves against time, a panel each below the other.
struct TimePanel {
  AxisName label;
  std::vector<const Column*> columns;
  std::vector<Colour> colours = {};       ///< of each; empty: distinct ones
  std::vector<std::string> names = {};    ///< for the legend; empty: none
  std::vector<const Column*> times = {};  ///< of each column, where they differ
  std::vector<Mark> marks = {};           ///< at waypoints
};
/// Panels that share the time axis, within a box that includes the gaps between them.
std::vector<Panel> time_panels(const AxisName& time, const Column& t, const std::vector<TimePanel>& contents,
                               Box box);

/// A waypoint of a body, and the axes of the coordinates that are fixed there.
struct BodyWaypoint {
  double t = 0;
  std::vector<std::size_t> axes;
};

/// The path of one body, two or three columns.
struct BodyPath {
  std::vector<const Column*> axes;
  std::string name = {};
  Colour colour = 0;
  const Column* t = nullptr;
  bool marked = true;  ///< at its ends
  std::vector<BodyWaypoint> waypoints = {};
};

/// A column at a time, linear between its values.
double value_at(const Column& t, const Column& values, double time);

/// Axes of paths, and the centres of force between which they run.
struct Surroundings {
  std::vector<AxisName> axes;
  std::vector<Centre> centres = {};  ///< a number for each axis
  bool lengths = true;               ///< axes have equal scales
};

/// Of some axes of bodies, or of all.
Surroundings surroundings(const Annotation& annotation, const std::vector<std::string>& names,
                          const Bodies& bodies, const std::vector<std::size_t>& axes);
Surroundings surroundings(const Annotation& annotation, const std::vector<std::string>& names,
                          const Bodies& bodies);

/// Paths of one solution, or all solutions over each other. `times`: room for the coordinates against time
/// beside the plane.
Figure plane_figure(Figure figure, const std::vector<BodyPath>& paths, const Surroundings& around,
                    const AxisName& time, bool times);
Figure space_figure(Figure figure, const std::vector<BodyPath>& paths, const Surroundings& around);

/// Paths that are drawn together, in one of several small panels.
struct PathCell {
  std::string caption;
  std::vector<BodyPath> paths;
};
/// In pixels; one of them may be zero and then follows from the paths.
struct CellSize {
  double width = 0, height = 0;
};
/// Small panels in rows of `columns`, from the upper left corner: planes, or views of space. One scale for
/// all, unless paths differ much in size.
std::vector<Panel> path_cells(const std::vector<PathCell>& cells, Surroundings around, std::size_t columns,
                              CellSize size, double left, double top);
/// Width and height of what panels cover, from the origin.
Box covered(const std::vector<Panel>& panels);

/// Colours to tell curves apart, also for the colour-blind: six that differ, or shades in a row.
std::vector<Colour> distinct_colours(std::size_t count);
inline constexpr Colour first_colour = 0x0072B2, second_colour = 0xD55E00;
inline constexpr std::size_t longest_legend = 6;

}  // namespace extremal
