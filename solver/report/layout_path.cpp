#include <algorithm>
#include <cmath>

#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr double margin = 0.07;             ///< of the extent, around paths
constexpr double greatest_elongation = 12;  ///< beyond it equal scales would leave a line
constexpr Colour shadow = 0xC9CDD3, edge = 0xDDE0E4;

/// The extent with this size about the same centre.
Extent resized(const Extent& range, double size) {
  return {range.centre() - size / 2, range.centre() + size / 2};
}

/// Of each axis. Where the paths do not move at all, or by roundoff, the extent is that of the axis where
/// they move most.
std::vector<Extent> path_extents(const std::vector<BodyPath>& paths) {
  std::vector<Extent> ranges;
  double greatest = 0;
  for (std::size_t axis = 0; axis < paths[0].axes.size(); ++axis) {
    std::vector<const Column*> columns;
    for (const BodyPath& path : paths) columns.push_back(path.axes[axis]);
    ranges.push_back(extent(columns, margin));
    if (!ranges.back().constant) greatest = std::max(greatest, ranges.back().size());
  }
  for (Extent& range : ranges) {
    if (greatest > 0 && (range.constant || range.size() < 1e-9 * greatest)) range = resized(range, greatest);
  }
  return ranges;
}

bool comparable(const std::vector<Extent>& ranges) {
  double least = ranges[0].size(), greatest = least;
  for (const Extent& range : ranges) {
    least = std::min(least, range.size());
    greatest = std::max(greatest, range.size());
  }
  return greatest <= greatest_elongation * least;
}

/// Ends that agree to what can be seen.
bool closed(const BodyPath& path, const std::vector<Extent>& ranges) {
  for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
    const Column& values = *path.axes[axis];
    if (std::abs(values.back() - values.front()) > 1e-3 * ranges[axis].size()) return false;
  }
  return true;
}

/// Calls draw(path, from, to) for short slices of the paths in the order of time: where several bodies take
/// one path the last to pass is seen.
template <class Draw>
void paint_in_time(const std::vector<BodyPath>& paths, Draw draw) {
  const std::size_t last = paths[0].axes[0]->size() - 1;
  const std::size_t slices = std::min(last, paths.size() == 1 ? 1 : 1 + 120 / paths.size());
  for (std::size_t slice = 0; slice < slices; ++slice) {
    for (const BodyPath& path : paths) draw(path, slice * last / slices, (slice + 1) * last / slices + 1);
  }
}

Column part(const Column& values, std::size_t from, std::size_t to) {
  return {values.data() + from, values.data() + to};
}

/// Paths in the plane of two of their axes. A closed path has one mark, an open one two.
void add_paths(Panel& panel, const std::vector<BodyPath>& paths, std::size_t across, std::size_t up,
               const std::vector<Extent>& ranges) {
  paint_in_time(paths, [&](const BodyPath& path, std::size_t from, std::size_t to) {
    panel.curves.push_back({part(*path.axes[across], from, to), part(*path.axes[up], from, to), path.colour});
  });
  for (const BodyPath& path : paths) {
    const Column &x = *path.axes[across], &y = *path.axes[up];
    if (!closed(path, ranges)) panel.marks.push_back({x.front(), y.front(), path.colour, Shape::ring});
    panel.marks.push_back({x.back(), y.back(), path.colour, Shape::disc});
  }
}

std::vector<LegendEntry> path_legend(const std::vector<BodyPath>& paths, const std::vector<Extent>& ranges) {
  std::vector<LegendEntry> entries;
  if (paths.size() > 1 && paths.size() <= longest_legend) {
    for (const BodyPath& path : paths) entries.push_back({path.name, path.colour, Shape::line});
  }
  const bool open =
      std::any_of(paths.begin(), paths.end(), [&](const BodyPath& p) { return !closed(p, ranges); });
  if (open) {
    const Colour colour = paths.size() == 1 ? paths[0].colour : 0x5A606B;
    entries.push_back({"start", colour, Shape::ring});
    entries.push_back({"end", colour, Shape::disc});
  }
  return entries;
}

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

