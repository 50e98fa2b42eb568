#pragma once

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

/// The figure that write_plot describes.
Figure layout(const Picture& picture);

/// Time against error of a comparison, powers of ten. Throws std::invalid_argument if no error is known.
struct Comparison;
Figure layout(const Comparison& comparison);

/// What varies along a branch against action or duration. Throws std::invalid_argument without points.
struct FollowedBranch;
Figure layout(const FollowedBranch& branch);

/// Amplitudes, powers of ten, against frequencies: a panel for each of the first coordinates. Throws
/// std::invalid_argument without any line.
Figure spectrum_layout(const Result& result);

/// Curves against time, a panel each below the other.
struct TimePanel {
  std::string label;
  std::vector<const Column*> columns;
  std::vector<std::string> names;         ///< for the legend; empty: none
  Colour colour = 0;                      ///< of a lone curve
  std::vector<const Column*> times = {};  ///< of each column, where they differ
};
/// Panels that share the time axis, within a box that includes the gaps between them.
std::vector<Panel> time_panels(const Column& t, const std::vector<TimePanel>& contents, Box box);

/// Pixels left of a box that its numbers need.
double number_width(const Axis& axis);

/// Where panels begin, below the title if there is one.
double top_of_panels(const std::string& title);

/// The path of one body, two or three columns.
struct BodyPath {
  std::vector<const Column*> axes;
  std::string name;
  Colour colour = 0;
};
Figure plane_figure(const Picture& picture, const std::vector<BodyPath>& paths,
                    const std::vector<std::string>& labels);
Figure space_figure(const Picture& picture, const std::vector<BodyPath>& paths,
                    const std::vector<std::string>& labels);

/// Colours to tell curves apart, also for the colour-blind: six that differ, or shades in a row.
std::vector<Colour> distinct_colours(std::size_t count);
inline constexpr Colour first_colour = 0x0072B2, second_colour = 0xD55E00;
inline constexpr std::size_t longest_legend = 6;

}  // namespace extremal
