#include "report/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <utility>

namespace extremal {

namespace {

constexpr Colour ink = 0x262A33, quiet_ink = 0x5A606B, frame = 0x8C929C, rule = 0xE8EAED, paper = 0xFFFFFF;
constexpr double font_size = 13, title_size = 18;  // pixels
constexpr int zoom = 2;                            ///< pixels of a PNG for one of the layout
constexpr int raster = 20 * zoom;                  ///< gnuplot's own units in one pixel of the layout
constexpr double flatness = 0.05;  ///< largest distance, in pixels, of a curve from the chords drawn for it

/// A literal between double quotes. All but letters, spaces and what is not ASCII is written as an octal
/// escape, so that no text can end the literal or have gnuplot substitute a command in it. Digits too: one
/// after an escape would be read as a part of it.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : printable(text, 100)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x80 || c == ' ' || std::isalpha(byte) != 0;
    result += plain ? std::string(1, c) : fmt::format("\\{:03o}", byte);
  }
  return result + "\"";
}

std::string hexadecimal(Colour colour) { return fmt::format("'#{:06X}'", colour); }

struct Point {
  double x = 0, y = 0;
};

double distance_to_chord(const Point& p, const Point& from, const Point& to) {
  const double x = to.x - from.x, y = to.y - from.y, length2 = x * x + y * y;
  const double along = length2 > 0 ? ((p.x - from.x) * x + (p.y - from.y) * y) / length2 : 0;
  const double t = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.x - from.x - t * x, p.y - from.y - t * y);
}

/// The path with fewer points: no point that is left out is farther than `most` from the chords of the others
/// (Douglas and Peucker 1973).
std::vector<Point> thinned(const std::vector<Point>& path, double most) {
  if (path.size() < 3) return path;
  std::vector<char> kept(path.size(), 0);
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> pieces{{0, path.size() - 1}};
  while (!pieces.empty()) {
    const auto [from, to] = pieces.back();
    pieces.pop_back();
    double farthest = most;
    std::size_t corner = from;
    for (std::size_t k = from + 1; k < to; ++k)
      if (const double d = distance_to_chord(path[k], path[from], path[to]); d > farthest) {
        farthest = d;
        corner = k;
      }
    if (corner == from) continue;
    kept[corner] = 1;
    pieces.insert(pieces.end(), {{from, corner}, {corner, to}});
  }
  std::vector<Point> result;
  for (std::size_t k = 0; k < path.size(); ++k)
    if (kept[k]) result.push_back(path[k]);
  return result;
}

/// What gnuplot measures in units of its own, which differ with the format.
struct Sizes {
  double font;    ///< of a pixel
  double point;   ///< of a mark
  double tick;    ///< length of a tick
  double number;  ///< by how much the numbers below an axis are to be raised, in lines
};
constexpr Sizes svg_sizes{.font = 1, .point = 0.6, .tick = 0.4, .number = 0.35};
constexpr Sizes png_sizes{.font = 0.75, .point = 0.8, .tick = 1, .number = 0};
constexpr double pixels_an_inch = 96;  // of a PDF
constexpr Sizes pdf_sizes{.font = 0.75, .point = 0.5, .tick = 0.75, .number = 0};

const Sizes& sizes_of(Format format) {
  return format == Format::svg ? svg_sizes : format == Format::png ? png_sizes : pdf_sizes;
}

Box whole_pixels(const Box& box) {
  return {std::round(box.left), std::round(box.top), std::round(box.width), std::round(box.height)};
}

/// Texts are placed by fractions of the figure ("screen") or of a panel ("graph"), curves in the units to
/// which gnuplot rounds, so that values of any size draw alike.
class Script {
 public:
  Script(const Figure& figure, Format format)
      : figure_(figure),
        width_(std::round(figure.width)),
        height_(std::round(figure.height)),
        sizes_(sizes_of(format)) {
    terminal(format);
    add("set encoding utf8\nset key off\nset multiplot\n");
    add("set clip two\n");  // lines whose ends are both outside are drawn as well
    add("set cbrange [0:1]\n");
    header();
    for (const Panel& panel : figure.panels) draw(panel);
    add("unset multiplot\nunset output\n");
  }

