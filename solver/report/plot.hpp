#pragma once

#include <string>
#include <vector>

#include "report/file.hpp"
#include "report/result.hpp"
#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"
#include "study/annotation.hpp"
#include "study/obstacles.hpp"

/// \file Samples as a picture.

namespace extremal {

/// What a plot shows. Velocities and momenta of the samples may be empty: only a lone coordinate's velocity
/// is drawn. Some 800 times make smooth curves.
struct Picture {
  std::string title;               ///< may be empty; any text
  std::vector<std::string> names;  ///< of the coordinates: "x", "x[1]"
  Samples samples;
  std::vector<Samples> others = {};       ///< of further solutions, in the order of their actions
  Column actions = {};                    ///< of all solutions, if there are several
  Annotation annotation = {};             ///< of the system: units of axes, centres of force
  std::vector<std::string> remarks = {};  ///< below the title
  /// What inequalities along the path forbid, in the first panel, and when they are equalities.
  std::vector<PlaneCurve> obstacles = {};
  std::vector<Contact> contacts = {};
  std::vector<std::vector<WaypointImpulse>> waypoints = {};  ///< of each solution; empty: none has any
};

/// Refuses a path that does not end in .svg, .png, .pdf or .html with std::invalid_argument, and .html in a
/// build without pages. To be called before work is begun whose result would be plotted.
void check_plot_path(const std::string& path);

/// Throws std::invalid_argument for columns that do not fit the names, times that do not increase and values
/// that are not finite.
void check_picture(const Picture& picture);

/// The bytes of a file drawn with gnuplot, SVG, PNG or PDF by the suffix of the path. What is drawn follows
/// from the names:
///  - one coordinate: it and its velocity against time;
///  - x and y, or two coordinates: the path in the plane, beside both against time;
///  - x, y and z: the path in space and its projections; where it keeps to a plane or a line, that;
///  - x[n], y[n] (and z[n]), or x1, y1, x2, y2: the paths of n bodies;
///  - one long array: a map, time across and index upwards;
///  - all else: each coordinate or array against time.
/// Squares mark waypoints. Several solutions are drawn over each other, coloured by their actions; orbits,
/// several bodies and maps in a panel for each solution. Throws std::invalid_argument for columns that do not
/// fit the names, std::runtime_error if gnuplot is missing or fails.
std::string plot_image(const std::string& path, const Picture& picture);

/// The lines of a result that has a spectrum; throws in the same way, and std::invalid_argument without any.
std::string spectrum_image(const std::string& path, const Result& result);

/// Observations and residuals of a result that has a fit, with curves by samples of it; throws likewise.
std::string fit_image(const std::string& path, const Result& result, const Samples& samples,
                      const Annotation& annotation);

struct Figure;
/// The bytes of a figure's file; throws in the same way.
std::string plot_image(const std::string& path, const Figure& figure);

/// Writes what plot_image() of its subject draws. Throws std::runtime_error if the path cannot be written.
template <class Subject>
void write_plot(const std::string& path, const Subject& subject) {
  write_files({{path, plot_image(path, subject)}});
}

}  // namespace extremal