/// All ranges have been brought to one scale already.
Panel space_panel(const std::vector<BodyPath>& paths, const std::vector<Extent>& ranges,
                  const std::vector<std::string>& labels, const Box& box) {
  const Extent &x = ranges[0], &y = ranges[1], &z = ranges[2];
  const View view;
  Panel panel{.box = box, .x = {}, .y = {}, .axes = false};
  add_room(panel, view, x, y, z);
  for (const BodyPath& path : paths) {
    const Column floor(path.axes[0]->size(), z.low);
    panel.curves.push_back(view.curve(*path.axes[0], *path.axes[1], floor, shadow, 1.2));
  }
  paint_in_time(paths, [&](const BodyPath& path, std::size_t from, std::size_t to) {
    panel.curves.push_back(view.curve(part(*path.axes[0], from, to), part(*path.axes[1], from, to),
                                      part(*path.axes[2], from, to), path.colour, 1.6));
  });
  for (const BodyPath& path : paths) {
    const Column &xs = *path.axes[0], &ys = *path.axes[1], &zs = *path.axes[2];
    Mark start = view.at(xs.front(), ys.front(), zs.front()), end = view.at(xs.back(), ys.back(), zs.back());
    start.colour = end.colour = path.colour;
    start.shape = Shape::ring;
    if (!closed(path, ranges)) panel.marks.push_back(start);
    panel.marks.push_back(end);
  }
  const auto note = [&](double nx, double ny, double nz, const std::string& text) {
    const Mark at = view.at(nx, ny, nz);
    panel.notes.push_back({at.x, at.y, text});
  };
  note(x.centre(), y.low - 0.09 * y.size(), z.low, labels[0]);
  note(x.high + 0.09 * x.size(), y.centre(), z.low, labels[1]);
  note(x.low - 0.06 * x.size(), y.low, z.centre(), labels[2]);

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

/// Sizes in pixels of the sides of the three projections: widths of x and y, heights of y and z.
struct Sides {
  double x, y, z;
};

}  // namespace

Figure plane_figure(const Picture& picture, const std::vector<BodyPath>& paths,
                    const std::vector<std::string>& labels) {
  const double top = top_of_panels(picture.title), height = 460;
  const bool beside = paths.size() == 1;  // room for both coordinates against time
  double width = 460;
  std::vector<Extent> ranges = path_extents(paths);
  if (!beside) width = std::clamp(height * ranges[0].size() / ranges[1].size(), 0.8 * height, 1.8 * height);
  if (comparable(ranges)) {
    const double scale = std::max(ranges[0].size() / width, ranges[1].size() / height);
    ranges = {resized(ranges[0], scale * width), resized(ranges[1], scale * height)};
  }
  Panel panel;
  panel.x = make_axis(labels[0], ranges[0].low, ranges[0].high, width / 75);
  panel.y = make_axis(labels[1], ranges[1].low, ranges[1].high, height / 60);
  const double left = 20 + number_width(panel.y);
  panel.box = {left, top, width, height};
  add_paths(panel, paths, 0, 1, ranges);
  panel.legend = path_legend(paths, ranges);

  Figure figure{.width = left + width + 28, .height = top + height + 56, .title = picture.title};
  figure.panels.push_back(std::move(panel));
  if (beside) {
    const Box box{figure.width + 14, top, 430, height};
    figure.width = box.left + box.width + 28;
    const std::vector<TimePanel> contents{{labels[0], {paths[0].axes[0]}, {}, paths[0].colour},
                                          {labels[1], {paths[0].axes[1]}, {}, paths[0].colour}};
    for (Panel& each : time_panels(picture.samples.t, contents, box))
      figure.panels.push_back(std::move(each));
  }
  return figure;
}

Figure space_figure(const Picture& picture, const std::vector<BodyPath>& paths,
                    const std::vector<std::string>& labels) {
  std::vector<Extent> ranges = path_extents(paths);
  const double greatest = std::max({ranges[0].size(), ranges[1].size(), ranges[2].size()});
  const bool equal = comparable(ranges);
  // A side shorter than half the longest is padded, or its panels would be strips.
  const auto share = [&](const Extent& range) {
    return equal ? std::max(range.size() / greatest, 0.55) : 0.8;
  };
  const Sides share_of{share(ranges[0]), share(ranges[1]), share(ranges[2])};
  const double longest = std::min(820 / (share_of.x + share_of.y), 760 / (share_of.y + share_of.z));
  const Sides side{share_of.x * longest, share_of.y * longest, share_of.z * longest};
  if (equal) {
    ranges = {resized(ranges[0], share_of.x * greatest), resized(ranges[1], share_of.y * greatest),
              resized(ranges[2], share_of.z * greatest)};
  }
  const auto axis = [&](std::size_t a, double pixels) {
    return make_axis(labels[a], ranges[a].low, ranges[a].high, pixels / 70);
  };
  const Axis x = axis(0, side.x), y = axis(1, side.y), z = axis(2, side.z);
  const double top = top_of_panels(picture.title), left = 20 + std::max(number_width(y), number_width(z));
  const double lower = top + side.y + 82, right = left + side.x + 40 + number_width(z);

  Panel above{.box = {left, top, side.x, side.y}, .x = x, .y = y};
  Panel front{.box = {left, lower, side.x, side.z}, .x = x, .y = z};
  Panel beside{.box = {right, lower, side.y, side.z}, .x = y, .y = z};
  add_paths(above, paths, 0, 1, ranges);
  add_paths(front, paths, 0, 2, ranges);
  add_paths(beside, paths, 1, 2, ranges);
  above.legend = path_legend(paths, ranges);

  Figure figure{.width = right + side.y + 28, .height = lower + side.z + 56, .title = picture.title};
  figure.panels = {above, front, beside,
                   space_panel(paths, ranges, labels, {right - 20, top - 20, side.y + 20, side.y + 20})};
  return figure;
}

}  // namespace extremal
