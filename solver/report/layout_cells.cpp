#include <algorithm>
#include <limits>

#include "report/paths.hpp"

namespace extremal {

namespace {

std::vector<BodyPath> all_paths(const std::vector<PathCell>& cells) {
  std::vector<BodyPath> all;
  for (const PathCell& cell : cells) all.insert(all.end(), cell.paths.begin(), cell.paths.end());
  return all;
}

/// Whether paths that differ much in size are among the cells.
bool of_one_size(const std::vector<PathCell>& cells) {
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  for (const PathCell& cell : cells) {
    double size = 0;
    for (const Extent& range : path_extents(cell.paths, {}))
      if (!range.constant) size = std::max(size, range.size());
    least = std::min(least, size);
    greatest = std::max(greatest, size);
  }
  return greatest < 4 * least;
}

}  // namespace

std::vector<Panel> path_cells(const std::vector<PathCell>& cells, Surroundings around, std::size_t columns,
                              CellSize size, double left, double top) {
  if (cells.size() > 1)  // small panels have no room for names
    for (Centre& centre : around.centres) centre.name.clear();
  constexpr double caption = 36, across_gap = 34, numbers = 46;
  const bool shared = of_one_size(cells), space = around.axes.size() == 3;
  const std::vector<BodyPath> all = all_paths(cells);
  const std::vector<Extent> common = path_extents(all, around.centres);
  double aspect = space ? 1 : 1.25;
  if (!space && around.lengths && comparable(common))
    aspect = std::clamp(common[0].size() / common[1].size(), 0.6, 1.6);
  const double width = size.width > 0 ? size.width : size.height * aspect;
  const double height = size.height > 0 ? size.height : size.width / aspect;
  std::vector<Panel> panels;
  double shift = 0;
  for (const PathCell& cell : cells) {
    std::vector<Extent> ranges = shared ? common : path_extents(cell.paths, around.centres);
    if (space) {
      const bool equal = comparable(ranges);
      if (equal) ranges = padded(ranges, shares(ranges, equal, 0.3));
      panels.push_back(space_panel(cell.paths, ranges, around, {0, 0, width, height}));
    } else {
      panels.push_back(
          plane_panel(cell.paths, around, scaled(ranges, around.lengths, width, height), width, height));
      shift = std::max(shift, number_width(panels.back().y));
    }
    panels.back().caption = cell.caption;
  }
  // Axes of one scale are numbered once for a row or column.
  const double step_across = width + across_gap + (shared ? 0 : shift);
  const double step_down = height + caption + (space ? 0 : shared ? 8 : numbers);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    Panel& panel = panels[k];
    const std::size_t row = k / columns, column = k % columns;
    panel.box.left = left + shift + static_cast<double>(column) * step_across;
    panel.box.top = top + static_cast<double>(row) * step_down;
    const bool last_below = k + columns >= panels.size();
    if (shared) panel.x.numbered = last_below;
    if (shared) panel.y.numbered = column == 0;
    if (column > 0) panel.y.label.clear();
  }
  return panels;
}

Box covered(const std::vector<Panel>& panels) {
  Box box;
  for (const Panel& panel : panels) {
    box.width = std::max(box.width, panel.box.left + panel.box.width);
    box.height = std::max(box.height, panel.box.top + panel.box.height);
  }
  return box;
}

}  // namespace extremal
