#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr std::string_view letters = "xyz";

/// A coordinate as the place of a body along an axis.
struct Place {
  std::size_t axis = 0;   ///< 0, 1, 2
  std::string axis_name;  ///< "x" of "x[1]"; "qx" of "qx"
  std::string body;       ///< what else stands in the name: "1"
};

/// Of "x", "x1", "x[1]", "qx" and "qx[1]".
std::optional<Place> place_of(const std::string& name) {
  const std::size_t bracket = std::min(name.find('['), name.size());
  const std::string base = name.substr(0, bracket);
  for (const std::size_t at : {std::size_t{0}, base.size() - 1}) {
    const auto lower = static_cast<char>(std::tolower(static_cast<unsigned char>(base[at])));
    const std::size_t axis = letters.find(lower);
    if (axis == letters.npos) continue;
    std::string rest = base;
    rest.erase(at, 1);
    const std::string index =
        bracket < name.size() ? name.substr(bracket + 1, name.size() - bracket - 2) : "";
    // Bodies of another spelling, q or Q, are other bodies.
    return Place{axis, base, index.empty() || rest.empty() ? rest + index : rest + " " + index};
  }
  return std::nullopt;
}

struct Body {
  std::string name;
  std::array<std::optional<std::size_t>, 3> coordinates;
};

/// The bodies whose places the coordinates are; none where another coordinate is among them.
std::vector<Body> bodies_in(const std::vector<std::string>& names) {
  std::vector<Body> found;
  for (std::size_t a = 0; a < names.size(); ++a) {
    const std::optional<Place> place = place_of(names[a]);
    if (!place) return {};
    auto body =
        std::find_if(found.begin(), found.end(), [&](const Body& b) { return b.name == place->body; });
    if (body == found.end()) body = found.insert(found.end(), {place->body, {}});
    if (body->coordinates[place->axis]) return {};
    body->coordinates[place->axis] = a;
  }
  return found;
}

bool same_axes(const Body& a, const Body& b) {
  return std::equal(a.coordinates.begin(), a.coordinates.end(), b.coordinates.begin(),
                    [](const auto& x, const auto& y) { return x.has_value() == y.has_value(); });
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

std::optional<Bodies> bodies(const std::vector<std::string>& names) {
  const std::vector<Body> found = bodies_in(names);
  Bodies result;
  if (!found.empty() &&
      std::all_of(found.begin(), found.end(), [&](const Body& body) { return same_axes(body, found[0]); })) {
    for (std::size_t axis = 0; axis < letters.size(); ++axis) {
      if (!found[0].coordinates[axis]) continue;
      const std::string name = place_of(names[*found[0].coordinates[axis]])->axis_name;
      const bool common = std::all_of(found.begin(), found.end(), [&](const Body& body) {
        return place_of(names[*body.coordinates[axis]])->axis_name == name;
      });
      result.axes.push_back(common ? name : std::string(1, letters[axis]));
    }
    for (const Body& body : found) {
      result.names.push_back(found.size() > 1 ? body.name : "");
      result.places.emplace_back();
      for (const std::optional<std::size_t>& coordinate : body.coordinates)
        if (coordinate) result.places.back().push_back(*coordinate);
    }
    if (result.axes.size() > 1) return result;
  }
  // Any two coordinates span a plane; those of one array are of one kind.
  if (names.size() == 2) return Bodies{names, {{0, 1}}, {""}, families(names).size() == 1};
  return std::nullopt;
}

Surroundings surroundings(const Annotation& annotation, const std::vector<std::string>& names,
                          const Bodies& bodies, const std::vector<std::size_t>& axes) {
  Surroundings around{.axes = {}, .centres = {}, .lengths = bodies.lengths};
  const std::vector<Family> groups = families(names);
  std::vector<std::size_t> of_axis;  // the declared coordinate
  for (const std::size_t axis : axes) {
    const std::size_t a = bodies.places[0][axis];
    around.axes.push_back({bodies.axes[axis], axis_name(annotation, names[a]).unit});
    const auto holds = [&](const Family& family) {
      return std::find(family.members.begin(), family.members.end(), a) != family.members.end();
    };
    of_axis.push_back(std::find_if(groups.begin(), groups.end(), holds) - groups.begin());
  }
  if (!around.lengths)
    around.lengths = !around.axes[0].unit.empty() && around.axes[0].unit == around.axes[1].unit;
  for (const Centre& centre : annotation.centres) {
    around.centres.push_back({centre.name, {}});
    for (const std::size_t group : of_axis) around.centres.back().at.push_back(centre.at.at(group));
  }
  return around;
}

Surroundings surroundings(const Annotation& annotation, const std::vector<std::string>& names,
                          const Bodies& bodies) {
  std::vector<std::size_t> axes;
  for (std::size_t axis = 0; axis < bodies.axes.size(); ++axis) axes.push_back(axis);
  return surroundings(annotation, names, bodies, axes);
}

}  // namespace extremal
