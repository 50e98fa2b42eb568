#include "report/solutions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace extremal {

namespace {

bool is_fixed(const WaypointImpulse& waypoint, std::size_t coordinate) {
  return std::ranges::any_of(
      waypoint.impulse, [&](const auto& jump) { return static_cast<std::size_t>(jump.first) == coordinate; });
}

/// Those of one solution that fix a coordinate, on its curve.
void mark_waypoints(const std::vector<WaypointImpulse>& waypoints, const Samples& samples, std::size_t a,
                    Colour colour, TimePanel& panel) {
  for (const WaypointImpulse& waypoint : waypoints)
    if (is_fixed(waypoint, a))
      panel.marks.push_back(
          {waypoint.time, value_at(samples.t, samples.q[a], waypoint.time), colour, Shape::square});
}

}  // namespace

std::vector<BodyPath> body_paths(const Samples& samples, const Bodies& bodies,
                                 const std::vector<WaypointImpulse>& waypoints) {
  const std::vector<Colour> colours = distinct_colours(bodies.places.size());
  std::vector<BodyPath> paths;
  for (std::size_t i = 0; i < bodies.places.size(); ++i) {
    paths.push_back({.axes = {},
                     .name = bodies.names[i].empty() ? "" : "body " + bodies.names[i],
                     .colour = colours[i],
                     .t = &samples.t});
    for (const std::size_t a : bodies.places[i]) paths.back().axes.push_back(&samples.q[a]);
    for (const WaypointImpulse& waypoint : waypoints) {
      BodyWaypoint passed{waypoint.time, {}};
      for (std::size_t axis = 0; axis < bodies.places[i].size(); ++axis)
        if (is_fixed(waypoint, bodies.places[i][axis])) passed.axes.push_back(axis);
      if (!passed.axes.empty()) paths.back().waypoints.push_back(std::move(passed));
    }
  }
  return paths;
}

bool returns(const Samples& samples, const Bodies& bodies) {
  for (const std::vector<std::size_t>& place : bodies.places)
    for (const std::size_t a : place) {
      const Column& q = samples.q[a];
      const Extent range = extent({&q}, 0);
      if (!range.constant && std::abs(q.back() - q.front()) > 1e-3 * range.size()) return false;
    }
  return true;
}

