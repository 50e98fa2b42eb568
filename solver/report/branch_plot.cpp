#include <stdexcept>

#include "report/branch.hpp"
#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr double margin = 0.06, ticks = 6;

Axis axis(const std::string& label, const Column& values) {
  const Extent range = extent({&values}, margin);
  return make_axis(label, range.low, range.high, ticks);
}

}  // namespace

Figure layout(const FollowedBranch& branch) {
  if (branch.points.empty()) throw std::invalid_argument("cannot plot a branch without points");
  const bool energies = branch.parameter == "energy";
  Curve curve{{}, {}, first_colour};
  for (const BranchPoint& point : branch.points) {
    curve.x.push_back(point.parameter);
    curve.y.push_back(energies ? point.solution.duration() : point.solution.action);
  }
  const double top = top_of_panels(branch.title) + 18, height = 420;
  Figure figure{.width = 860, .height = top + height + 56, .title = branch.title};
  Panel panel;
  panel.x = axis(branch.parameter, curve.x);
  panel.y = axis(energies ? "duration" : "action", curve.y);
  bool folds = false, crossings = false;
  for (std::size_t k = 0; k < branch.points.size(); ++k) {
    const PointKind kind = branch.points[k].kind;
    if (kind == PointKind::regular) continue;
    const bool fold = kind == PointKind::fold;
    (fold ? folds : crossings) = true;
    panel.marks.push_back({curve.x[k], curve.y[k], second_colour, fold ? Shape::disc : Shape::ring});
  }
  if (folds) panel.legend.push_back({"fold", second_colour, Shape::disc});
  if (crossings) panel.legend.push_back({"branch", second_colour, Shape::ring});
  panel.curves.push_back(std::move(curve));
  const double left = 44 + number_width(panel.y);
  panel.box = {left, top, figure.width - left - 24, height};
  figure.panels.push_back(std::move(panel));
  return figure;
}

void write_plot(const std::string& path, const FollowedBranch& branch) { write_figure(path, layout(branch)); }

}  // namespace extremal
