#include <fmt/format.h>

#include "report/page_data.hpp"

namespace extremal {

namespace {

const char* shape_name(Shape shape) {
  switch (shape) {
    case Shape::none:
      return "none";
    case Shape::line:
      return "line";
    case Shape::ring:
      return "ring";
    case Shape::disc:
      return "disc";
    case Shape::square:
      return "square";
    case Shape::cross:
      return "cross";
    case Shape::dot:
      break;
  }
  return "dot";
}

PageData scale(const Axis& axis) {
  PageData ticks = PageData::array();
  for (const Tick& tick : axis.ticks) ticks.push_back({{"at", tick.at}, {"text", tick.text}});
  return {{"label", axis.label}, {"low", axis.low}, {"high", axis.high}, {"ticks", std::move(ticks)}};
}

PageData legend_data(const std::vector<LegendEntry>& legend) {
  PageData entries = PageData::array();
  for (const LegendEntry& entry : legend)
    entries.push_back(
        {{"text", entry.text}, {"colour", css_colour(entry.colour)}, {"shape", shape_name(entry.shape)}});
  return entries;
}

PageData panel_data(const Panel& panel) {
  PageData curves = PageData::array(), marks = PageData::array();
  for (const Curve& curve : panel.curves)
    curves.push_back(
        {{"x", curve.x}, {"y", curve.y}, {"colour", css_colour(curve.colour)}, {"width", curve.width}});
  for (const Mark& mark : panel.marks)
    marks.push_back({{"x", mark.x},
                     {"y", mark.y},
                     {"colour", css_colour(mark.colour)},
                     {"shape", shape_name(mark.shape)}});
  return {{"x", scale(panel.x)},         {"y", scale(panel.y)},
          {"caption", panel.caption},    {"legend", legend_data(panel.legend)},
          {"curves", std::move(curves)}, {"marks", std::move(marks)}};
}

}  // namespace

std::string css_colour(Colour colour) { return fmt::format("#{:06x}", colour); }

PageData page_axis(const AxisName& name) { return {{"name", name.name}, {"unit", name.unit}}; }

PageData page_figure(const Figure& figure) {
  PageData panels = PageData::array();
  for (const Panel& panel : figure.panels)
    if (panel.axes) panels.push_back(panel_data(panel));
  return {{"legend", legend_data(figure.legend)}, {"panels", std::move(panels)}};
}

}  // namespace extremal
