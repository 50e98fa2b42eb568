#include "report/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

constexpr std::size_t most_curves = 8;   ///< of one array in a time plot; a longer one is a map
constexpr std::size_t most_panels = 12;  ///< time plots below each other

/// All solutions, the first one first.
std::vector<const Samples*> solutions_of(const Picture& picture) {
  std::vector<const Samples*> all{&picture.samples};
  for (const Samples& other : picture.others) all.push_back(&other);
  return all;
}

Figure lone_figure(const Picture& picture) {
  const std::string& name = picture.names[0];
  TimePanel place{.label = name, .columns = {}, .names = {}, .colour = first_colour};
  if (picture.labels.size() <= longest_legend) place.names = picture.labels;
  TimePanel velocity{.label = velocity_key(name), .columns = {}, .names = {}, .colour = second_colour};
  for (const Samples* samples : solutions_of(picture)) {
    place.columns.push_back(&samples->q[0]);
    place.times.push_back(&samples->t);
    velocity.times.push_back(&samples->t);
    if (!samples->v.empty()) velocity.columns.push_back(&samples->v[0]);
  }
  std::vector<TimePanel> contents{place};
  if (velocity.columns.size() == place.columns.size()) contents.push_back(velocity);
  const double top = top_of_panels(picture.title);
  Figure figure{
      .width = 860, .height = top + (contents.size() == 1 ? 360 : 500) + 56, .title = picture.title};
  figure.panels =
      time_panels(picture.samples.t, contents, {20, top, figure.width - 44, figure.height - top - 56});
  return figure;
}

/// The path of each solution through two or three coordinates.
std::vector<BodyPath> solution_paths(const Picture& picture) {
  const std::vector<const Samples*> all = solutions_of(picture);
  const std::vector<Colour> colours = distinct_colours(all.size());
  std::vector<BodyPath> paths;
  for (std::size_t k = 0; k < all.size(); ++k) {
    BodyPath path{.axes = {}, .name = all.size() > 1 ? picture.labels[k] : "", .colour = colours[k]};
    for (const Column& column : all[k]->q) path.axes.push_back(&column);
    paths.push_back(std::move(path));
  }
  return paths;
}

Figure time_figure(const Picture& picture, const std::vector<Family>& groups) {
  std::vector<TimePanel> contents;
  for (const Family& family : groups) {
    TimePanel panel{.label = family.name, .columns = {}, .names = family.indices, .colour = first_colour};
    for (const std::size_t a : family.members) panel.columns.push_back(&picture.samples.q[a]);
    if (groups.size() == 1) panel.label = "";
    for (std::string& index : panel.names) index = family.name + "[" + index + "]";
    contents.push_back(std::move(panel));
  }
  const double top = top_of_panels(picture.title);
  const double panel_height = groups.size() == 1 ? 380 : 150;
  const double height = static_cast<double>(groups.size()) * (panel_height + 40) - 40;
  Figure figure{.width = 860, .height = top + height + 56, .title = picture.title};
  figure.panels = time_panels(picture.samples.t, contents, {20, top, figure.width - 44, height});
  return figure;
}

/// Values at `count` equally spaced places of a row of samples, linear between them.
Column resampled(const Column& t, const Column& values, std::size_t count) {
  Column result(count);
  std::size_t k = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const double fraction = (static_cast<double>(j) + 0.5) / static_cast<double>(count);
    const double time = t.front() + fraction * (t.back() - t.front());
    while (k + 2 < t.size() && t[k + 1] < time) ++k;
    const double weight = (time - t[k]) / (t[k + 1] - t[k]);
    result[j] = (1 - weight) * values[k] + weight * values[k + 1];
  }
  return result;
}

/// Rows are repeated, or some left out, so that there are about as many as pixels.
ColourMap colour_map(const Samples& samples, const std::vector<std::size_t>& members, std::size_t pixels) {
  const std::size_t count = members.size();
  ColourMap map{.columns = std::min<std::size_t>(samples.count(), 640),
                .rows = count < pixels ? count * (pixels / count) : pixels,
                .values = {},
                .scale = {}};
  map.values.reserve(map.columns * map.rows);
  for (std::size_t row = 0; row < map.rows; ++row) {
    const Column line = resampled(samples.t, samples.q[members[row * count / map.rows]], map.columns);
    map.values.insert(map.values.end(), line.begin(), line.end());
  }
  Extent range = extent({&map.values}, 0);
  map.diverging = range.low < 0 && range.high > 0;
  if (map.diverging) {
    range.high = std::max(-range.low, range.high);
    range.low = -range.high;
  }
  map.scale = make_axis("", range.low, range.high, 6);
  return map;
}

