#pragma once

#include <cstdint>
#include <optional>
#include <span>
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

/// Name and unit of what an axis measures; without a unit it may be empty.
struct AxisName {
  std::string name;
  std::string unit = {};
};

/// An axis with some `count` ticks at round numbers. A unit and a common power of ten go into the label.
/// Throws std::invalid_argument unless low < high and their distance is finite.
Axis make_axis(const AxisName& name, double low, double high, double count);

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

/// A cross marks a fixed centre; `none` leaves a text of a legend without a sample.
enum class Shape { none, line, ring, disc, square, cross, dot };

struct Mark {
  double x = 0, y = 0;
  Colour colour = 0;
  Shape shape = Shape::disc;
};

/// Text at a point of the panel, in data units; or to the right of it.
struct Note {
  double x = 0, y = 0;
  std::string text;
  bool beside = false;
};

struct LegendEntry {
  std::string text;
  Colour colour = 0;
  Shape shape = Shape::line;
};

/// Colours in the order of values: those of maps, of maps with zero in the middle, and of curves on white.
enum class Palette { sequential, diverging, curves };

std::span<const Colour> palette_colours(Palette palette);
/// A colour of the palette, from 0 to 1.
Colour shade(Palette palette, double place);
/// Pixels across the bar of a key.
inline constexpr double bar_width = 12;

/// The bar that a panel consists of, with the values that its colours stand for.
struct ColourKey {
  Axis scale;
  Palette palette = Palette::curves;
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
  std::optional<ColourKey> key = {};
  std::string caption = {};  ///< centred above the panel
};

struct Figure {
  double width = 0, height = 0;  ///< pixels
  std::string title;
  std::vector<LegendEntry> legend = {};  ///< below the title, from the left
  std::vector<Panel> panels = {};
};

/// Width of a text in pixels in DejaVu Sans, the widest of the usual fonts, within some 10 %.
double text_width(const std::string& text);

/// In the legend of a figure: room for the sample, and all of an entry.
double sample_width(const LegendEntry& entry);
double legend_width(const LegendEntry& entry);

/// UTF-8 that may stand in XML once escaped: control characters become spaces, bytes that are no UTF-8 the
/// mark U+FFFD, "]]>" gets a space; texts longer than `limit` characters end in an ellipsis.
std::string printable(const std::string& text, std::size_t limit);

}  // namespace extremal
