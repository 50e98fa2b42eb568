#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "report/result.hpp"

/// \file A picture as data: panels with axes, curves, marks and maps, placed to the pixel.

namespace extremal {

/// 0xRRGGBB.
using Colour = std::uint32_t;

struct Tick {
  double at = 0;     ///< in data units
  std::string text;  ///< as written beside the axis
};

/// low < high, and both ticks and label are ready to be drawn.
struct Axis {
  std::string label;
  double low = 0, high = 1;
  std::vector<Tick> ticks;
  bool numbered = true;  ///< false: ticks without text, as between panels that share an axis

  /// Position of a value, 0 at the low end and 1 at the high end.
  double place(double value) const { return (value - low) / (high - low); }
};

/// An axis with some `count` ticks at round numbers. A common power of ten goes into the label.
/// Throws std::invalid_argument unless low < high and their distance is finite.
Axis make_axis(const std::string& label, double low, double high, double count);

/// The extent of values with a margin, a fraction of it, at both sides. Values that differ by roundoff alone
/// get an extent of their own size, so that roundoff is not drawn as a signal.
struct Extent {
  double low = 0, high = 0;
  bool constant = false;
  double size() const { return high - low; }
  double centre() const { return low + (high - low) / 2; }
};
Extent extent(const std::vector<const Column*>& columns, double margin);

struct Curve {
  Column x, y;
  Colour colour = 0;
  double width = 1.6;
};

enum class Shape { line, ring, disc };

struct Mark {
  double x = 0, y = 0;
  Colour colour = 0;
  Shape shape = Shape::disc;
};

/// Text at a point of the panel, in data units.
struct Note {
  double x = 0, y = 0;
  std::string text;
};

struct LegendEntry {
  std::string text;
  Colour colour = 0;
  Shape shape = Shape::line;
};

/// Colours over the whole panel.
struct ColourMap {
  std::size_t columns = 0, rows = 0;
  Column values;           ///< [row * columns + column], the first row below
  Axis scale;              ///< of the colours
  bool diverging = false;  ///< zero in the middle
};

/// In pixels from the upper left corner of the figure.
struct Box {
  double left = 0, top = 0, width = 0, height = 0;
};

struct Panel {
  Box box;  ///< of the plane that the axes span, without their text
  Axis x, y;
  bool axes = true;  ///< false: nothing but the curves, marks and notes
  std::vector<Curve> curves = {};
  std::vector<Mark> marks = {};
  std::vector<Note> notes = {};
  std::vector<LegendEntry> legend = {};
  std::vector<ColourMap> maps = {};  ///< one or none
};

struct Figure {
  double width = 0, height = 0;  ///< pixels
  std::string title;
  std::vector<Panel> panels = {};
};

/// Width of a text in pixels, within some 10 %.
double text_width(const std::string& text);

/// UTF-8 that may stand in XML once escaped: control characters become spaces, bytes that are no UTF-8 the
/// mark U+FFFD, "]]>" gets a space; texts longer than `limit` characters end in an ellipsis.
std::string printable(const std::string& text, std::size_t limit);

}  // namespace extremal
