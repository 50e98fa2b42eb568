#include "report/branch_orbits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

/// Orbits drawn of a branch that is alone, and of one of several; branches drawn.
constexpr std::size_t most_orbits = 14, most_of_several = 8, most_branches = 8;
constexpr int least_samples = 400, least_of_element = 8;
constexpr double row_gap = 44;  ///< pixels between small panels

/// Of a coordinate; zero where it differs by roundoff alone.
double reach(const Column& values) {
  const Extent found = extent({&values}, 0);
  return found.constant ? 0 : found.size();
}

/// t/T and coordinates; elements are short where the motion is fast.
void sample(const Trajectory& trajectory, Column& tau, std::vector<Column>& q) {
  const int elements = trajectory.elements();
  const int pieces = std::max(least_of_element, (least_samples + elements - 1) / elements);
  const std::size_t n = trajectory.coordinates;
  std::vector<double> place(n), velocity(n);
  q.assign(n, {});
  for (int k = 0; k < elements; ++k)
    for (int i = k == 0 ? 0 : 1; i <= pieces; ++i) {
      const double part = static_cast<double>(i) / pieces;
      trajectory.in_element(k, part, place, velocity);
      tau.push_back((trajectory.times[k] + part * trajectory.length(k)) / trajectory.duration());
      for (std::size_t a = 0; a < n; ++a) q[a].push_back(place[a]);
    }
}

/// Numbers of the branches to be drawn: the first, and those with most points.
std::vector<std::size_t> drawn_branches(const FollowedBranch& branch) {
  std::vector<std::size_t> numbers;
  for (std::size_t b = 0; b < branch.branches.size(); ++b)
    if (branch.branches[b].points > 0) numbers.push_back(b);
  std::stable_sort(numbers.begin() + 1, numbers.end(), [&](std::size_t a, std::size_t b) {
    return branch.branches[a].points > branch.branches[b].points;
  });
  numbers.resize(std::min(numbers.size(), most_branches));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::string caption(const FollowedBranch& branch, std::size_t number) {
  const std::optional<int> origin = branch.branches[number].origin;
  if (!origin) return "first branch";
  const BranchPoint& point = branch.points[*origin];
  const char* kind = point.kind == PointKind::branch ? "branch" : "period doubled";
  return fmt::format("{} at {:.5g}", kind, point.parameter);
}

}  // namespace

Orbits::Orbits(const FollowedBranch& branch, const Annotation& annotation)
    : annotation_(annotation), names_(branch.names), branches_(branch.branches.size()) {
  if (const std::optional<Bodies> found = extremal::bodies(names_)) bodies_ = *found;
  Column parameters;
  for (const BranchPoint& point : branch.points) parameters.push_back(point.parameter);
  const Extent range = extent({&parameters}, 0);
  AxisName named = axis_name(annotation, branch.parameter == "duration" ? "t" : branch.parameter);
  named.name = branch.parameter;
  scale_ = make_axis(named, range.low, range.high, 6);
  choose(branch);
  double most = -1;
  for (const Group& group : groups_)
    for (const Orbit& orbit : group.orbits)
      for (std::size_t a = 0; a < names_.size(); ++a)
        if (const double size = reach(orbit.q[a]); size > most && bodies_.axes.empty()) {
          most = size;
          widest_ = a;
        }
}

void Orbits::choose(const FollowedBranch& branch) {
  const std::vector<std::size_t> numbers = drawn_branches(branch);
  const std::size_t most = numbers.size() > 1 ? most_of_several : most_orbits;
  for (const std::size_t number : numbers) {
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < branch.points.size(); ++k)
      if (branch.points[k].branch == static_cast<int>(number)) points.push_back(k);
    groups_.push_back({numbers.size() > 1 ? caption(branch, number) : "", {}});
    const std::size_t drawn = std::min(points.size(), most);
    for (std::size_t k = 0; k < drawn; ++k) {
      const BranchPoint& point = branch.points[points[drawn > 1 ? k * (points.size() - 1) / (drawn - 1) : 0]];
      Orbit orbit{{}, {}, shade(Palette::curves, scale_.place(point.parameter))};
      sample(point.solution.trajectory, orbit.tau, orbit.q);
      groups_.back().orbits.push_back(std::move(orbit));
    }
    // Small orbits would vanish below large ones.
    const auto size = [](const Orbit& orbit) {
      double most = 0;
      for (const Column& q : orbit.q) most = std::max(most, reach(q));
      return most;
    };
    std::stable_sort(groups_.back().orbits.begin(), groups_.back().orbits.end(),
                     [&](const Orbit& a, const Orbit& b) { return size(a) > size(b); });
  }
}

