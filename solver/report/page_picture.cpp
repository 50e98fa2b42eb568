#include <algorithm>
#include <numeric>

#include "report/page_data.hpp"
#include "report/paths.hpp"
#include "report/solutions.hpp"

namespace extremal {

namespace {

/// Coordinates that have a view of their own phase plane.
constexpr std::size_t most_phase_views = 12;
/// Elements of an array that make a profile.
constexpr std::size_t least_profile = 3;

PageData range_data(const std::vector<Extent>& ranges) {
  PageData list = PageData::array();
  for (const Extent& range : ranges) list.push_back({range.low, range.high});
  return list;
}

/// Columns of a lone solution behind those of velocities.
ForceCurves page_forces(const Picture& picture) {
  return picture.others.empty() && !picture.samples.v.empty() ? force_curves(picture) : ForceCurves{};
}

PageData curve_data(const PlaneCurve& curve) {
  PageData data{{"x", curve.x}, {"y", curve.y}};
  if (curve.t) data["t"] = *curve.t;
  return data;
}

/// The views and panels of a picture. Columns are told by their numbers in page_columns().
class Views {
 public:
  Views(const Picture& picture, bool family)
      : picture_(picture), family_(family), all_(solutions_of(picture)), groups_(families(picture.names)) {
    if (std::optional<Bodies> found = bodies(picture.names)) paths(*found);
    if (panels_.empty()) profile(), curves();
    forces();
    phases();
  }

  PageData views() const { return views_; }
  PageData panels() const { return panels_; }
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  std::size_t velocity_column(std::size_t a) const { return picture_.names.size() + a; }
  bool velocities() const { return !picture_.samples.v.empty(); }
  AxisName axis(const std::string& name) const { return axis_name(picture_.annotation, name); }

  void add_panel(const AxisName& label, const std::vector<std::size_t>& columns,
                 const std::vector<Colour>& colours, const std::vector<std::string>& names) {
    PageData colour_list = PageData::array();
    for (const Colour colour : colours) colour_list.push_back(css_colour(colour));
    PageData panel = page_axis(label);
    panel["columns"] = columns;
    panel["colours"] = std::move(colour_list);
    panel["names"] = names;
    std::vector<const Column*> values;
    const std::size_t n = picture_.names.size();
    for (const Samples* samples : all_)
      for (const std::size_t column : columns)
        values.push_back(column < n       ? &samples->q[column]
                         : column < 2 * n ? &samples->v[column - n]
                                          : page_forces(picture_).columns[column - 2 * n]);
    const Extent range = extent(values, 0.05);
    panel["range"] = {range.low, range.high};
    if (n == 1 && columns.front() == 0 && !picture_.obstacles.empty()) {
      panel["walls"] = PageData::array();
      for (const PlaneCurve& wall : picture_.obstacles) panel["walls"].push_back(curve_data(wall));
    }
    panels_.push_back(std::move(panel));
  }

  /// Forces of contacts and of constraints against time.
  void forces() {
    const ForceCurves found = page_forces(picture_);
    if (found.columns.empty()) return;
    std::vector<std::size_t> columns(found.columns.size());
    std::iota(columns.begin(), columns.end(), 2 * picture_.names.size());
    add_panel({"force"}, columns, distinct_colours(columns.size()), found.names);
  }

  /// Bodies in the plane or in space, without the axis along which none moves.
  void paths(const Bodies& declared) {
    const std::optional<Picture> flat = flattened(picture_, declared);
    const Picture& seen = flat ? *flat : picture_;
    remarks_ = seen.remarks;
    const std::optional<Bodies> found = flat ? bodies(seen.names) : declared;
    if (!found) return;
    std::vector<std::size_t> column;  // of each name that is seen
    for (const std::string& name : seen.names)
      column.push_back(std::ranges::find(picture_.names, name) - picture_.names.begin());
    const Surroundings around = surroundings(seen.annotation, seen.names, *found);
    add_path_view(seen, *found, around, column);
    const std::vector<Colour> colours = distinct_colours(found->places.size());
    for (std::size_t axis = 0; axis < around.axes.size(); ++axis) {
      std::vector<std::size_t> columns;
      for (const std::vector<std::size_t>& place : found->places) columns.push_back(column[place[axis]]);
      add_panel(around.axes[axis], columns, colours, found->names);
    }
  }

