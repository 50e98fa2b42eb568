#include <algorithm>

#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr double title_scale = 18.0 / 13;  ///< of a title against other texts
constexpr double header_left = 20;         ///< left of title and legend

}  // namespace

double number_width(const Axis& axis) {
  double width = 0;
  if (axis.numbered) {
    for (const Tick& tick : axis.ticks) width = std::max(width, text_width(tick.text));
  }
  return width + 16;
}

double sample_width(const LegendEntry& entry) {
  return entry.shape == Shape::none ? 0 : entry.shape == Shape::line ? 24 : 19;
}

double legend_width(const LegendEntry& entry) { return sample_width(entry) + text_width(entry.text) + 22; }

double top_of_panels(const Figure& figure) {
  if (figure.title.empty()) return figure.legend.empty() ? 40 : 66;
  return figure.legend.empty() ? 82 : 112;
}

Figure headed_figure(const std::string& title, std::vector<LegendEntry> legend,
                     const std::vector<std::string>& remarks) {
  Figure figure{.title = title, .legend = std::move(legend)};
  for (const std::string& remark : remarks) figure.legend.push_back({remark, 0, Shape::none});
  double width = 0;
  for (const LegendEntry& entry : figure.legend) width += legend_width(entry);
  figure.width = 2 * header_left + std::max(width, title_scale * text_width(title));
  return figure;
}

void add_key(Figure& figure, const Axis& scale) {
  const Box beside = figure.panels.front().box;
  double right = 0;
  for (const Panel& panel : figure.panels) right = std::max(right, panel.box.left + panel.box.width);
  Panel panel{.box = {right + 26, beside.top, bar_width, beside.height}, .x = {}, .y = {}, .axes = false};
  panel.key = ColourKey{scale, Palette::curves};
  const double text = std::max(number_width(scale), text_width(scale.label) - bar_width);
  figure.width = std::max(figure.width, panel.box.left + bar_width + text + 20);
  figure.panels.push_back(std::move(panel));
}

AxisName axis_name(const Annotation& annotation, const std::string& name) {
  const auto unit = [&](const std::string& of) {
    const auto found = annotation.units.find(of);
    return found == annotation.units.end() ? std::string() : found->second;
  };
  // Of a formula nothing is known, but that of an end value: x(0), x[1]'(T).
  std::string plain = name;
  if (plain.ends_with("(0)") || plain.ends_with("(T)")) plain.resize(plain.size() - 3);
  const bool velocity = plain.ends_with("'");
  if (velocity) plain.pop_back();
  if (plain.ends_with("]") && plain.find(']') + 1 == plain.size()) plain.resize(plain.find('['));
  const std::string length = unit(plain);
  if (!velocity) return {name, length};
  const std::string time = unit("t");
  return {name, length.empty() || time.empty() ? "" : length + "/" + time};
}

double value_at(const Column& t, const Column& values, double time) {
  const auto after = std::upper_bound(t.begin() + 1, t.end() - 1, time) - t.begin();
  const double part = std::clamp((time - t[after - 1]) / (t[after] - t[after - 1]), 0.0, 1.0);
  return values[after - 1] + part * (values[after] - values[after - 1]);
}

std::vector<Panel> time_panels(const AxisName& time, const Column& t, const std::vector<TimePanel>& contents,
                               Box box) {
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
    panel.x = make_axis(time, t.front(), last, box.width / 80);
    panel.x.numbered = panels.size() + 1 == contents.size();
    const std::size_t curves = content.columns.size();
    const std::vector<Colour> colours = content.colours.empty() ? distinct_colours(curves) : content.colours;
    for (std::size_t k = 0; k < curves; ++k) {
      panel.curves.push_back(
          {content.times.empty() ? t : *content.times[k], *content.columns[k], colours[k]});
      if (curves > 1 && k < content.names.size()) panel.legend.push_back({content.names[k], colours[k]});
    }
    panel.marks = content.marks;
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