namespace {

constexpr std::size_t most_curves = 8;      ///< of one array in a time plot; a longer one is a map
constexpr std::size_t most_panels = 12;     ///< time plots below each other
constexpr std::size_t most_solutions = 60;  ///< drawn, each in a panel of its own

/// Panels against time that fill a figure, and the key of their colours.
Figure time_panel_figure(const Picture& picture, const SolutionColours& key,
                         const std::vector<TimePanel>& contents, double height) {
  Figure figure = headed_figure(picture.title, key.legend, picture.remarks);
  const double top = top_of_panels(figure);
  figure.width = std::max(figure.width, 860.0);
  figure.height = top + height + bottom;
  figure.panels =
      time_panels(axis_name(picture.annotation, "t"), picture.samples.t, contents, {20, top, 816, height});
  if (key.scale) add_key(figure, *key.scale);
  return figure;
}

/// A coordinate of all solutions against time.
TimePanel coordinate_panel(const Picture& picture, std::size_t a, const SolutionColours& key) {
  TimePanel panel{
      .label = axis_name(picture.annotation, picture.names[a]), .columns = {}, .colours = key.colours};
  for (const Samples* samples : solutions_of(picture)) {
    const std::size_t k = panel.columns.size();
    mark_waypoints(waypoints_of(picture, k), *samples, a, key.colours[k], panel);
    panel.columns.push_back(&samples->q[a]);
    panel.times.push_back(&samples->t);
  }
  return panel;
}

Figure lone_figure(const Picture& picture) {
  const SolutionColours key = solution_colours(picture);
  TimePanel velocity{.label = axis_name(picture.annotation, velocity_key(picture.names[0])),
                     .columns = {},
                     .colours = key.colours};
  if (key.colours.size() == 1) velocity.colours = {second_colour};
  for (const Samples* samples : solutions_of(picture)) {
    velocity.times.push_back(&samples->t);
    if (!samples->v.empty()) velocity.columns.push_back(&samples->v[0]);
  }
  std::vector<TimePanel> contents{coordinate_panel(picture, 0, key)};
  if (velocity.columns.size() == key.colours.size()) contents.push_back(velocity);
  return time_panel_figure(picture, key, contents, contents.size() == 1 ? 360 : 500);
}

/// Each coordinate of all solutions, one below the other.
Figure coordinate_figure(const Picture& picture) {
  const SolutionColours key = solution_colours(picture);
  std::vector<TimePanel> contents;
  for (std::size_t a = 0; a < picture.names.size(); ++a)
    contents.push_back(coordinate_panel(picture, a, key));
  return time_panel_figure(picture, key, contents, 190 * static_cast<double>(contents.size()) - 40);
}

Figure time_figure(const Picture& picture, const std::vector<Family>& groups) {
  std::vector<TimePanel> contents;
  for (const Family& family : groups) {
    TimePanel panel{.label = axis_name(picture.annotation, family.name), .columns = {}};
    for (const std::size_t a : family.members) panel.columns.push_back(&picture.samples.q[a]);
    panel.colours = distinct_colours(panel.columns.size());
    for (std::size_t k = 0; k < family.members.size(); ++k)
      mark_waypoints(waypoints_of(picture, 0), picture.samples, family.members[k], panel.colours[k], panel);
    if (groups.size() == 1 && panel.label.unit.empty()) panel.label.name.clear();
    for (const std::string& index : family.indices) panel.names.push_back(family.name + "[" + index + "]");
    contents.push_back(std::move(panel));
  }
  const double panel_height = groups.size() == 1 ? 380 : 150;
  return time_panel_figure(picture, {}, contents,
                           static_cast<double>(groups.size()) * (panel_height + 40) - 40);
}

/// Of bodies, and of the ends of paths where those are marked apart.
std::vector<LegendEntry> path_legend(const std::vector<BodyPath>& paths, bool closed) {
  std::vector<LegendEntry> entries;
  if (paths.size() > 1 && paths.size() <= longest_legend)
    for (const BodyPath& path : paths) entries.push_back({path.name, path.colour});
  const Colour colour = paths.size() == 1 ? paths[0].colour : 0x5A606B;
  if (!closed) {
    entries.push_back({"start", colour, Shape::ring});
    entries.push_back({"end", colour, Shape::disc});
  }
  if (std::ranges::any_of(paths, [](const BodyPath& path) { return !path.waypoints.empty(); }))
    entries.push_back({"waypoint", colour, Shape::square});
  return entries;
}

/// A panel for each solution.
Figure cells_figure(const Picture& picture, const Bodies& bodies, bool closed) {
  const SolutionColours key = solution_colours(picture);
  const std::vector<std::string> texts = action_texts(picture.actions);
  const std::vector<const Samples*> all = solutions_of(picture);
  std::vector<PathCell> cells;
  for (std::size_t k = 0; k < std::min(all.size(), most_solutions); ++k) {
    cells.push_back({texts[k], body_paths(*all[k], bodies, waypoints_of(picture, k))});
    if (bodies.places.size() == 1) cells.back().paths[0].colour = key.colours[k];
  }
  std::vector<std::string> remarks = picture.remarks;
  if (all.size() > cells.size())
    remarks.push_back(fmt::format("the first {} of {} solutions", cells.size(), all.size()));
  Figure figure = headed_figure(picture.title, path_legend(cells[0].paths, closed), remarks);
  const std::size_t count = cells.size();
  const std::size_t columns = count <= 4 ? count : count <= 8 ? 4 : count <= 15 ? 5 : 6;
  const double width = std::min(280.0, 1000.0 / static_cast<double>(columns));
  figure.panels = path_cells(cells, surroundings(picture.annotation, picture.names, bodies), columns,
                             {.width = width}, 20, top_of_panels(figure));
  const Box box = covered(figure.panels);
  figure.width = std::max(figure.width, box.width + 28);
  figure.height = box.height + bottom;
  return figure;
}

/// Paths between ends over each other; of several bodies or orbits each solution by itself.
Figure path_figure(const Picture& picture, const Bodies& bodies) {
  const std::vector<const Samples*> all = solutions_of(picture);
  const bool one_body = bodies.places.size() == 1;
  const bool closed =
      std::all_of(all.begin(), all.end(), [&](const Samples* each) { return returns(*each, bodies); });
  if (all.size() > 1 && (closed || !one_body)) return cells_figure(picture, bodies, closed);
  const SolutionColours key = solution_colours(picture);
  std::vector<BodyPath> paths = body_paths(*all[0], bodies, waypoints_of(picture, 0));
  std::vector<LegendEntry> legend = path_legend(paths, closed);
  legend.insert(legend.begin(), key.legend.begin(), key.legend.end());
  for (std::size_t k = 0; k < all.size() && one_body; ++k) {
    if (k > 0) paths.push_back(body_paths(*all[k], bodies, waypoints_of(picture, k))[0]);
    paths[k].colour = key.colours[k];
  }
  Figure figure = headed_figure(picture.title, legend, picture.remarks);
  const Surroundings around = surroundings(picture.annotation, picture.names, bodies);
  figure = bodies.axes.size() == 2
               ? plane_figure(std::move(figure), paths, around, axis_name(picture.annotation, "t"), one_body)
               : space_figure(std::move(figure), paths, around);
  if (key.scale) add_key(figure, *key.scale);
  return figure;
}

/// Boundaries of obstacles and, thick, where the path is in contact: below the path.
void add_obstacles(const Picture& picture, Panel& panel) {
  constexpr Colour obstacle_colour = 0x5A606B;
  constexpr double thick = 5;
  std::vector<Curve> curves;
  for (const PlaneCurve& obstacle : picture.obstacles)
    if (!obstacle.t) curves.push_back({obstacle.x, obstacle.y, obstacle_colour});
  const Samples& samples = picture.samples;
  const Column& across = samples.q.size() == 1 ? samples.t : samples.q[0];
  const Column& up = samples.q.size() == 1 ? samples.q[0] : samples.q[1];
  for (const Contact& contact : picture.contacts) {
    Curve curve{{}, {}, second_colour, thick};
    for (std::size_t k = 0; k < samples.count(); ++k)
      if (samples.t[k] >= contact.from && samples.t[k] <= contact.to) {
        curve.x.push_back(across[k]);
        curve.y.push_back(up[k]);
      }
    if (curve.x.size() > 1) curves.push_back(std::move(curve));
  }
  panel.curves.insert(panel.curves.begin(), curves.begin(), curves.end());
}

Figure layout_of(const Picture& picture) {
  const Form form = form_of(picture);
  if (form == Form::lone) return lone_figure(picture);
  if (form == Form::paths) {
    const Bodies found = *bodies(picture.names);
    const std::optional<Picture> flat = flattened(picture, found);
    return flat ? layout_of(*flat) : path_figure(picture, found);
  }
  const std::vector<Family> groups = families(picture.names);
  if (form == Form::map && groups.size() == 1)
    return map_figure(picture, axis_name(picture.annotation, groups[0].name), "index", groups[0].members);
  if (form == Form::map) {
    std::vector<std::size_t> all(picture.names.size());
    for (std::size_t a = 0; a < all.size(); ++a) all[a] = a;
    return map_figure(picture, {}, "coordinate", all);
  }
  return picture.others.empty() ? time_figure(picture, groups) : coordinate_figure(picture);
}

/// Forces of contacts and of constraints against time, below everything else.
void add_forces(const Picture& picture, Figure& figure) {
  constexpr double force_height = 130, above = 30;
  const ForceCurves forces = force_curves(picture);
  if (forces.columns.empty() || !picture.others.empty()) return;
  const TimePanel content{.label = {"force"}, .columns = forces.columns, .names = forces.names};
  const Box box{20, figure.height + above, figure.width - 48, force_height};
  for (Panel& panel : time_panels(axis_name(picture.annotation, "t"), picture.samples.t, {content}, box))
    figure.panels.push_back(std::move(panel));
  figure.height += above + force_height + bottom;
}

}  // namespace