  void add_path_view(const Picture& seen, const Bodies& found, const Surroundings& around,
                     const std::vector<std::size_t>& column) {
    PageData list = PageData::array(), centres = PageData::array(), axes = PageData::array();
    const std::vector<Colour> colours = distinct_colours(found.places.size());
    for (std::size_t i = 0; i < found.places.size(); ++i) {
      std::vector<std::size_t> columns;
      for (const std::size_t a : found.places[i]) columns.push_back(column[a]);
      list.push_back({{"name", found.names[i]}, {"colour", css_colour(colours[i])}, {"columns", columns}});
    }
    std::vector<BodyPath> every;
    PageData ranges = PageData::array();
    bool closed = true;
    for (const Samples* samples : solutions_of(seen)) {
      const std::vector<BodyPath> own = body_paths(*samples, found);
      ranges.push_back(range_data(path_extents(own, around.centres)));
      every.insert(every.end(), own.begin(), own.end());
      closed = closed && returns(*samples, found);
    }
    const std::vector<Extent> extents = path_extents(every, around.centres);
    for (const Centre& centre : centres_inside(extents, around.centres))
      centres.push_back({{"name", centre.name}, {"at", centre.at}});
    for (const AxisName& each : around.axes) axes.push_back(page_axis(each));
    const bool one_body = found.places.size() == 1;
    PageData obstacles = PageData::array();
    if (found.axes.size() == 2)
      for (const PlaneCurve& curve : seen.obstacles) obstacles.push_back(curve_data(curve));
    views_.push_back({{"kind", "path"},
                      {"axes", std::move(axes)},
                      {"equal", around.lengths && comparable(extents)},
                      {"together", one_body && (family_ || !closed)},
                      {"closed", closed},
                      {"range", range_data(extents)},
                      {"ranges", std::move(ranges)},
                      {"bodies", std::move(list)},
                      {"obstacles", std::move(obstacles)},
                      {"centres", std::move(centres)}});
  }

  /// Each array over its indices.
  void profile() {
    PageData lines = PageData::array();
    std::size_t longest = 0;
    std::vector<std::string> names;
    std::string unit;
    const auto long_enough = [](const Family& family) { return family.members.size() >= least_profile; };
    const auto count = static_cast<std::size_t>(std::ranges::count_if(groups_, long_enough));
    if (count == 0) return;
    for (const Family& family : groups_) {
      if (!long_enough(family)) continue;
      longest = std::max(longest, family.members.size());
      const Colour colour = distinct_colours(count)[names.size()];
      names.push_back(family.name);
      unit = axis(family.name).unit;
      lines.push_back({{"name", family.name}, {"colour", css_colour(colour)}, {"columns", family.members}});
    }
    PageData ranges = PageData::array();
    const auto reach = [&](const std::vector<const Samples*>& some) {
      std::vector<const Column*> columns;
      for (const Samples* samples : some)
        for (const Family& family : groups_)
          if (long_enough(family))
            for (const std::size_t a : family.members) columns.push_back(&samples->q[a]);
      return range_data({{0.5, static_cast<double>(longest) + 0.5}, extent(columns, 0.07)});
    };
    for (const Samples* samples : all_) ranges.push_back(reach({samples}));
    const AxisName up{names.size() == 1 ? names[0] : "", names.size() == 1 ? unit : ""};
    views_.push_back({{"kind", "profile"},
                      {"axes", PageData::array({page_axis({"index"}), page_axis(up)})},
                      {"equal", false},
                      {"together", true},
                      {"closed", false},
                      {"range", reach(all_)},
                      {"ranges", std::move(ranges)},
                      {"bodies", std::move(lines)},
                      {"centres", PageData::array()}});
  }

