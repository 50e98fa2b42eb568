#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "report/comparison.hpp"
#include "report/layout.hpp"
#include "report/page.hpp"

namespace extremal {

namespace {

/// An error of zero is drawn here: a constant trajectory can be exact.
constexpr double least_error = 1e-17;
constexpr int most_ticks = 9;

/// What one method needs: log10 of errors and of seconds.
struct Line {
  std::string method;
  Column error, seconds;
};

std::vector<Line> lines(const Comparison& comparison) {
  std::vector<Line> result;
  for (const ComparisonRow& row : comparison.rows) {
    if (!row.error) continue;
    if (result.empty() || result.back().method != row.method) result.push_back({row.method, {}, {}});
    result.back().error.push_back(std::log10(std::max(*row.error, least_error)));
    result.back().seconds.push_back(std::log10(row.seconds));
  }
  return result;
}

/// Whole powers of ten around values; `text` writes one.
template <class Text>
Axis decades(const std::string& label, const std::vector<const Column*>& columns, const Text& text) {
  const Extent range = extent(columns, 0);
  const int low = static_cast<int>(std::floor(range.low)),
            count = std::max(static_cast<int>(std::ceil(range.high)) - low, 1);
  const int step = (count + most_ticks - 1) / most_ticks, steps = (count + step - 1) / step;
  Axis axis{.label = label, .low = double(low), .high = double(low + step * steps), .ticks = {}};
  for (int k = 0; k <= steps; ++k) axis.ticks.push_back({double(low + k * step), text(low + k * step)});
  return axis;
}

std::string seconds_text(int power) {
  static constexpr const char* units[] = {"ns", "µs", "ms", "s"};
  const int unit = std::clamp(static_cast<int>(std::floor((power + 9) / 3.0)), 0, 3);
  return fmt::format("{:g} {}", std::pow(10.0, power + 9 - 3 * unit), units[unit]);
}

}  // namespace

Figure layout(const Comparison& comparison) {
  const std::vector<Line> all = lines(comparison);
  if (all.empty()) throw std::invalid_argument("cannot plot a comparison without a known error");
  std::vector<const Column*> errors, seconds;
  for (const Line& line : all) {
    errors.push_back(&line.error);
    seconds.push_back(&line.seconds);
  }
  std::vector<LegendEntry> legend;
  const std::vector<Colour> colours = distinct_colours(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) legend.push_back({all[k].method, colours[k], Shape::line});
  Figure figure = headed_figure(comparison.title, legend);
  const double top = top_of_panels(figure), height = 420;
  figure.width = std::max(figure.width, 860.0);
  figure.height = top + height + bottom;
  Panel panel;
  panel.x = decades("largest error of q", errors, [](int power) { return fmt::format("1e{}", power); });
  panel.y = decades("time of a solve", seconds, seconds_text);
  for (std::size_t k = 0; k < all.size(); ++k) {
    panel.curves.push_back({all[k].error, all[k].seconds, colours[k]});
    for (std::size_t i = 0; i < all[k].error.size(); ++i)
      panel.marks.push_back({all[k].error[i], all[k].seconds[i], colours[k], Shape::disc});
  }
  const double left = 20 + number_width(panel.y);
  panel.box = {left, top, 836 - left, height};
  figure.panels.push_back(std::move(panel));
  return figure;
}

std::string plot_image(const std::string& path, const Comparison& comparison) {
  if (is_page(path)) return page(comparison);
  return plot_image(path, layout(comparison));
}

}  // namespace extremal
