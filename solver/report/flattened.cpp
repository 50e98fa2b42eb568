#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/solutions.hpp"

namespace extremal {

namespace {

/// Extent of an axis over all bodies and solutions.
Extent axis_extent(const Picture& picture, const Bodies& bodies, std::size_t axis) {
  std::vector<const Column*> columns;
  for (const Samples* samples : solutions_of(picture))
    for (const std::vector<std::size_t>& place : bodies.places) columns.push_back(&samples->q[place[axis]]);
  return extent(columns, 0);
}

Samples selected(const Samples& samples, const std::vector<std::size_t>& coordinates) {
  Samples result{.t = samples.t, .q = {}, .v = {}, .p = {}};
  for (const std::size_t a : coordinates) {
    result.q.push_back(samples.q[a]);
    if (!samples.v.empty()) result.v.push_back(samples.v[a]);
  }
  return result;
}

}  // namespace

std::optional<Picture> flattened(const Picture& picture, const Bodies& bodies) {
  if (bodies.axes.size() != 3) return std::nullopt;
  double greatest = 0;
  std::vector<Extent> ranges;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ranges.push_back(axis_extent(picture, bodies, axis));
    if (!ranges.back().constant) greatest = std::max(greatest, ranges.back().size());
  }
  if (greatest == 0) return std::nullopt;
  Picture flat = picture;
  flat.names.clear();
  std::vector<std::size_t> kept;
  std::vector<bool> across(picture.names.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!ranges[axis].constant && ranges[axis].size() > motionless * greatest) continue;
    const double at = ranges[axis].centre();
    flat.remarks.push_back(
        fmt::format("{} = {:.4g}", bodies.axes[axis], std::abs(at) > motionless * greatest ? at : 0.0));
    for (const std::vector<std::size_t>& place : bodies.places) across[place[axis]] = true;
  }
  for (std::size_t a = 0; a < picture.names.size(); ++a) {
    if (across[a]) continue;
    kept.push_back(a);
    flat.names.push_back(picture.names[a]);
  }
  if (kept.size() == picture.names.size()) return std::nullopt;
  flat.samples = selected(picture.samples, kept);
  for (Samples& other : flat.others) other = selected(other, kept);
  for (std::vector<WaypointImpulse>& waypoints : flat.waypoints)
    for (WaypointImpulse& waypoint : waypoints) {
      std::erase_if(waypoint.impulse, [&](const auto& jump) { return across[jump.first]; });
      for (auto& [a, jump] : waypoint.impulse)
        a = static_cast<int>(std::ranges::find(kept, static_cast<std::size_t>(a)) - kept.begin());
    }
  flat.annotation.centres.clear();
  const std::vector<Family> groups = families(picture.names);
  for (const Centre& centre : picture.annotation.centres) {
    Centre seen{centre.name, {}};
    for (std::size_t group = 0; group < groups.size(); ++group)
      if (!across[groups[group].members[0]]) seen.at.push_back(centre.at.at(group));
    flat.annotation.centres.push_back(std::move(seen));
  }
  return flat;
}

}  // namespace extremal
