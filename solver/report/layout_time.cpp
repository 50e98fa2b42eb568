#include <algorithm>

#include "report/layout.hpp"

namespace extremal {

double number_width(const Axis& axis) {
  double width = 0;
  if (axis.numbered) {
    for (const Tick& tick : axis.ticks) width = std::max(width, text_width(tick.text));
  }
  return width + 16;
}

double top_of_panels(const std::string& title) { return title.empty() ? 40 : 82; }

std::vector<Colour> distinct_colours(std::size_t count) {
  static constexpr Colour distinct[longest_legend] = {first_colour, second_colour, 0x009E73,
                                                      0xCC79A7,     0xE69F00,      0x56B4E9};
  if (count <= longest_legend) return {distinct, distinct + count};
  static constexpr Colour shades[] = {0x440154, 0x3B528B, 0x21918C, 0x5EC962, 0xC9B70A};
  std::vector<Colour> colours;
  for (std::size_t k = 0; k < count; ++k) {
    const double place = 4.0 * static_cast<double>(k) / static_cast<double>(count - 1);
    const auto before = std::min<std::size_t>(static_cast<std::size_t>(place), 3);
    const double weight = place - static_cast<double>(before);
    Colour mixed = 0;
    for (const int shift : {16, 8, 0}) {
      const double low = (shades[before] >> shift) & 0xFF, high = (shades[before + 1] >> shift) & 0xFF;
      mixed |= static_cast<Colour>((1 - weight) * low + weight * high + 0.5) << shift;
    }
    colours.push_back(mixed);
  }
  return colours;
}

std::vector<Panel> time_panels(const Column& t, const std::vector<TimePanel>& contents, Box box) {
  const double gap = 40;
  const auto count = static_cast<double>(contents.size());
  const double height = (box.height - (count - 1) * gap) / count;
  std::vector<Panel> panels;
  double widest = 0;
  for (const TimePanel& content : contents) {
    const Extent range = extent(content.columns, 0.05);
    Panel panel;
    panel.y = make_axis(content.label, range.low, range.high, height / 36);
    double last = t.back();
    for (const Column* times : content.times) last = std::max(last, times->back());
    panel.x = make_axis("t", t.front(), last, box.width / 80);
    panel.x.numbered = panels.size() + 1 == contents.size();
    const std::size_t curves = content.columns.size();
    const std::vector<Colour> colours =
        curves == 1 ? std::vector<Colour>{content.colour} : distinct_colours(curves);
    for (std::size_t k = 0; k < curves; ++k) {
      panel.curves.push_back(
          {content.times.empty() ? t : *content.times[k], *content.columns[k], colours[k]});
      if (curves > 1 && k < content.names.size()) panel.legend.push_back({content.names[k], colours[k]});
    }
    widest = std::max(widest, number_width(panel.y));
    panels.push_back(std::move(panel));
  }
  double top = box.top;
  for (Panel& panel : panels) {
    panel.box = {box.left + widest, top, box.width - widest, height};
    top += height + gap;
  }
  return panels;
}

}  // namespace extremal