  /// A coordinate over itself and its velocity.
  void phases() {
    if (!velocities()) return;
    const std::size_t count = std::min(picture_.names.size(), most_phase_views);
    for (std::size_t a = 0; a < count; ++a) {
      const AxisName across = axis(picture_.names[a]), up = axis(velocity_key(picture_.names[a]));
      PageData ranges = PageData::array();
      std::vector<BodyPath> every;
      const auto path = [&](const Samples& samples) {
        return BodyPath{.axes = {&samples.q[a], &samples.v[a]}};
      };
      for (const Samples* samples : all_) {
        every.push_back(path(*samples));
        ranges.push_back(range_data(path_extents({every.back()}, {})));
      }
      const std::vector<std::size_t> columns{a, velocity_column(a)};
      views_.push_back(
          {{"kind", "phase"},
           {"axes", PageData::array({page_axis(across), page_axis(up)})},
           {"angle", across.unit == "rad"},
           {"equal", false},
           {"together", true},
           {"closed", false},
           {"range", range_data(path_extents(every, {}))},
           {"ranges", std::move(ranges)},
           {"bodies",
            PageData::array({{{"name", ""}, {"colour", css_colour(first_colour)}, {"columns", columns}}})},
           {"centres", PageData::array()}});
    }
  }

  /// Each coordinate or array against time; of a lone one its velocity as well, of too many all in one.
  void curves() {
    const std::size_t count = picture_.names.size();
    if (form_of(picture_) == Form::map && groups_.size() > 1) {
      std::vector<std::size_t> columns(count);
      std::iota(columns.begin(), columns.end(), std::size_t{0});
      return add_panel({}, columns, distinct_colours(count), picture_.names);
    }
    for (const Family& family : groups_) {
      std::vector<std::string> names;
      for (const std::size_t a : family.members) names.push_back(picture_.names[a]);
      const std::size_t curves = family.members.size();
      add_panel(axis(family.name), family.members,
                curves == 1 ? std::vector<Colour>{first_colour} : distinct_colours(curves), names);
    }
    if (count == 1 && velocities()) {
      const std::string name = velocity_key(picture_.names[0]);
      add_panel(axis(name), {velocity_column(0)}, {second_colour}, {name});
    }
  }

  const Picture& picture_;
  bool family_;
  std::vector<const Samples*> all_;
  std::vector<Family> groups_;
  PageData views_ = PageData::array(), panels_ = PageData::array();
  std::vector<std::string> remarks_;
};

}  // namespace

PageData page_picture(const Picture& picture, const PageSolutions& solutions) {
  PageData columns = PageData::array(), list = PageData::array();
  for (const std::string& name : picture.names)
    columns.push_back(page_axis(axis_name(picture.annotation, name)));
  if (!picture.samples.v.empty())
    for (const std::string& name : picture.names)
      columns.push_back(page_axis(axis_name(picture.annotation, velocity_key(name))));
  const ForceCurves forces = page_forces(picture);
  for (const std::string& name : forces.names) columns.push_back(page_axis({name}));
  const std::vector<const Samples*> all = solutions_of(picture);
  const std::size_t stride = page_stride(picture);
  for (std::size_t k = 0; k < all.size(); ++k) {
    PageData solution = page_columns(*all[k], forces.columns, stride);
    solution["label"] = solutions.labels.at(k);
    solution["colour"] = css_colour(solutions.colours.at(k));
    list.push_back(std::move(solution));
  }
  const Views views(picture, solutions.family);
  return {{"time", page_axis(axis_name(picture.annotation, "t"))},
          {"family", solutions.family},
          {"coordinates", picture.names.size()},
          {"columns", std::move(columns)},
          {"views", views.views()},
          {"panels", views.panels()},
          {"remarks", views.remarks()},
          {"solutions", std::move(list)}};
}

}  // namespace extremal