ForceCurves force_curves(const Picture& picture) {
  ForceCurves found;
  const auto add = [&](const std::vector<Column>& forces, const char* name) {
    for (std::size_t k = 0; k < forces.size(); ++k) {
      if (std::ranges::all_of(forces[k], [](double force) { return force == 0; })) continue;
      found.columns.push_back(&forces[k]);
      found.names.push_back(fmt::format("{} {}", name, k + 1));
    }
  };
  add(picture.samples.path_forces, "contact");
  add(picture.samples.constraint_forces, "constraint");
  if (found.columns.size() > most_curves) return {};
  return found;
}

Form form_of(const Picture& picture) {
  const std::size_t count = picture.names.size();
  if (count == 1) return Form::lone;
  if (bodies(picture.names)) return Form::paths;
  const std::size_t groups = families(picture.names).size();
  if (groups == 1 && count > most_curves) return Form::map;
  if (groups > most_panels || (!picture.others.empty() && count > most_panels)) return Form::map;
  return Form::curves;
}

Figure layout(const Picture& picture) {
  Figure figure = layout_of(picture);
  const bool plane = picture.names.size() <= 2 && figure.panels.front().caption.empty();
  if (plane && (!picture.obstacles.empty() || !picture.contacts.empty()))
    add_obstacles(picture, figure.panels.front());
  add_forces(picture, figure);
  return figure;
}

}  // namespace extremal
