#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr std::size_t most_columns = 4;
constexpr double data_height = 150, residual_height = 80, gap = 26, right_margin = 24;
/// Beyond so many marks only the curve tells them apart: every few are drawn.
constexpr std::size_t most_marks = 400;

/// What was observed of one kind, by time.
struct Shown {
  Column t, observed, computed, residual, scaled;
};

Shown shown(const Fitted& fit, const Fitted::Column& column) {
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < fit.t.size(); ++k)
    if (column.observed[k]) rows.push_back(k);
  std::ranges::stable_sort(rows, {}, [&](std::size_t k) { return fit.t[k]; });
  Shown result;
  for (const std::size_t k : rows) {
    result.t.push_back(fit.t[k]);
    result.observed.push_back(*column.observed[k]);
    result.computed.push_back(*column.observed[k] - *column.residual[k]);
    result.residual.push_back(*column.residual[k]);
    result.scaled.push_back(*column.residual[k] / column.sigma[k].value_or(1));
  }
  return result;
}

void mark(Panel& panel, const Column& t, const Column& values) {
  const std::size_t stride = (t.size() + most_marks - 1) / most_marks;
  for (std::size_t k = 0; k < t.size(); k += stride)
    panel.marks.push_back({t[k], values[k], second_colour, Shape::dot});
}

Panel panel_of(const AxisName& name, const std::vector<const Column*>& columns, double height) {
  Panel panel;
  Extent range = extent(columns, 0.08);
  if (!(range.low < range.high)) range = {range.low - 1, range.high + 1};
  panel.y = make_axis(name, range.low, range.high, height / 30);
  panel.box.height = height;
  return panel;
}

/// The curve of a column: of a coordinate or velocity that of the samples, else through the times of the
/// data.
Curve computed_curve(const Shown& all, const std::string& name, const std::vector<std::string>& names,
                     const Samples& samples) {
  for (std::size_t a = 0; a < names.size(); ++a) {
    if (name == names[a]) return {samples.t, samples.q[a], first_colour};
    if (name == velocity_key(names[a])) return {samples.t, samples.v[a], first_colour};
  }
  return {all.t, all.computed, first_colour};
}

}  // namespace

Figure fit_layout(const Result& result, const Samples& samples, const Annotation& annotation) {
  if (!result.fit) throw std::invalid_argument("cannot plot a fit of a result that has none");
  const Fitted& fit = *result.fit;
  std::vector<const Fitted::Column*> columns;
  for (const Fitted::Column& column : fit.columns)
    if (std::ranges::any_of(column.observed, [](const auto& x) { return x.has_value(); }) &&
        columns.size() < most_columns)
      columns.push_back(&column);
  std::vector<std::string> remarks;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k)
    remarks.push_back(fmt::format("{} = {:.6g} ± {:.2g}", fit.parameters[k], fit.values[k],
                                  std::sqrt(fit.covariance[k][k])));
  Figure figure = headed_figure(
      result.title, {{"computed", first_colour, Shape::line}, {"observed", second_colour, Shape::dot}},
      remarks);
  double top = top_of_panels(figure);
  figure.width = std::max(figure.width, 860.0);
  const double latest = std::max(result.solution.duration(), *std::ranges::max_element(fit.t));
  std::vector<Panel> panels;
  for (const Fitted::Column* column : columns) {
    const Shown all = shown(fit, *column);
    Curve curve = computed_curve(all, column->name, result.names, samples);
    Panel above = panel_of(axis_name(annotation, column->name), {&all.observed, &curve.y}, data_height);
    above.curves.push_back(std::move(curve));
    mark(above, all.t, all.observed);
    const bool scaled = std::ranges::any_of(column->sigma, [](const auto& x) { return x.has_value(); });
    const Column zero(2, 0);
    Panel below = panel_of({scaled ? "residual/sigma" : "residual"}, {&all.scaled, &zero}, residual_height);
    below.curves.push_back({{0, latest}, zero, first_colour, 1.0});
    mark(below, all.t, all.scaled);
    panels.push_back(std::move(above));
    panels.push_back(std::move(below));
  }
  double width = 0;
  for (const Panel& panel : panels) width = std::max(width, number_width(panel.y));
  const double left = 44 + width;
  for (Panel& panel : panels) {
    panel.x = make_axis(axis_name(annotation, "t"), 0, latest, 9);
    if (&panel != &panels.back()) {
      panel.x.label.clear();
      panel.x.numbered = false;
    }
    panel.box = {left, top, figure.width - left - right_margin, panel.box.height};
    top += panel.box.height + gap;
  }
  figure.height = top - gap + bottom;
  figure.panels = std::move(panels);
  return figure;
}

std::string fit_image(const std::string& path, const Result& result, const Samples& samples,
                      const Annotation& annotation) {
  return plot_image(path, fit_layout(result, samples, annotation));
}

}  // namespace extremal