  std::string text() const { return fmt::to_string(buffer_); }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> pattern, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), pattern, std::forward<Values>(values)...);
  }

  void terminal(Format format) {
    const char* common = "noenhanced rounded background '#FFFFFF'";
    const double size = font_size * sizes_.font;
    if (format == Format::svg) {
      add("set terminal svg size {:.0f},{:.0f} {} font 'Helvetica,{}'\n", width_, height_, common, size);
    } else if (format == Format::pdf) {
      // Its scale of fonts is 0.5 unless it is given; a line of width 1 is three quarters of a pixel.
      add("set terminal pdfcairo size {:.4f}in,{:.4f}in {} font 'Helvetica,{}' fontscale 0.75 linewidth "
          "1.33\n",
          width_ / pixels_an_inch, height_ / pixels_an_inch, common, size);
    } else {
      add("set terminal pngcairo size {:.0f},{:.0f} {} font 'Helvetica,{}'", zoom * width_, zoom * height_,
          common, size);
      add(" fontscale {0} linewidth {0} pointscale {0}\n", zoom);
    }
  }

  std::string screen(double x, double y) const {
    return fmt::format("screen {:.5f},{:.5f}", x / width_, 1 - y / height_);
  }

  void label(const std::string& text, double x, double y, const char* align, Colour colour) {
    add("set label {} at {} {} textcolor rgb {}\n", quoted(text), screen(x, y), align, hexadecimal(colour));
  }

  /// Title and legend of the whole figure are drawn with the first panel.
  void header() {
    if (!figure_.title.empty())
      add("set label {} at {} left font ',{}' textcolor rgb {}\n", quoted(figure_.title), screen(20, 26),
          title_size * sizes_.font, hexadecimal(ink));
    double left = 20;
    for (const LegendEntry& each : figure_.legend) {
      entry(each, left + sample_width(each), figure_.title.empty() ? 22 : 60);
      left += legend_width(each);
    }
  }

  void draw(const Panel& panel) {
    place(panel);
    if (panel.axes) axes(panel);
    for (const Note& note : panel.notes) {
      // To the left where there is no room to the right.
      const double right = panel.x.place(note.x) * panel.box.width + text_width(note.text) + 12;
      const char* align = !note.beside              ? "center"
                          : right > panel.box.width ? "right offset -0.8,0.5"
                                                    : "left offset 0.8,0.5";
      add("set label {} at graph {:.5f},{:.5f} {} textcolor rgb {}\n", quoted(note.text),
          panel.x.place(note.x), panel.y.place(note.y), align, hexadecimal(quiet_ink));
    }
    if (!panel.caption.empty())
      label(panel.caption, panel.box.left + panel.box.width / 2, panel.box.top - 14, "center", ink);
    legend(panel);
    contents(panel);
    add("unset label\nunset arrow\nunset colorbox\n");
  }

  void place(const Panel& panel) {
    const Box box = whole_pixels(panel.box);
    add("set xrange [0:{:.0f}]\nset yrange [0:{:.0f}]\n", box.width * raster, box.height * raster);
    add("set lmargin at screen {:.9f}\nset rmargin at screen {:.9f}\n", box.left / width_,
        (box.left + box.width) / width_);
    add("set tmargin at screen {:.9f}\nset bmargin at screen {:.9f}\n", 1 - box.top / height_,
        1 - (box.top + box.height) / height_);
    add("unset border\nunset xtics\nunset ytics\nunset grid\n");
  }

  void axes(const Panel& panel) {
    add("set border 3 back linecolor rgb {} linewidth 0.8\n", hexadecimal(frame));
    const Box box = whole_pixels(panel.box);
    ticks("xtics", panel.x, box.width * raster, sizes_.number);
    ticks("ytics", panel.y, box.height * raster);
    if (panel.maps.empty()) {
      add("set grid xtics ytics back linetype 1 linecolor rgb {} linewidth 0.8\n", hexadecimal(rule));
    }
    label(panel.y.label, box.left, box.top - 14, "left", ink);
    if (panel.x.numbered) {
      label(panel.x.label, box.left + box.width / 2, box.top + box.height + 38, "center", ink);
    }
  }

  void ticks(const char* which, const Axis& axis, double length, double raised = 0) {
    add("set {} out nomirror scale {} offset 0,{} textcolor rgb {} (", which, sizes_.tick, raised,
        hexadecimal(quiet_ink));
    const char* separator = "";
    for (const Tick& tick : axis.ticks) {
      add("{}{} {:.5f}", separator, quoted(axis.numbered ? tick.text : ""), axis.place(tick.at) * length);
      separator = ",";
    }
    add(")\n");
  }

  /// In the line of the vertical axis's name, from the right.
  void legend(const Panel& panel) {
    const double y = panel.box.top - 14;
    double right = panel.box.left + panel.box.width;
    for (auto each = panel.legend.rbegin(); each != panel.legend.rend(); ++each) {
      const double start = right - text_width(each->text);
      entry(*each, start, y);
      right = start - 44;
    }
  }

  /// A text that begins at `start`, with its sample before it.
  void entry(const LegendEntry& entry, double start, double y) {
    label(entry.text, start, y, "left", quiet_ink);
    if (entry.shape == Shape::line) {
      add("set arrow from {} to {} nohead linewidth 2.2 linecolor rgb {}\n", screen(start - 24, y),
          screen(start - 7, y), hexadecimal(entry.colour));
    } else if (entry.shape != Shape::none) {
      for (const std::string& symbol : symbols(entry.shape, entry.colour))
        add("set label '' at {} point {}\n", screen(start - 12, y), symbol);
    }
  }

  /// What is drawn for a mark, one upon the other: a ring is a disc with a white one inside.
  std::vector<std::string> symbols(Shape shape, Colour colour) const {
    const auto symbol = [&](int type, double size, Colour of) {
      return fmt::format("pointtype {} pointsize {:.2f} linecolor rgb {}", type, size * sizes_.point,
                         hexadecimal(of));
    };
    switch (shape) {
      case Shape::square:
        return {symbol(5, 0.9, colour)};
      case Shape::cross:
        return {symbol(1, 1.4, colour) + " linewidth 1.6"};
      case Shape::dot:
        return {symbol(7, 0.45, colour)};
      case Shape::ring:
        return {symbol(7, 1, colour), symbol(7, 0.55, paper)};
      default:
        return {symbol(7, 1, colour)};
    }
  }

  void contents(const Panel& panel) {
    std::vector<std::string> parts;
    for (const ColourMap& map : panel.maps) parts.push_back(colours(map, panel.box));
    if (panel.key) parts.push_back(key(*panel.key, panel.box));
    for (const Curve& curve : panel.curves) {
      parts.push_back(fmt::format("{} with lines linewidth {} linecolor rgb {}",
                                  points(panel, curve.x, curve.y), curve.width, hexadecimal(curve.colour)));
    }
    for (const Mark& mark : panel.marks) {
      const std::string at = points(panel, {mark.x}, {mark.y});
      for (const std::string& symbol : symbols(mark.shape, mark.colour))
        parts.push_back(at + " with points " + symbol);
    }
    add("plot {}\n", fmt::join(parts, ", "));
  }

  std::string open_block() {
    std::string block = fmt::format("$d{}", blocks_++);
    add("{} << EOD\n", block);
    return block;
  }

  /// gnuplot moves exactly horizontal and vertical steps onto whole pixels, which shows as notches where a
  /// curve turns; so no step is quite that.
  std::string points(const Panel& panel, const Column& x, const Column& y) {
    const Box box = whole_pixels(panel.box);
    std::vector<Point> path(x.size());
    for (std::size_t k = 0; k < x.size(); ++k)
      path[k] = {panel.x.place(x[k]) * box.width * raster, panel.y.place(y[k]) * box.height * raster};
    const std::string block = open_block();
    long across = -1, up = -1;
    const auto next = [](double position, long before) {
      const long rounded = std::lround(position);
      return rounded == before ? rounded + 1 : rounded;
    };
    for (const Point& point : thinned(path, flatness * raster)) {
      across = next(point.x, across);
      up = next(point.y, up);
      add("{} {}\n", across, up);
    }
    add("EOD\n");
    return block;
  }

  void bar(const Axis& scale, Palette palette, const Box& box) {
    std::vector<std::string> stops;
    const std::span<const Colour> colours = palette_colours(palette);
    for (std::size_t k = 0; k < colours.size(); ++k)
      stops.push_back(fmt::format("{} {}", static_cast<double>(k) / static_cast<double>(colours.size() - 1),
                                  hexadecimal(colours[k])));
    add("set palette defined ({})\n", fmt::join(stops, ", "));
    add("set colorbox user origin {} size screen {:.5f},{:.5f} noborder\n",
        screen(box.left, box.top + box.height), box.width / width_, box.height / height_);
    ticks("cbtics", scale, 1);
    label(scale.label, box.left, box.top - 20, "left", ink);  // above a number at the top
  }

  /// gnuplot draws the bar where something has its colours: here a point out of sight.
  std::string key(const ColourKey& key, const Box& box) {
    bar(key.scale, key.palette, box);
    const std::string block = open_block();
    add("-1 -1 0\nEOD\n");
    return block + " using 1:2:3 with points palette";
  }

  /// Cells are drawn as pixels whose centres fill the panel from edge to edge.
  std::string colours(const ColourMap& map, const Box& box) {
    bar(map.scale, map.diverging ? Palette::diverging : Palette::sequential,
        {box.left + box.width + 18, box.top, bar_width, box.height});
    const std::string block = open_block();
    for (std::size_t row = 0; row < map.rows; ++row) {
      for (std::size_t column = 0; column < map.columns; ++column) {
        add("{:.4f} ", map.scale.place(map.values[row * map.columns + column]));
      }
      add("\n");
    }
    add("EOD\n");
    return fmt::format("{} matrix using (($1+0.5)*{}):(($2+0.5)*{}):3 with image", block,
                       whole_pixels(box).width * raster / static_cast<double>(map.columns),
                       whole_pixels(box).height * raster / static_cast<double>(map.rows));
  }

  const Figure& figure_;
  double width_, height_;  ///< whole pixels
  Sizes sizes_;
  fmt::memory_buffer buffer_;
  int blocks_ = 0;
};

}  // namespace

std::string gnuplot_script(const Figure& figure, Format format) { return Script(figure, format).text(); }

}  // namespace extremal
