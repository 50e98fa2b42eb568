#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/page_data.hpp"

namespace extremal {

namespace {

/// Samples of each orbit; of many orbits fewer, but these at least in each element and in all.
constexpr int most_samples = 400, most_in_all = 60'000, least_of_element = 2;

Samples orbit(const Trajectory& trajectory, int wanted) {
  const std::size_t n = trajectory.coordinates;
  const int elements = trajectory.elements();
  const int pieces = std::max(least_of_element, (wanted + elements - 1) / elements);
  Samples samples{.t = {}, .q = std::vector<Column>(n), .v = std::vector<Column>(n), .p = {}};
  std::vector<double> q(n), v(n);
  for (int k = 0; k < elements; ++k)
    for (int i = k == 0 ? 0 : 1; i <= pieces; ++i) {
      const double part = static_cast<double>(i) / pieces;
      trajectory.in_element(k, part, q, v);
      samples.t.push_back(trajectory.times[k] + part * trajectory.length(k));
      for (std::size_t a = 0; a < n; ++a) {
        samples.q[a].push_back(q[a]);
        samples.v[a].push_back(v[a]);
      }
    }
  return samples;
}

PageData picture_of(const BranchPicture& picture, std::vector<Samples> orbits) {
  const FollowedBranch& branch = picture.branch;
  Picture drawn{
      .title = branch.title, .names = branch.names, .samples = {}, .annotation = picture.annotation};
  std::vector<std::string> labels;
  for (const BranchPoint& point : branch.points)
    labels.push_back(fmt::format("{} = {:.6g}", branch.parameter, point.parameter));
  drawn.samples = std::move(orbits.front());
  orbits.erase(orbits.begin());
  drawn.others = std::move(orbits);
  return page_picture(drawn, {labels, branch_colours(branch), true});
}

}  // namespace

std::vector<Samples> orbits_of(const FollowedBranch& branch) {
  const int wanted = std::min(most_samples, most_in_all / static_cast<int>(branch.points.size()));
  std::vector<Samples> orbits;
  for (const BranchPoint& point : branch.points) orbits.push_back(orbit(point.solution.trajectory, wanted));
  return orbits;
}

PageData branch_data(const BranchPicture& picture, PageData result, std::vector<Samples> orbits) {
  Figure diagram;
  diagram.panels.push_back(branch_diagram(picture, diagram.legend));
  PageData places = PageData::array(), colours = PageData::array();
  const FollowedBranch& branch = picture.branch;
  for (std::size_t k = 0; k < branch.points.size(); ++k) {
    const double up = picture.quantity.values[k];
    places.push_back(std::isfinite(up) ? PageData{branch.points[k].parameter, up} : PageData(nullptr));
  }
  for (const Colour colour : branch_colours(branch)) colours.push_back(css_colour(colour));
  return {{"kind", "branch"},
          {"title", branch.title},
          {"parameter", branch.parameter},
          {"result", std::move(result)},
          {"picture", orbits.empty() ? PageData(nullptr) : picture_of(picture, std::move(orbits))},
          {"diagram", page_figure(diagram)},
          {"places", std::move(places)},
          {"colours", std::move(colours)},
          {"figures", PageData::array()}};
}

}  // namespace extremal
