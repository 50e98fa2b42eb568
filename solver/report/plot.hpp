#pragma once

#include <string>
#include <vector>

#include "report/result.hpp"

/// \file Samples as a picture.

namespace extremal {

/// What a plot shows. Velocities and momenta of the samples may be empty: only a lone coordinate's velocity
/// is drawn. Some 800 times make smooth curves.
struct Picture {
  std::string title;               ///< may be empty; any text
  std::vector<std::string> names;  ///< of the coordinates: "x", "x[1]"
  Samples samples;
  std::vector<Samples> others = {};      ///< of further solutions, drawn over the first where there is room
  std::vector<std::string> labels = {};  ///< of all of them, for the legend
};

/// Refuses a path that does not end in .svg, .png or .pdf with std::invalid_argument. To be called before
/// work is begun whose result would be plotted.
void check_plot_path(const std::string& path);

/// Draws with gnuplot, SVG, PNG or PDF by the suffix of the path. What is drawn follows from the names:
///  - one coordinate: it and its velocity against time;
///  - two: the path in the plane, equal scales, beside both against time;
///  - three: the path in space and its projections;
///  - two or three arrays of one length, x[n], y[n] (and z[n]): the paths of n bodies;
///  - one long array: a map, time across and index upwards;
///  - all else: each coordinate or array against time.
/// Further solutions are drawn with up to three coordinates; of more coordinates only the first is, and the
/// title says so.
/// Throws std::invalid_argument for columns that do not fit the names, std::runtime_error if gnuplot is
/// missing or fails or the path cannot be written.
void write_plot(const std::string& path, const Picture& picture);

/// The lines of a result that has a spectrum. Throws in the same way, and std::invalid_argument without any line.
void write_spectrum_plot(const std::string& path, const Result& result);

struct Figure;
/// Draws a figure; throws in the same way.
void write_figure(const std::string& path, const Figure& figure);

}  // namespace extremal
