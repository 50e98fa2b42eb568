#include <algorithm>
#include <cmath>

#include "report/paths.hpp"

namespace extremal {

namespace {

constexpr Colour shadow = 0xC9CDD3, edge = 0xDDE0E4;

/// Orthographic view from the right, front and above; z points up.
struct View {
  double across_x = std::cos(turn), across_y = std::sin(turn);
  double up_x = std::sin(tilt) * -std::sin(turn), up_y = std::sin(tilt) * std::cos(turn),
         up_z = std::cos(tilt);
  static constexpr double turn = 0.55, tilt = 0.45;

  Mark at(double x, double y, double z) const {
    return {across_x * x + across_y * y, up_x * x + up_y * y + up_z * z};
  }
  Curve curve(const Column& x, const Column& y, const Column& z, Colour colour, double width) const {
    Curve drawn{.x = {}, .y = {}, .colour = colour, .width = width};
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Mark point = at(x[k], y[k], z[k]);
      drawn.x.push_back(point.x);
      drawn.y.push_back(point.y);
    }
    return drawn;
  }
};

/// Floor and the three edges behind the paths, in the order in which a pen would draw them.
void add_room(Panel& panel, const View& view, const Extent& x, const Extent& y, const Extent& z) {
  const auto line = [&](const Column& xs, const Column& ys, const Column& zs) {
    panel.curves.push_back(view.curve(xs, ys, zs, edge, 0.8));
  };
  line({x.low, x.high, x.high, x.low, x.low}, {y.low, y.low, y.high, y.high, y.low}, Column(5, z.low));
  line({x.low, x.low, x.high}, {y.low, y.high, y.high}, Column(3, z.high));
  line({x.low, x.low}, {y.low, y.low}, {z.low, z.high});
  line({x.low, x.low}, {y.high, y.high}, {z.low, z.high});
  line({x.high, x.high}, {y.high, y.high}, {z.low, z.high});
}

}  // namespace

Panel space_panel(const std::vector<BodyPath>& paths, const std::vector<Extent>& ranges,
                  const Surroundings& around, const Box& box) {
  const Extent &x = ranges[0], &y = ranges[1], &z = ranges[2];
  const View view;
  Panel panel{.box = box, .x = {}, .y = {}, .axes = false};
  add_room(panel, view, x, y, z);
  for (const BodyPath& path : paths) {
    const Column floor(path.axes[0]->size(), z.low);
    panel.curves.push_back(view.curve(*path.axes[0], *path.axes[1], floor, shadow, 1.2));
  }
  for (const PathPiece& piece : in_time(paths))
    panel.curves.push_back(
        view.curve(piece.along(0), piece.along(1), piece.along(2), piece.path->colour, 1.6));
  const auto mark = [&](double at_x, double at_y, double at_z, Colour colour, Shape shape) {
    const Mark at = view.at(at_x, at_y, at_z);
    panel.marks.push_back({at.x, at.y, colour, shape});
  };
  for (const BodyPath& path : paths) {
    if (!path.marked) continue;
    const Column &xs = *path.axes[0], &ys = *path.axes[1], &zs = *path.axes[2];
    if (!closed(path, ranges)) mark(xs.front(), ys.front(), zs.front(), path.colour, Shape::ring);
    mark(xs.back(), ys.back(), zs.back(), path.colour, Shape::disc);
    for (const BodyWaypoint& waypoint : path.waypoints) {
      const auto at = [&](const Column& values) { return value_at(*path.t, values, waypoint.t); };
      mark(at(xs), at(ys), at(zs), path.colour, Shape::square);
    }
  }
  const auto note = [&](double nx, double ny, double nz, const std::string& text, bool beside = false) {
    const Mark at = view.at(nx, ny, nz);
    panel.notes.push_back({at.x, at.y, text, beside});
  };
  for (const Centre& centre : centres_inside(ranges, around.centres)) {
    mark(centre.at[0], centre.at[1], centre.at[2], centre_colour, Shape::cross);
    note(centre.at[0], centre.at[1], centre.at[2], centre.name, true);
  }
  note(x.centre(), y.low - 0.09 * y.size(), z.low, around.axes[0].name);
  note(x.high + 0.09 * x.size(), y.centre(), z.low, around.axes[1].name);
  note(x.low - 0.06 * x.size(), y.low, z.centre(), around.axes[2].name);

  std::vector<const Column*> across, up;
  for (const Curve& curve : panel.curves) across.push_back(&curve.x), up.push_back(&curve.y);
  Extent wide = extent(across, 0.1), high = extent(up, 0.1);
  const double scale = std::max(wide.size() / box.width, high.size() / box.height);
  wide = resized(wide, scale * box.width);
  high = resized(high, scale * box.height);
  panel.x = {.label = "", .low = wide.low, .high = wide.high, .ticks = {}};
  panel.y = {.label = "", .low = high.low, .high = high.high, .ticks = {}};
  return panel;
}

Sides shares(const std::vector<Extent>& ranges, bool equal, double least) {
  const double greatest = std::max({ranges[0].size(), ranges[1].size(), ranges[2].size()});
  const auto share = [&](const Extent& range) {
    return equal ? std::max(range.size() / greatest, least) : 0.8;
  };
  return {share(ranges[0]), share(ranges[1]), share(ranges[2])};
}

std::vector<Extent> padded(const std::vector<Extent>& ranges, const Sides& share) {
  const double greatest = std::max({ranges[0].size(), ranges[1].size(), ranges[2].size()});
  return {resized(ranges[0], share.x * greatest), resized(ranges[1], share.y * greatest),
          resized(ranges[2], share.z * greatest)};
}

Figure space_figure(Figure figure, const std::vector<BodyPath>& paths, const Surroundings& around) {
  std::vector<Extent> ranges = path_extents(paths, around.centres);
  const bool equal = comparable(ranges);
  const Sides share = shares(ranges, equal, 0.55);
  const double longest = std::min(820 / (share.x + share.y), 760 / (share.y + share.z));
  const Sides side{share.x * longest, share.y * longest, share.z * longest};
  if (equal) ranges = padded(ranges, share);
  const auto axis = [&](std::size_t a, double pixels) {
    return make_axis(around.axes[a], ranges[a].low, ranges[a].high, pixels / 70);
  };
  const Axis x = axis(0, side.x), y = axis(1, side.y), z = axis(2, side.z);
  const double top = top_of_panels(figure), left = 20 + std::max(number_width(y), number_width(z));
  const double lower = top + side.y + 82, right = left + side.x + 40 + number_width(z);

  Panel above{.box = {left, top, side.x, side.y}, .x = x, .y = y};
  Panel front{.box = {left, lower, side.x, side.z}, .x = x, .y = z};
  Panel beside{.box = {right, lower, side.y, side.z}, .x = y, .y = z};
  const std::vector<Centre> centres = centres_inside(ranges, around.centres);
  const auto fill = [&](Panel& panel, std::size_t across, std::size_t up) {
    add_paths(panel, paths, across, up, ranges);
    add_centres(panel, centres, across, up);
  };
  fill(above, 0, 1);
  fill(front, 0, 2);
  fill(beside, 1, 2);
  figure.width = std::max(figure.width, right + side.y + 28);
  figure.height = lower + side.z + bottom;
  figure.panels = {above, front, beside,
                   space_panel(paths, ranges, around, {right - 20, top - 20, side.y + 20, side.y + 20})};
  return figure;
}

}  // namespace extremal
