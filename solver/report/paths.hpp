#pragma once

#include <vector>

#include "report/layout.hpp"

/// \file What pictures of paths are made of.

namespace extremal {

inline constexpr Colour centre_colour = 0x262A33;

/// The extent with this size about the same centre.
Extent resized(const Extent& range, double size);

/// Of each axis, with centres that are near. Where the paths do not move at all, or by roundoff, the extent
/// is that of the axis where they move most.
std::vector<Extent> path_extents(const std::vector<BodyPath>& paths, const std::vector<Centre>& centres);

/// Whether a centre lies within the ranges, or at most so far outside.
bool inside(const std::vector<Extent>& ranges, const Centre& centre, double more);

/// The centres within the ranges.
std::vector<Centre> centres_inside(const std::vector<Extent>& ranges, const std::vector<Centre>& centres);

/// Extents so alike that equal scales leave no line.
bool comparable(const std::vector<Extent>& ranges);

/// Ends that agree to what can be seen.
bool closed(const BodyPath& path, const std::vector<Extent>& ranges);

/// A piece of a path, between two of its samples.
struct PathPiece {
  const BodyPath* path;
  std::size_t from, to;  ///< the last sample is left out
  Column along(std::size_t axis) const {
    return {path->axes[axis]->begin() + from, path->axes[axis]->begin() + to};
  }
};

/// Short pieces of the paths in the order of time: where several bodies take one path the last to pass is
/// seen. Paths of several solutions, without marks, come one by one.
std::vector<PathPiece> in_time(const std::vector<BodyPath>& paths);

/// Paths in the plane of two of their axes. A closed path has one mark, an open one two.
void add_paths(Panel& panel, const std::vector<BodyPath>& paths, std::size_t across, std::size_t up,
               const std::vector<Extent>& ranges);

/// Those within the panel, with their names.
void add_centres(Panel& panel, const std::vector<Centre>& centres, std::size_t across, std::size_t up);

/// Paths in the plane, in a panel of this size.
Panel plane_panel(const std::vector<BodyPath>& paths, const Surroundings& around,
                  const std::vector<Extent>& ranges, double width, double height);
/// Equal scales where the axes are lengths.
std::vector<Extent> scaled(std::vector<Extent> ranges, bool lengths, double width, double height);

/// Sizes of a room by those of its axes.
struct Sides {
  double x, y, z;
};
/// Of each axis the share of the longest side, at least so much: a short side is padded, or its panels would
/// be strips.
Sides shares(const std::vector<Extent>& ranges, bool equal, double least);
std::vector<Extent> padded(const std::vector<Extent>& ranges, const Sides& share);
/// A view of a room with the paths in it, all on one scale.
Panel space_panel(const std::vector<BodyPath>& paths, const std::vector<Extent>& ranges,
                  const Surroundings& around, const Box& box);

}  // namespace extremal
