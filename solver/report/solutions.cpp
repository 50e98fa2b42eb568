#include "report/solutions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace extremal {

std::vector<const Samples*> solutions_of(const Picture& picture) {
  std::vector<const Samples*> all{&picture.samples};
  for (const Samples& other : picture.others) all.push_back(&other);
  return all;
}

const std::vector<WaypointImpulse>& waypoints_of(const Picture& picture, std::size_t solution) {
  static const std::vector<WaypointImpulse> none;
  return solution < picture.waypoints.size() ? picture.waypoints[solution] : none;
}

namespace {

/// With the sign that axes have.
std::string number_text(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", std::abs(value), digits);
  return (value < 0 ? "−" : "") + text;
}

}  // namespace

std::vector<std::string> action_texts(const Column& actions) {
  constexpr int fewest = 4, most = 8;
  for (int digits = fewest;; ++digits) {
    std::vector<std::string> texts;
    bool apart = true;
    for (std::size_t k = 0; k < actions.size(); ++k) {
      texts.push_back("S = " + number_text(actions[k], digits));
      const double gap = k > 0 ? std::abs(actions[k] - actions[k - 1]) : 0;
      apart = apart && !(gap > 1e-9 * std::abs(actions[k]) && texts[k] == texts[k - 1]);
    }
    if (apart || digits == most) return texts;
  }
}

SolutionColours solution_colours(const Picture& picture) {
  const std::size_t count = picture.others.size() + 1;
  SolutionColours result{distinct_colours(count), {}, {}};
  if (count == 1) return result;
  const std::vector<std::string> texts = action_texts(picture.actions);
  if (count <= longest_legend) {
    for (std::size_t k = 0; k < count; ++k) result.legend.push_back({texts[k], result.colours[k]});
    return result;
  }
  const Extent range = extent({&picture.actions}, 0);
  result.scale = make_axis(axis_name(picture.annotation, "action"), range.low, range.high, 8);
  for (std::size_t k = 0; k < count; ++k)
    result.colours[k] = shade(Palette::curves, result.scale->place(picture.actions[k]));
  return result;
}

}  // namespace extremal