Figure map_figure(const Picture& picture, const std::string& name, const std::string& row_name,
                  const std::vector<std::size_t>& members) {
  const double top = top_of_panels(picture.title), height = 420;
  Figure figure{.width = 900, .height = top + height + 56, .title = picture.title};
  Panel panel;
  panel.y = make_axis(row_name, 0.5, static_cast<double>(members.size()) + 0.5, 9);
  panel.x = make_axis("t", picture.samples.t.front(), picture.samples.t.back(), 9);
  panel.maps.push_back(colour_map(picture.samples, members, static_cast<std::size_t>(height)));
  panel.maps[0].scale.label = name + panel.maps[0].scale.label;
  const double left = 20 + number_width(panel.y), right = 44 + number_width(panel.maps[0].scale);
  panel.box = {left, top, figure.width - left - right, height};
  figure.panels.push_back(std::move(panel));
  return figure;
}

/// One body for each element of arrays that have one length.
std::vector<BodyPath> bodies(const Picture& picture, const std::vector<Family>& groups) {
  const std::size_t count = groups[0].members.size();
  const std::vector<Colour> colours = distinct_colours(count);
  std::vector<BodyPath> paths(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const Family& family : groups) paths[i].axes.push_back(&picture.samples.q[family.members[i]]);
    if (!groups[0].indices.empty()) paths[i].name = groups[0].indices[i];
    paths[i].colour = colours[i];
  }
  return paths;
}

/// The first solution alone, and the title says so.
Picture first_of(const Picture& picture) {
  const std::string note = fmt::format("the first of {} solutions", picture.others.size() + 1);
  return {picture.title.empty() ? note : fmt::format("{} ({})", picture.title, note), picture.names,
          picture.samples};
}

}  // namespace

std::vector<Family> families(const std::vector<std::string>& names) {
  std::vector<Family> groups;
  for (std::size_t a = 0; a < names.size(); ++a) {
    const std::size_t bracket = names[a].find('[');
    const std::string base = names[a].substr(0, bracket);
    const bool known = bracket != std::string::npos && !groups.empty() && groups.back().name == base;
    if (!known) groups.push_back({base, {}, {}});
    groups.back().members.push_back(a);
    if (bracket != std::string::npos) {
      groups.back().indices.push_back(names[a].substr(bracket + 1, names[a].size() - bracket - 2));
    }
  }
  return groups;
}

Figure layout(const Picture& picture) {
  const std::size_t count = picture.names.size();
  std::vector<Family> groups = families(picture.names);
  if (count == 1) return lone_figure(picture);
  if (count == 2 || count == 3) {
    const std::vector<BodyPath> paths = solution_paths(picture);
    return count == 2 ? plane_figure(picture, paths, picture.names)
                      : space_figure(picture, paths, picture.names);
  }
  if (!picture.others.empty()) return layout(first_of(picture));
  const std::size_t length = groups[0].members.size();
  const bool one_length = std::all_of(groups.begin(), groups.end(),
                                      [&](const Family& each) { return each.members.size() == length; });
  if (one_length && groups.size() == 2) {
    return plane_figure(picture, bodies(picture, groups), {groups[0].name, groups[1].name});
  }
  if (one_length && groups.size() == 3) {
    return space_figure(picture, bodies(picture, groups), {groups[0].name, groups[1].name, groups[2].name});
  }
  if (groups.size() == 1 && length > most_curves) {
    return map_figure(picture, groups[0].name, "index", groups[0].members);
  }
  if (groups.size() > most_panels) {
    std::vector<std::size_t> all(count);
    for (std::size_t a = 0; a < count; ++a) all[a] = a;
    return map_figure(picture, "", "coordinate", all);
  }
  return time_figure(picture, groups);
}

}  // namespace extremal
