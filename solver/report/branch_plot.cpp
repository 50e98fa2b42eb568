#include <algorithm>
#include <set>
#include <stdexcept>

#include "report/branch.hpp"
#include "report/layout.hpp"

namespace extremal {

namespace {

constexpr double room = 0.06, height = 420;
constexpr Colour dark = 0x22262C, third_colour = 0x009E73;
/// Orbits drawn, and points of each.
constexpr std::size_t most_orbits = 14, samples = 400;

/// What is drawn upwards: the action hides what little energies and durations differ by.
const char* height_name(const FollowedBranch& branch) {
  if (branch.parameter == "energy") return "duration";
  return branch.parameter == "duration" ? "energy" : "action";
}

double height_of(const FollowedBranch& branch, const Solution& solution) {
  if (branch.parameter == "energy") return solution.duration();
  return branch.parameter == "duration" ? solution.energy.value_or(0) : solution.action;
}

/// What the colour of a branch says: of periodic orbits their stability, of others whether they are minima.
struct Kinds {
  bool orbits;
  const char* good() const { return orbits ? "stable" : "index 0"; }
  const char* bad() const { return orbits ? "unstable" : "higher index"; }
  bool is_good(const BranchPoint& point) const {
    const Solution& solution = point.solution;
    return orbits ? solution.floquet && solution.floquet->stable() : solution.morse_index == 0;
  }
};

Axis axis(const std::string& label, const std::vector<const Column*>& values, double pixels) {
  const Extent range = extent(values, room);
  return make_axis(label, range.low, range.high, pixels / 75);
}

std::vector<Curve> branch_curves(const FollowedBranch& branch, const Column& x, const Column& y,
                                 const Kinds& kinds) {
  std::vector<Curve> curves;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    const BranchPoint &from = branch.points[k], &to = branch.points[k + 1];
    if (from.branch != to.branch) continue;
    // At what is located there is no telling.
    const bool good = kinds.is_good(to.kind == PointKind::regular ? to : from);
    const Colour colour = good ? first_colour : second_colour;
    const bool on = !curves.empty() && curves.back().colour == colour && curves.back().x.back() == x[k] &&
                    curves.back().y.back() == y[k];
    if (!on) curves.push_back({{x[k]}, {y[k]}, colour, from.branch == 0 ? 2.0 : 1.3});
    curves.back().x.push_back(x[k + 1]);
    curves.back().y.push_back(y[k + 1]);
  }
  return curves;
}

void add_marks(const FollowedBranch& branch, const Column& x, const Column& y, Panel& panel) {
  std::set<PointKind> seen;
  const auto style = [](PointKind kind) -> std::pair<Colour, Shape> {
    if (kind == PointKind::period_doubling) return {third_colour, Shape::disc};
    return {dark, kind == PointKind::fold ? Shape::disc : Shape::ring};
  };
  for (std::size_t k = 0; k < x.size(); ++k) {
    const PointKind kind = branch.points[k].kind;
    if (kind == PointKind::regular) continue;
    const auto [colour, shape] = style(kind);
    panel.marks.push_back({x[k], y[k], colour, shape});
    if (seen.insert(kind).second) panel.legend.push_back({name(kind), colour, shape});
  }
}

Panel branch_panel(const FollowedBranch& branch, Box box) {
  const bool orbits = std::any_of(branch.points.begin(), branch.points.end(),
                                  [](const BranchPoint& p) { return p.solution.floquet.has_value(); });
  const Kinds kinds{orbits};
  Column x, y;
  for (const BranchPoint& point : branch.points) {
    x.push_back(point.parameter);
    y.push_back(height_of(branch, point.solution));
  }
  Panel panel;
  panel.x = axis(branch.parameter, {&x}, box.width);
  panel.y = axis(height_name(branch), {&y}, box.height);
  const double shift = number_width(panel.y);
  panel.box = {box.left + shift, box.top, box.width - shift, box.height};
  panel.curves = branch_curves(branch, x, y, kinds);
  for (const bool good : {true, false}) {
    const Colour colour = good ? first_colour : second_colour;
    if (std::any_of(panel.curves.begin(), panel.curves.end(),
                    [&](const Curve& curve) { return curve.colour == colour; }))
      panel.legend.push_back({good ? kinds.good() : kinds.bad(), colour, Shape::line});
  }
  add_marks(branch, x, y, panel);
  return panel;
}

/// Columns t/T and the coordinates of one solution.
std::vector<Column> sampled(const Trajectory& trajectory) {
  const std::size_t n = trajectory.coordinates;
  std::vector<Column> columns(n + 1);
  std::vector<double> q(n), v(n);
  for (std::size_t k = 0; k <= samples; ++k) {
    const double tau = static_cast<double>(k) / samples;
    trajectory.at(tau * trajectory.duration(), q, v);
    columns[0].push_back(tau);
    for (std::size_t a = 0; a < n; ++a) columns[a + 1].push_back(q[a]);
  }
  return columns;
}

/// Numbers of two such columns.
struct Pair {
  std::size_t across, up;
};

/// Solutions evenly from the first point to the last.
std::vector<std::vector<Column>> chosen_solutions(const FollowedBranch& branch) {
  const std::size_t count = branch.points.size(), drawn = std::min(count, most_orbits);
  std::vector<std::vector<Column>> solutions;
  for (std::size_t k = 0; k < drawn; ++k) {
    const std::size_t point = drawn > 1 ? k * (count - 1) / (drawn - 1) : 0;
    solutions.push_back(sampled(branch.points[point].solution.trajectory));
  }
  return solutions;
}

/// Columns of every solution against others, one pair for each body. Places have equal scales, unless that
/// would leave a line.
Panel orbit_panel(const std::vector<std::vector<Column>>& solutions, const std::vector<Pair>& pairs,
                  const std::string& across_label, const std::string& up_label, Box box) {
  constexpr double greatest_elongation = 12;
  std::vector<const Column*> xs, ys;
  for (const std::vector<Column>& solution : solutions)
    for (const Pair& pair : pairs) {
      xs.push_back(&solution[pair.across]);
      ys.push_back(&solution[pair.up]);
    }
  Extent x = extent(xs, room), y = extent(ys, room);
  const bool places = pairs[0].across != 0;
  if (places && std::max(x.size(), y.size()) <= greatest_elongation * std::min(x.size(), y.size())) {
    box.width = std::clamp(box.height * x.size() / y.size(), 0.6 * box.height, 1.4 * box.height);
    const double scale = std::max(x.size() / box.width, y.size() / box.height);
    x = {x.centre() - scale * box.width / 2, x.centre() + scale * box.width / 2};
    y = {y.centre() - scale * box.height / 2, y.centre() + scale * box.height / 2};
  }
  Panel panel;
  panel.x = make_axis(across_label, x.low, x.high, box.width / 75);
  panel.y = make_axis(up_label, y.low, y.high, box.height / 75);
  const double shift = number_width(panel.y);
  panel.box = {box.left + shift, box.top, box.width, box.height};
  const std::vector<Colour> colours = distinct_colours(std::max<std::size_t>(solutions.size(), 7));
  for (std::size_t k = 0; k < solutions.size(); ++k)
    for (const Pair& pair : pairs)
      panel.curves.push_back({solutions[k][pair.across], solutions[k][pair.up], colours[k], 1.3});
  return panel;
}

/// Whether a second column does, in any solution.
bool moves(const std::vector<std::vector<Column>>& solutions, const std::vector<Pair>& pairs) {
  std::vector<const Column*> across, up;
  for (const std::vector<Column>& solution : solutions)
    for (const Pair& pair : pairs) {
      across.push_back(&solution[pair.across]);
      up.push_back(&solution[pair.up]);
    }
  const Extent range = extent(up, 0);
  return !range.constant && range.size() > 1e-9 * extent(across, 0).size();
}

/// The column that moves most in any solution.
std::size_t widest(const std::vector<std::vector<Column>>& solutions) {
  std::size_t best = 1;
  double most = -1;
  for (const std::vector<Column>& solution : solutions)
    for (std::size_t a = 1; a < solution.size(); ++a)
      if (const double size = extent({&solution[a]}, 0).size(); size > most) {
        most = size;
        best = a;
      }
  return best;
}

}  // namespace

