#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/branch_point.hpp"
#include "solve/branch/limits.hpp"
#include "solve/branch/tracker.hpp"

/// \file Extremals of one value that are a family, which a branch goes across.

namespace extremal {

using namespace limits::held_family;

/// Equations that are singular to the last digit respond to no load: a little beside the path, and in another
/// time, they do.
bool Tracker::move_aside(double by) {
  const double unit = by * state.units.extent;
  for (int k = 1; k < path_.elements(); ++k)
    for (int a = 0; a < path_.coordinates(); ++a)
      path_.set_node(k, a, path_.node(k)[a] + unit * std::sin(k * (a + 1.0) + path_.mesh()[k]));
  path_.load_ends();
  if (family_.varied != Varied::parameter) return branch_.set_coordinate((1 + by) * path_.duration());
  path_.set_duration((1 + by) * path_.duration());
  return true;
}

/// Responses to loads in turn, what responded before held: null directions come first.
std::vector<Move> Tracker::responses(int count, std::vector<double>& sizes) {
  std::vector<Move> found;
  for (int k = 0; k < count; ++k) {
    Move response;
    branch_.hold(found);
    if (!respond(response, k)) break;
    const double size = std::sqrt(branch_.dot(response, response));
    if (!(std::isfinite(size) && size > 0)) break;
    sizes.push_back(size);
    found.push_back(std::move(response));
    found.back().scale(1 / size);
  }
  branch_.hold({});
  return found;
}

/// Null directions stand apart by as much as the error of the path allows: along those that are soft and not
/// null the path is determined. Jacobi fields have 2n constants.
bool Tracker::hold_family() {
  const double apart = std::clamp(1 / (change * error_ / state.units.extent), least_apart, most_apart);
  const BranchState at = state;
  branch_.set_regular();
  branch_.hold_family({});
  branch_.bind();
  std::vector<double> sizes;
  std::vector<Move> directions;
  if (move_aside(limits::held_family::hardly))
    directions = responses(std::min(2 * path_.coordinates(), most_suspected) + 1, sizes);
  std::size_t count = 0;
  for (std::size_t k = 1; k < sizes.size(); ++k)
    if (sizes[k - 1] > apart * sizes[k]) count = k;
  directions.resize(count);
  return hold_at(at, std::move(directions)) && count > 0;
}

bool Tracker::hold_family_anew() {
  const BranchState at = state;
  branch_.hold_family({});
  std::vector<double> sizes;
  std::vector<Move> directions;
  if (move_aside(safely)) directions = responses(static_cast<int>(at.family.size()), sizes);
  return directions.size() == at.family.size() && hold_at(at, std::move(directions));
}

/// With the tangent across them.
bool Tracker::hold_at(BranchState at, std::vector<Move> directions) {
  at.family = std::move(directions);
  return return_to(at) && update_tangent();
}

void Tracker::let_family_go(const BranchState& at, double rest) {
  branch_.ask_regular();
  begin(at, rest);
}

}  // namespace extremal