/// Numbers of the axes along which a body moves in any orbit.
std::vector<std::size_t> Orbits::moving_axes() const {
  std::vector<Extent> ranges;
  double greatest = 0;
  for (std::size_t axis = 0; axis < bodies_.axes.size(); ++axis) {
    std::vector<const Column*> columns;
    for (const Group& group : groups_)
      for (const Orbit& orbit : group.orbits)
        for (const std::vector<std::size_t>& place : bodies_.places) columns.push_back(&orbit.q[place[axis]]);
    ranges.push_back(extent(columns, 0));
    if (!ranges.back().constant) greatest = std::max(greatest, ranges.back().size());
  }
  std::vector<std::size_t> moving;
  for (std::size_t axis = 0; axis < ranges.size(); ++axis)
    if (!ranges[axis].constant && ranges[axis].size() > motionless * greatest) moving.push_back(axis);
  return moving;
}

/// Paths of all bodies along these axes; without axes the coordinate that moves most over t/T.
PathCell Orbits::cell(const Group& group, const std::vector<std::size_t>& axes) const {
  PathCell cell{group.caption, {}};
  for (const Orbit& orbit : group.orbits) {
    if (bodies_.axes.empty() || axes.size() < 2) {
      const std::size_t shown = axes.empty() ? widest_ : bodies_.places[0][axes[0]];
      cell.paths.push_back({.axes = {&orbit.tau, &orbit.q[shown]}, .colour = orbit.colour, .marked = false});
      continue;
    }
    for (const std::vector<std::size_t>& place : bodies_.places) {
      cell.paths.push_back({.axes = {}, .colour = orbit.colour, .marked = false});
      for (const std::size_t axis : axes) cell.paths.back().axes.push_back(&orbit.q[place[axis]]);
    }
  }
  return cell;
}

Surroundings Orbits::around(const std::vector<std::size_t>& axes) const {
  if (bodies_.axes.empty() || axes.size() < 2) {
    const std::size_t shown = axes.empty() ? widest_ : bodies_.places[0][axes[0]];
    return {.axes = {{"t/T"}, axis_name(annotation_, names_[shown])}, .lengths = false};
  }
  return surroundings(annotation_, names_, bodies_, axes);
}

std::vector<Panel> Orbits::panels(double left, double top, double height) const {
  const std::vector<std::size_t> axes = moving_axes();
  std::vector<PathCell> cells;
  if (groups_.size() == 1) {
    std::vector<Panel> panels;
    std::vector<std::vector<std::size_t>> planes{axes};
    if (axes.size() == 3) planes = {{axes[0], axes[1]}, {axes[0], axes[2]}};
    for (const std::vector<std::size_t>& plane : planes) {
      std::vector<Panel> next =
          path_cells({cell(groups_[0], plane)}, around(plane), 1, {.height = height}, left, top);
      left = next[0].box.left + next[0].box.width + 40;
      panels.push_back(std::move(next[0]));
    }
    return panels;
  }
  for (const Group& group : groups_) cells.push_back(cell(group, axes));
  const std::size_t count = cells.size(), columns = count == 2 ? 1 : (count + 1) / 2;
  return path_cells(cells, around(axes), columns, {.width = 205, .height = (height - row_gap) / 2}, left,
                    top);
}

std::vector<std::string> Orbits::remarks() const {
  if (groups_.size() == branches_) return {};
  return {fmt::format("orbits of {} of {} branches", groups_.size(), branches_)};
}

}  // namespace extremal
