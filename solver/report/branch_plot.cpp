#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "report/branch.hpp"
#include "report/branch_orbits.hpp"
#include "report/layout.hpp"
#include "report/page.hpp"
#include "report/smooth.hpp"

namespace extremal {

namespace {

constexpr double panel_margin = 0.06, diagram_width = 600, diagram_height = 420, diagram_left = 44;
constexpr Colour dark = 0x22262C, third_colour = 0x009E73;
constexpr int pieces = 24;          ///< of a curve between two points
constexpr double same_place = 0.5;  ///< pixels

/// What the colour of a branch says: of periodic orbits their stability, of others whether they are minima.
struct Kinds {
  bool orbits;
  const char* good() const { return orbits ? "stable" : "index 0"; }
  const char* bad() const { return orbits ? "unstable" : "higher index"; }
  Colour colour(const BranchPoint& point) const {
    const Solution& solution = point.solution;
    const bool fine = orbits ? solution.floquet && solution.floquet->stable() : solution.morse_index == 0;
    return fine ? first_colour : second_colour;
  }
};

/// A point of the branch in the pixels of the panel.
struct Spot {
  std::size_t point;
  double x, y;
};

/// Points of one branch in their order, from the point at which it begins to cross another. Points without a
/// finite quantity are left out.
std::vector<Spot> places(const BranchPicture& picture, std::size_t number, const Panel& panel) {
  const FollowedBranch& branch = picture.branch;
  std::vector<std::size_t> points;
  const std::optional<int> origin = branch.branches[number].origin;
  if (origin && branch.points[*origin].kind == PointKind::branch) points.push_back(*origin);
  for (std::size_t k = 0; k < branch.points.size(); ++k)
    if (branch.points[k].branch == static_cast<int>(number)) points.push_back(k);
  std::vector<Spot> found;
  for (const std::size_t k : points) {
    if (!std::isfinite(picture.quantity.values[k])) continue;
    const Spot place{k, panel.x.place(branch.points[k].parameter) * panel.box.width,
                     panel.y.place(picture.quantity.values[k]) * panel.box.height};
    const bool moved =
        found.empty() || std::hypot(place.x - found.back().x, place.y - found.back().y) > same_place;
    if (moved) found.push_back(place);
  }
  return found;
}

/// A branch as a curve, in pieces of one colour.
void add_branch(const BranchPicture& picture, std::size_t number, const Kinds& kinds, Panel& panel) {
  const std::vector<Spot> found = places(picture, number, panel);
  Polyline points;
  for (const Spot& place : found) {
    points.x.push_back(place.x);
    points.y.push_back(place.y);
  }
  const Polyline curve = smooth(points, pieces);
  const auto value = [](const Axis& axis, double pixels, double length) {
    return axis.low + pixels / length * (axis.high - axis.low);
  };
  std::optional<Colour> last;
  for (std::size_t k = 0; k + 1 < found.size(); ++k) {
    const BranchPoint &from = picture.branch.points[found[k].point],
                      &to = picture.branch.points[found[k + 1].point];
    // At a point that was located multipliers or eigenvalues are on the border.
    const Colour colour = kinds.colour(to.kind == PointKind::regular ? to : from);
    if (last != colour) panel.curves.push_back({{}, {}, colour, number == 0 ? 2.0 : 1.4});
    last = colour;
    for (std::size_t i = k * pieces; i <= (k + 1) * pieces; ++i) {
      panel.curves.back().x.push_back(value(panel.x, curve.x[i], panel.box.width));
      panel.curves.back().y.push_back(value(panel.y, curve.y[i], panel.box.height));
    }
  }
}

std::pair<Colour, Shape> style(PointKind kind, Colour colour) {
  switch (kind) {
    case PointKind::fold:
      return {dark, Shape::disc};
    case PointKind::branch:
      return {dark, Shape::ring};
    case PointKind::period_doubling:
      return {third_colour, Shape::square};
    case PointKind::regular:
      break;
  }
  return {colour, Shape::dot};
}

/// Every point; those that were located last, so that dots do not hide them.
void add_marks(const BranchPicture& picture, const Kinds& kinds, Panel& panel,
               std::vector<LegendEntry>& legend) {
  std::set<PointKind> seen;
  for (const bool located : {false, true})
    for (std::size_t k = 0; k < picture.branch.points.size(); ++k) {
      const BranchPoint& point = picture.branch.points[k];
      const double y = picture.quantity.values[k];
      if (!std::isfinite(y) || located != (point.kind != PointKind::regular)) continue;
      const auto [colour, shape] = style(point.kind, kinds.colour(point));
      panel.marks.push_back({point.parameter, y, colour, shape});
      if (located && seen.insert(point.kind).second) legend.push_back({name(point.kind), colour, shape});
    }
}

Kinds kinds_of(const FollowedBranch& branch) {
  return {std::any_of(branch.points.begin(), branch.points.end(),
                      [](const BranchPoint& p) { return p.solution.floquet.has_value(); })};
}

}  // namespace

std::vector<Colour> branch_colours(const FollowedBranch& branch) {
  const Kinds kinds = kinds_of(branch);
  std::vector<Colour> colours;
  for (const BranchPoint& point : branch.points) colours.push_back(kinds.colour(point));
  return colours;
}

Panel branch_diagram(const BranchPicture& picture, std::vector<LegendEntry>& legend) {
  const FollowedBranch& branch = picture.branch;
  if (branch.points.empty()) throw std::invalid_argument("cannot plot a branch without points");
  const Kinds kinds = kinds_of(branch);
  Column x, y;
  for (std::size_t k = 0; k < branch.points.size(); ++k) {
    if (!std::isfinite(picture.quantity.values[k])) continue;
    x.push_back(branch.points[k].parameter);
    y.push_back(picture.quantity.values[k]);
  }
  if (x.empty())
    throw std::invalid_argument(fmt::format("cannot plot: {} is finite at no point", picture.quantity.name));
  const auto axis = [&](const std::string& name, const Column& values, double ticks) {
    const Extent range = extent({&values}, panel_margin);
    AxisName named = axis_name(picture.annotation, name == "duration" ? "t" : name);
    named.name = name;
    return make_axis(named, range.low, range.high, ticks);
  };
  Panel panel;
  panel.x = axis(branch.parameter, x, diagram_width / 75);
  panel.y = axis(picture.quantity.name, y, diagram_height / 55);
  const double shift = number_width(panel.y);
  panel.box = {diagram_left + shift, 0, diagram_width - shift, diagram_height};
  for (std::size_t number = 0; number < branch.branches.size(); ++number)
    add_branch(picture, number, kinds, panel);
  for (const bool good : {true, false}) {
    const Colour colour = good ? first_colour : second_colour;
    if (std::any_of(branch.points.begin(), branch.points.end(), [&](const BranchPoint& p) {
          return p.kind == PointKind::regular && kinds.colour(p) == colour;
        }))
      legend.push_back({good ? kinds.good() : kinds.bad(), colour, Shape::line});
  }
  add_marks(picture, kinds, panel, legend);
  return panel;
}

Figure layout(const BranchPicture& picture) {
  std::vector<LegendEntry> legend;
  Panel diagram = branch_diagram(picture, legend);
  const Orbits orbits(picture.branch, picture.annotation);
  Figure figure = headed_figure(picture.branch.title, legend, orbits.remarks());
  const double top = top_of_panels(figure);
  diagram.box.top = top;
  figure.panels.push_back(std::move(diagram));
  for (Panel& panel : orbits.panels(diagram_left + diagram_width + 40, top, diagram_height))
    figure.panels.push_back(std::move(panel));
  const Box box = covered(figure.panels);
  figure.width = std::max(figure.width, box.width + 28);
  figure.height = box.height + bottom;
  add_key(figure, orbits.scale());
  return figure;
}

std::string plot_image(const std::string& path, const BranchPicture& picture) {
  if (is_page(path)) return page(picture);
  return plot_image(path, layout(picture));
}

}  // namespace extremal
