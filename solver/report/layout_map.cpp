#include <algorithm>

#include "report/solutions.hpp"

namespace extremal {

namespace {

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
  return map;
}

/// One scale for all maps.
void set_scale(std::vector<ColourMap>& maps, const AxisName& name) {
  std::vector<const Column*> values;
  for (const ColourMap& map : maps) values.push_back(&map.values);
  Extent range = extent(values, 0);
  const bool diverging = range.low < 0 && range.high > 0;
  if (diverging) {
    range.high = std::max(-range.low, range.high);
    range.low = -range.high;
  }
  for (ColourMap& map : maps) {
    map.diverging = diverging;
    map.scale = make_axis(name, range.low, range.high, 6);
  }
}

}  // namespace

Figure map_figure(const Picture& picture, const AxisName& name, const std::string& row_name,
                  const std::vector<std::size_t>& members) {
  std::vector<const Samples*> all = solutions_of(picture);
  const bool several = all.size() > 1;
  const double height = several ? 200 : 420;
  std::vector<ColourMap> maps;
  for (const Samples* samples : all)
    maps.push_back(colour_map(*samples, members, static_cast<std::size_t>(height)));
  set_scale(maps, name);
  Figure figure = headed_figure(picture.title, {}, picture.remarks);
  figure.width = std::max(figure.width, 900.0);
  double top = top_of_panels(figure);
  const std::vector<std::string> captions =
      several ? action_texts(picture.actions) : std::vector<std::string>(1);
  for (std::size_t k = 0; k < all.size(); ++k) {
    Panel panel{.box = {}, .x = {}, .y = {}};
    panel.y = make_axis({row_name}, 0.5, static_cast<double>(members.size()) + 0.5, several ? 5 : 9);
    panel.x = make_axis(axis_name(picture.annotation, "t"), all[k]->t.front(), all[k]->t.back(), 9);
    panel.caption = captions[k];
    const double left = 20 + number_width(panel.y), right = 44 + number_width(maps[k].scale);
    panel.box = {left, top, 900 - left - right, height};
    panel.maps.push_back(std::move(maps[k]));
    figure.panels.push_back(std::move(panel));
    figure.height = top + height + bottom;
    top += height + 90;
  }
  return figure;
}

}  // namespace extremal
