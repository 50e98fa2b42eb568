#include <algorithm>

#include "report/paths.hpp"

namespace extremal {

std::vector<Extent> scaled(std::vector<Extent> ranges, bool lengths, double width, double height) {
  if (!lengths || !comparable(ranges)) return ranges;
  const double scale = std::max(ranges[0].size() / width, ranges[1].size() / height);
  return {resized(ranges[0], scale * width), resized(ranges[1], scale * height)};
}

Panel plane_panel(const std::vector<BodyPath>& paths, const Surroundings& around,
                  const std::vector<Extent>& ranges, double width, double height) {
  Panel panel;
  panel.x = make_axis(around.axes[0], ranges[0].low, ranges[0].high, width / 75);
  panel.y = make_axis(around.axes[1], ranges[1].low, ranges[1].high, height / 60);
  panel.box = {0, 0, width, height};
  add_paths(panel, paths, 0, 1, ranges);
  add_centres(panel, around.centres, 0, 1);
  return panel;
}

Figure plane_figure(Figure figure, const std::vector<BodyPath>& paths, const Surroundings& around,
                    const AxisName& time, bool times) {
  constexpr double tallest = 460, widest = 828;
  const double top = top_of_panels(figure);
  std::vector<Extent> ranges = path_extents(paths, around.centres);
  const double aspect = around.lengths ? ranges[0].size() / ranges[1].size() : 1;
  const double width = std::clamp(tallest * aspect, 0.8 * tallest, times ? tallest : widest);
  const double height = times ? tallest : std::clamp(width / aspect, 0.65 * tallest, tallest);
  ranges = scaled(ranges, around.lengths, width, height);
  Panel panel = plane_panel(paths, around, ranges, width, height);
  const double left = 20 + number_width(panel.y);
  panel.box.left = left;
  panel.box.top = top;
  figure.panels.push_back(std::move(panel));
  figure.height = top + height + bottom;
  double right = left + width + 28;
  if (times) {
    std::vector<TimePanel> contents(2);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      contents[axis].label = around.axes[axis];
      for (const BodyPath& path : paths) {
        contents[axis].columns.push_back(path.axes[axis]);
        contents[axis].times.push_back(path.t);
        contents[axis].colours.push_back(path.colour);
        for (const BodyWaypoint& waypoint : path.waypoints)
          if (std::ranges::count(waypoint.axes, axis) > 0)
            contents[axis].marks.push_back(
                {waypoint.t, value_at(*path.t, *path.axes[axis], waypoint.t), path.colour, Shape::square});
      }
    }
    const Box box{right + 14, top, 430, height};
    for (Panel& each : time_panels(time, *paths[0].t, contents, box))
      figure.panels.push_back(std::move(each));
    right = box.left + box.width + 28;
  }
  figure.width = std::max(figure.width, right);
  return figure;
}

}  // namespace extremal