Figure layout(const FollowedBranch& branch) {
  if (branch.points.empty()) throw std::invalid_argument("cannot plot a branch without points");
  const double top = top_of_panels(branch.title) + 24, wide = 620, gap = 44;
  Figure figure{.width = gap + wide, .height = top + height + 56, .title = branch.title};
  figure.panels.push_back(branch_panel(branch, {gap, top, wide, height}));
  const std::vector<std::vector<Column>> solutions = chosen_solutions(branch);
  const std::vector<std::string>& names = branch.names;
  const auto add = [&](const std::vector<Pair>& pairs, const std::string& across, const std::string& up) {
    figure.panels.push_back(
        orbit_panel(solutions, pairs, across, up, {figure.width + gap, top, 460, height}));
    figure.width = figure.panels.back().box.left + figure.panels.back().box.width;
  };
  // Paths of bodies in the plane or in space; of other systems the coordinate that moves most against time.
  const std::vector<Family> groups = families(names);
  const std::size_t bodies = groups[0].members.size();
  const bool of_bodies =
      (groups.size() == 2 || groups.size() == 3) &&
      std::all_of(groups.begin(), groups.end(), [&](const Family& f) { return f.members.size() == bodies; });
  for (std::size_t up = 1; of_bodies && up < groups.size(); ++up) {
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < bodies; ++i)
      pairs.push_back({groups[0].members[i] + 1, groups[up].members[i] + 1});
    if (up == 1 || moves(solutions, pairs)) add(pairs, groups[0].name, groups[up].name);
  }
  if (!of_bodies) {
    const std::size_t shown = widest(solutions);
    add({{0, shown}}, "t/T", names[shown - 1]);
  }
  figure.width += 28;
  return figure;
}

std::string plot_image(const std::string& path, const FollowedBranch& branch) {
  return plot_image(path, layout(branch));
}

}  // namespace extremal
