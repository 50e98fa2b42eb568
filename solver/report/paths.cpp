#include "report/paths.hpp"

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

constexpr double margin = 0.07;             ///< of the extent, around paths
constexpr double greatest_elongation = 12;  ///< beyond it equal scales would leave a line
constexpr double near = 0.3;                ///< of the largest extent: a centre so far off a path is shown

}  // namespace

Extent resized(const Extent& range, double size) {
  return {range.centre() - size / 2, range.centre() + size / 2};
}

bool inside(const std::vector<Extent>& ranges, const Centre& centre, double more) {
  for (std::size_t axis = 0; axis < ranges.size(); ++axis)
    if (!(centre.at[axis] >= ranges[axis].low - more && centre.at[axis] <= ranges[axis].high + more))
      return false;
  return true;
}

std::vector<Extent> path_extents(const std::vector<BodyPath>& paths, const std::vector<Centre>& centres) {
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
  for (const Centre& centre : centres) {
    if (!inside(ranges, centre, near * greatest)) continue;
    for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
      ranges[axis].low = std::min(ranges[axis].low, centre.at[axis] - margin * greatest);
      ranges[axis].high = std::max(ranges[axis].high, centre.at[axis] + margin * greatest);
    }
  }
  return ranges;
}

std::vector<Centre> centres_inside(const std::vector<Extent>& ranges, const std::vector<Centre>& centres) {
  std::vector<Centre> found;
  for (const Centre& centre : centres)
    if (inside(ranges, centre, 0)) found.push_back(centre);
  return found;
}

bool comparable(const std::vector<Extent>& ranges) {
  double least = ranges[0].size(), greatest = least;
  for (const Extent& range : ranges) {
    least = std::min(least, range.size());
    greatest = std::max(greatest, range.size());
  }
  return greatest <= greatest_elongation * least;
}

bool closed(const BodyPath& path, const std::vector<Extent>& ranges) {
  for (std::size_t axis = 0; axis < ranges.size(); ++axis) {
    const Column& values = *path.axes[axis];
    if (std::abs(values.back() - values.front()) > 1e-3 * ranges[axis].size()) return false;
  }
  return true;
}

std::vector<PathPiece> in_time(const std::vector<BodyPath>& paths) {
  const std::size_t slices = paths.size() == 1 || !paths[0].marked ? 1 : 1 + 120 / paths.size();
  std::vector<PathPiece> pieces;
  for (std::size_t slice = 0; slice < slices; ++slice)
    for (const BodyPath& path : paths) {
      const std::size_t last = path.axes[0]->size() - 1;
      const std::size_t from = slice * last / slices, to = (slice + 1) * last / slices;
      if (to > from) pieces.push_back({&path, from, to + 1});
    }
  return pieces;
}

void add_paths(Panel& panel, const std::vector<BodyPath>& paths, std::size_t across, std::size_t up,
               const std::vector<Extent>& ranges) {
  for (const PathPiece& piece : in_time(paths))
    panel.curves.push_back({piece.along(across), piece.along(up), piece.path->colour});
  for (const BodyPath& path : paths) {
    if (!path.marked) continue;
    const Column &x = *path.axes[across], &y = *path.axes[up];
    if (!closed(path, ranges)) panel.marks.push_back({x.front(), y.front(), path.colour, Shape::ring});
    panel.marks.push_back({x.back(), y.back(), path.colour, Shape::disc});
    for (const BodyWaypoint& waypoint : path.waypoints)
      panel.marks.push_back(
          {value_at(*path.t, x, waypoint.t), value_at(*path.t, y, waypoint.t), path.colour, Shape::square});
  }
}

void add_centres(Panel& panel, const std::vector<Centre>& centres, std::size_t across, std::size_t up) {
  for (const Centre& centre : centres) {
    const double x = centre.at[across], y = centre.at[up];
    if (x < panel.x.low || x > panel.x.high || y < panel.y.low || y > panel.y.high) continue;
    panel.marks.push_back({x, y, centre_colour, Shape::cross});
    if (!centre.name.empty()) panel.notes.push_back({x, y, centre.name, true});
  }
}

}  // namespace extremal
