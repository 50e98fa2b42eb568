#include "report/figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/branch.hpp"
#include "report/layout.hpp"

namespace extremal {
namespace {

std::vector<std::string> texts(const Axis& axis) {
  std::vector<std::string> list;
  for (const Tick& tick : axis.ticks) list.push_back(tick.text);
  return list;
}

using Texts = std::vector<std::string>;

TEST(Axis, TicksAtRoundNumbers) {
  EXPECT_EQ(texts(make_axis({"x"}, 0, 1, 5)), (Texts{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(texts(make_axis({"x"}, -0.13, 0.52, 4)), (Texts{"0.0", "0.2", "0.4"}));
  EXPECT_EQ(texts(make_axis({"x"}, -3, 3, 3)), (Texts{"−2", "0", "2"}));
  EXPECT_EQ(texts(make_axis({"x"}, 0, 2500, 5)), (Texts{"0", "500", "1000", "1500", "2000", "2500"}));
}

TEST(Axis, TicksAreInsideAndWithinTheCount) {
  for (double low = -3.7; low < 4; low += 0.61) {
    for (double size = 1e-3; size < 1e9; size *= 3.1) {
      for (const double count : {3.0, 5.0, 9.0}) {
        const Axis axis = make_axis({"x"}, low * size, (low + 1) * size, count);
        ASSERT_GE(axis.ticks.size(), 1u);
        ASSERT_LE(static_cast<double>(axis.ticks.size()), count + 1);
        for (const Tick& tick : axis.ticks) {
          ASSERT_GE(axis.place(tick.at), -1e-8);
          ASSERT_LE(axis.place(tick.at), 1 + 1e-8);
        }
      }
    }
  }
}

TEST(Axis, ACommonPowerOfTenGoesIntoTheLabel) {
  const Axis small = make_axis({"x"}, 0, 2e-5, 2);
  EXPECT_EQ(small.label, "x  (10⁻⁵)");
  EXPECT_EQ(texts(small), (Texts{"0", "1", "2"}));
  const Axis large = make_axis({"x"}, -1.5e6, 0, 3);
  EXPECT_EQ(large.label, "x  (10⁶)");
  EXPECT_EQ(texts(large), (Texts{"−1.5", "−1.0", "−0.5", "0.0"}));
}

TEST(Axis, NeighboursOnALargeOffsetDiffer) {
  EXPECT_EQ(texts(make_axis({"x"}, 1.0000001, 1.0000003, 2)), (Texts{"1.0000001", "1.0000002", "1.0000003"}));
}

TEST(Axis, RefusesWhatCannotBeDrawn) {
  EXPECT_THROW(make_axis({"x"}, 1, 1, 5), std::invalid_argument);
  EXPECT_THROW(make_axis({"x"}, -1.7e308, 1.7e308, 5), std::invalid_argument);
  EXPECT_THROW(make_axis({"x"}, 0, std::numeric_limits<double>::quiet_NaN(), 5), std::invalid_argument);
}

TEST(Extent, HasAMarginAtBothSides) {
  const Column a{1, 3}, b{2, 5};
  const Extent range = extent({&a, &b}, 0.25);
  EXPECT_EQ(range.low, 0);
  EXPECT_EQ(range.high, 6);
  EXPECT_FALSE(range.constant);
}

TEST(Extent, OfAConstantIsItsOwnSize) {
  const Column two{2, 2 + 1e-15, 2}, zero{0, 0};
  EXPECT_TRUE(extent({&two}, 0.1).constant);
  EXPECT_NEAR(extent({&two}, 0.1).low, 1, 1e-14);
  EXPECT_NEAR(extent({&two}, 0.1).high, 3, 1e-14);
  EXPECT_EQ(extent({&zero}, 0.1).low, -1);
  EXPECT_EQ(extent({&zero}, 0.1).high, 1);
}

TEST(Printable, ReplacesWhatIsNoText) {
  EXPECT_EQ(printable("a\nb\tc\x01", 10), "a b c ");
  EXPECT_EQ(printable("µ→𝛿 ok", 10), "µ→𝛿 ok");
  EXPECT_EQ(printable("\xC2\x85|\xEF\xBF\xBE|", 10), " | |");
  EXPECT_EQ(printable("\xFF|\xC3|\xC0\x80|\xE0\x80\x80|\xED\xA0\x80|\xF5\x80", 99),
            "\uFFFD|\uFFFD|\uFFFD\uFFFD|\uFFFD\uFFFD\uFFFD|\uFFFD\uFFFD\uFFFD|\uFFFD\uFFFD");
  EXPECT_EQ(printable("\xE2\x82", 9), "\uFFFD\uFFFD");
  EXPECT_EQ(printable("]]>", 9), "]] >");
}

TEST(Printable, ShortensByCharacters) {
  EXPECT_EQ(printable("µµµ", 3), "µµµ");
  EXPECT_EQ(printable("µµµµ", 3), "µµµ…");
}

TEST(Families, OfNames) {
  const std::vector<Family> groups = families({"a", "x[1]", "x[2]", "x", "y[7]"});
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[0].name, "a");
  EXPECT_TRUE(groups[0].indices.empty());
  EXPECT_EQ(groups[1].members, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(groups[1].indices, (Texts{"1", "2"}));
  EXPECT_EQ(groups[2].members, (std::vector<std::size_t>{3}));
  EXPECT_EQ(groups[3].indices, (Texts{"7"}));
}

/// Coordinate a is (a + 1) cos(t + a).
Picture waves(const std::vector<std::string>& names) {
  Picture picture{.title = "Waves", .names = names, .samples = {}};
  picture.samples.q.resize(names.size());
  for (int k = 0; k <= 100; ++k) {
    const double t = 0.03 * k;
    picture.samples.t.push_back(t);
    for (std::size_t a = 0; a < names.size(); ++a) {
      picture.samples.q[a].push_back((static_cast<double>(a) + 1) * std::cos(t + static_cast<double>(a)));
    }
  }
  picture.samples.v = picture.samples.p = picture.samples.q;
  return picture;
}

std::vector<std::string> elements(const std::string& name, int count) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) names.push_back(name + "[" + std::to_string(i) + "]");
  return names;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// "x-y" of each panel with axes.
Texts planes(const Figure& figure) {
  Texts list;
  for (const Panel& panel : figure.panels)
    list.push_back(panel.axes ? panel.x.label + "-" + panel.y.label : "view");
  return list;
}

TEST(Layout, FollowsFromTheNames) {
  EXPECT_EQ(planes(layout(waves({"u"}))), (Texts{"t-u", "t-u'"}));
  EXPECT_EQ(planes(layout(waves({"x", "y"}))), (Texts{"x-y", "t-x", "t-y"}));
  EXPECT_EQ(planes(layout(waves({"x", "y", "z"}))), (Texts{"x-y", "x-z", "y-z", "view"}));
  EXPECT_EQ(planes(layout(waves({"a", "b", "c", "d"}))), (Texts{"t-a", "t-b", "t-c", "t-d"}));
  EXPECT_EQ(planes(layout(waves({"a", "b", "c"}))), (Texts{"t-a", "t-b", "t-c"}));
  EXPECT_EQ(planes(layout(waves({"x", "y", "theta"}))), (Texts{"t-x", "t-y", "t-theta"}));
  EXPECT_EQ(planes(layout(waves(elements("theta", 3)))), (Texts{"t-"}));
  EXPECT_EQ(planes(layout(waves(elements("x", 3)))), (Texts{"t-"}));
  EXPECT_EQ(planes(layout(waves(joined(elements("r", 3), elements("phi", 3))))), (Texts{"t-r", "t-phi"}));
  EXPECT_EQ(planes(layout(waves({"x1", "y1", "x2", "y2"}))), (Texts{"x-y"}));
  EXPECT_EQ(planes(layout(waves(joined(elements("x", 3), elements("y", 3))))), (Texts{"x-y"}));
  EXPECT_EQ(planes(layout(waves(joined(joined(elements("x", 2), elements("y", 2)), elements("z", 2))))),
            (Texts{"x-y", "x-z", "y-z", "view"}));
  EXPECT_EQ(planes(layout(waves(elements("q", 5)))), (Texts{"t-"}));
  EXPECT_EQ(planes(layout(waves(joined({"a"}, elements("q", 5))))), (Texts{"t-a", "t-q"}));
  EXPECT_EQ(planes(layout(waves(elements("q", 64)))), (Texts{"t-index"}));
}

TEST(Layout, VelocitiesMayBeAbsent) {
  Picture picture = waves({"u"});
  picture.samples.v.clear();
  EXPECT_EQ(planes(layout(picture)), (Texts{"t-u"}));
}

TEST(Bodies, OfNames) {
  const auto one = bodies({"x", "y", "z"});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->axes, (Texts{"x", "y", "z"}));
  EXPECT_EQ(one->names, (Texts{""}));
  const auto two = bodies({"x1", "x2", "y1", "y2"});
  ASSERT_TRUE(two);
  EXPECT_EQ(two->names, (Texts{"1", "2"}));
  EXPECT_EQ(two->places, (std::vector<std::vector<std::size_t>>{{0, 2}, {1, 3}}));
  const auto arrays = bodies(joined(elements("qx", 2), elements("qz", 2)));
  ASSERT_TRUE(arrays);
  EXPECT_EQ(arrays->axes, (Texts{"qx", "qz"}));
  EXPECT_TRUE(arrays->lengths);
  const auto angles = bodies({"a", "b"});
  ASSERT_TRUE(angles);
  EXPECT_FALSE(angles->lengths);
  EXPECT_TRUE(bodies(elements("theta", 2))->lengths);
  for (const Texts& names :
       {Texts{"a", "b", "c"}, elements("theta", 3), elements("x", 3), Texts{"x", "y", "phi"},
        joined(elements("x", 3), elements("y", 2)), Texts{"x", "x'", "y"}})
    EXPECT_FALSE(bodies(names)) << names[0];
}

/// `count` solutions; number k runs k times as long.
Picture several(const std::vector<std::string>& names, std::size_t count) {
  Picture picture = waves(names);
  picture.actions = {1};
  for (std::size_t k = 2; k <= count; ++k) {
    picture.others.push_back(picture.samples);
    for (double& t : picture.others.back().t) t *= static_cast<double>(k);
    picture.actions.push_back(static_cast<double>(k));
  }
  return picture;
}

std::size_t keys(const Figure& figure) {
  std::size_t count = 0;
  for (const Panel& panel : figure.panels) count += panel.key.has_value();
  return count;
}

TEST(Layout, SeveralSolutionsAreDrawnTogether) {
  const Figure one = layout(several({"u"}, 3));
  EXPECT_EQ(planes(one), (Texts{"t-u", "t-u'"}));
  for (const Panel& panel : one.panels) {
    ASSERT_EQ(panel.curves.size(), 3u);
    EXPECT_DOUBLE_EQ(panel.curves[2].x.back(), 9);
    EXPECT_GE(panel.x.high, 9);
  }
  ASSERT_EQ(one.legend.size(), 3u);
  EXPECT_EQ(one.legend[2].text, "S = 3");
  const Figure many = layout(several({"u"}, 9));
  EXPECT_TRUE(many.legend.empty());
  ASSERT_EQ(keys(many), 1u);
  EXPECT_EQ(many.panels.back().key->scale.label, "action");
  EXPECT_NE(many.panels[0].curves[0].colour, many.panels[0].curves[8].colour);
  EXPECT_EQ(planes(layout(several({"x", "y"}, 3))), (Texts{"x-y", "t-x", "t-y"}));
  EXPECT_EQ(layout(several({"x", "y"}, 3)).legend[1].text, "S = 2");
  EXPECT_EQ(planes(layout(several({"x", "y", "z"}, 2))), (Texts{"x-y", "x-z", "y-z", "view"}));
  const Figure four = layout(several({"a", "b", "c", "d"}, 4));
  EXPECT_EQ(planes(four), (Texts{"t-a", "t-b", "t-c", "t-d"}));
  for (const Panel& panel : four.panels) EXPECT_EQ(panel.curves.size(), 4u);
}

TEST(Layout, ForcesAreBelowEverything) {
  Picture picture = several({"x", "y"}, 1);
  const double height = layout(picture).height;
  picture.samples.path_forces = {Column(picture.samples.count(), 0.0), Column(picture.samples.count(), 2.0)};
  const Figure figure = layout(picture);
  EXPECT_EQ(planes(figure), (Texts{"x-y", "t-x", "t-y", "t-force"}));
  EXPECT_EQ(figure.panels.back().curves.size(), 1u);  // none of the force that is zero
  EXPECT_GT(figure.panels.back().box.top, height);
  EXPECT_GT(figure.height, figure.panels.back().box.top + figure.panels.back().box.height);
}

TEST(Layout, OrbitsAndSeveralBodiesHaveAPanelForEachSolution) {
  const Figure bodies = layout(several(joined(elements("x", 3), elements("y", 3)), 4));
  ASSERT_EQ(bodies.panels.size(), 4u);
  EXPECT_EQ(bodies.panels[2].caption, "S = 3");
  EXPECT_EQ(bodies.panels[0].x.high, bodies.panels[3].x.high);
  Picture orbits = several({"x", "y"}, 7);
  for (Column& column : orbits.samples.q) column.back() = column.front();
  for (Samples& other : orbits.others)
    for (Column& column : other.q) column.back() = column.front();
  EXPECT_EQ(layout(orbits).panels.size(), 7u);
  const Figure maps = layout(several(elements("q", 64), 2));
  ASSERT_EQ(maps.panels.size(), 2u);
  EXPECT_EQ(maps.panels[1].maps.size(), 1u);
  EXPECT_EQ(layout(several(joined(elements("x", 3), elements("y", 3)), 100)).panels.size(), 60u);
}

TEST(Layout, ActionsAreToldApart) {
  Picture picture = several({"u"}, 3);
  picture.actions = {-1.00001, 1.00001, 1.00002};
  const Figure figure = layout(picture);
  EXPECT_EQ(figure.legend[0].text, "S = −1.00001");
  EXPECT_EQ(figure.legend[2].text, "S = 1.00002");
}

TEST(Layout, AMotionInAPlaneOfSpaceIsDrawnAsSuch) {
  Picture flat = waves({"x", "y", "z"});
  flat.samples.q[2].assign(flat.samples.count(), 0.5);
  Figure figure = layout(flat);
  EXPECT_EQ(planes(figure), (Texts{"x-y", "t-x", "t-y"}));
  EXPECT_EQ(figure.legend.back().text, "z = 0.5");
  flat.samples.q[0].assign(flat.samples.count(), 0);
  EXPECT_EQ(planes(layout(flat)), (Texts{"t-y", "t-y'"}));
  Picture bodies = waves(joined(joined(elements("x", 2), elements("y", 2)), elements("z", 2)));
  for (const std::size_t a : {2u, 3u}) bodies.samples.q[a].assign(bodies.samples.count(), 1e-15);
  EXPECT_EQ(planes(layout(bodies)), (Texts{"x-z"}));
}

TEST(Layout, CentresNearAPathAreMarked) {
  Picture picture = waves({"x", "y", "z"});
  picture.annotation.centres = {{"near", {0.1, -0.2, 0}}, {"far", {50, 0, 0}}};
  const auto crosses = [](const Panel& panel) {
    return std::count_if(panel.marks.begin(), panel.marks.end(),
                         [](const Mark& mark) { return mark.shape == Shape::cross; });
  };
  for (const Panel& panel : layout(picture).panels) EXPECT_EQ(crosses(panel), 1);
  picture.samples.q[1].assign(picture.samples.count(), 0);
  const Panel plane = layout(picture).panels[0];
  EXPECT_EQ(plane.y.label, "z");
  ASSERT_EQ(crosses(plane), 1);
  EXPECT_EQ(plane.marks.back().x, 0.1);
}

TEST(Layout, AxesHaveTheUnitsOfTheSystem) {
  Picture picture = waves({"u"});
  picture.annotation.units = {{"u", "m"}, {"t", "s"}};
  EXPECT_EQ(planes(layout(picture)), (Texts{"t (s)-u (m)", "t (s)-u' (m/s)"}));
  for (double& u : picture.samples.q[0]) u *= 1e7;
  EXPECT_EQ(layout(picture).panels[0].y.label, "u (10⁷ m)");
}

TEST(Layout, PathsHaveEqualScales) {
  const Picture three = waves({"x", "y", "z"});
  for (const Picture& picture :
       {waves({"x", "y"}), three, waves(joined(elements("x", 3), elements("y", 3)))}) {
    double first = 0;
    for (const Panel& panel : layout(picture).panels) {
      if (panel.x.label == "t") continue;
      const double across = panel.box.width / (panel.x.high - panel.x.low);
      const double up = panel.box.height / (panel.y.high - panel.y.low);
      EXPECT_NEAR(across / up, 1, 1e-12);
      if (panel.axes && first == 0) first = across;
      if (panel.axes) {
        EXPECT_NEAR(across / first, 1, 1e-12);
      }
    }
  }
}

TEST(Layout, AStraightPathAlongAnAxisHasEqualScales) {
  Picture picture = waves({"x", "y"});
  for (double& x : picture.samples.q[0]) x *= 1e-5;
  picture.samples.q[1].assign(picture.samples.count(), 0);
  const Panel panel = layout(picture).panels[0];
  EXPECT_NEAR((panel.x.high - panel.x.low) / (panel.y.high - panel.y.low), 1, 1e-12);
}

TEST(Layout, EverythingLiesInsideItsPanelAndPanelsInsideTheFigure) {
  const std::vector<std::vector<std::string>> all{{"u"},
                                                  {"x", "y"},
                                                  {"x", "y", "z"},
                                                  {"a", "b", "c", "d"},
                                                  joined(elements("x", 3), elements("y", 3)),
                                                  elements("q", 64),
                                                  elements("q", 5)};
  for (const std::vector<std::string>& names : all) {
    const Figure figure = layout(waves(names));
    for (const Panel& panel : figure.panels) {
      EXPECT_GT(panel.box.left, 0);
      EXPECT_GT(panel.box.top, 0);
      EXPECT_LT(panel.box.left + panel.box.width, figure.width);
      EXPECT_LE(panel.box.top + panel.box.height, figure.height);
      for (const Curve& curve : panel.curves) {
        for (const double x : curve.x) ASSERT_TRUE(panel.x.place(x) >= 0 && panel.x.place(x) <= 1);
        for (const double y : curve.y) ASSERT_TRUE(panel.y.place(y) >= 0 && panel.y.place(y) <= 1);
      }
    }
  }
}

TEST(Layout, AnOpenPathMarksItsStartAndAClosedOneOnlyItsEnd) {
  Picture picture = waves({"x", "y"});
  const auto shapes = [&] {
    std::vector<Shape> list;
    const Panel panel = layout(picture).panels[0];
    for (const Mark& mark : panel.marks) list.push_back(mark.shape);
    return list;
  };
  EXPECT_EQ(shapes(), (std::vector<Shape>{Shape::ring, Shape::disc}));
  for (Column& column : picture.samples.q) column.back() = column.front();
  EXPECT_EQ(shapes(), (std::vector<Shape>{Shape::disc}));
}

TEST(Layout, SquaresMarkWaypoints) {
  Picture picture = waves({"x", "y"});
  picture.waypoints = {{{.time = 1.005, .impulse = {{1, 0.5}}}}};  // y is fixed there
  const double x = std::cos(1.005), y = 2 * std::cos(2.005);
  const Figure figure = layout(picture);
  const auto expect_square = [](const Panel& panel, double across, double up) {
    ASSERT_FALSE(panel.marks.empty());
    EXPECT_EQ(panel.marks.back().shape, Shape::square);
    EXPECT_NEAR(panel.marks.back().x, across, 1e-3);
    EXPECT_NEAR(panel.marks.back().y, up, 1e-3);
  };
  ASSERT_EQ(figure.panels.size(), 3u);
  expect_square(figure.panels[0], x, y);
  EXPECT_TRUE(figure.panels[1].marks.empty());
  expect_square(figure.panels[2], 1.005, y);
  EXPECT_EQ(figure.legend.back().text, "waypoint");
  Picture lone = waves({"x"});
  lone.waypoints = {{{.time = 1.005, .impulse = {{0, 0.5}}}}};
  expect_square(layout(lone).panels[0], 1.005, x);
  Picture space = waves({"x", "y", "z"});
  space.waypoints = picture.waypoints;
  const Figure views = layout(space);
  ASSERT_EQ(views.panels.size(), 4u);
  for (const Panel& panel : views.panels) EXPECT_EQ(panel.marks.back().shape, Shape::square);
  expect_square(views.panels[0], x, y);
}

TEST(AxisNames, HaveTheUnitsOfEndValuesAndNoneOfFormulas) {
  const Annotation annotation{.units = {{"theta", "rad"}, {"q", "m"}, {"t", "s"}}, .centres = {}};
  const auto unit = [&](const std::string& name) { return axis_name(annotation, name).unit; };
  EXPECT_EQ(unit("theta"), "rad");
  EXPECT_EQ(unit("theta'"), "rad/s");
  EXPECT_EQ(unit("theta(0)"), "rad");
  EXPECT_EQ(unit("theta'(T)"), "rad/s");
  EXPECT_EQ(unit("q[2]"), "m");
  EXPECT_EQ(unit("q[2]'(0)"), "m/s");
  EXPECT_EQ(unit("theta'(0)*l"), "");
  EXPECT_EQ(unit("theta(0) - theta(T)"), "");
  EXPECT_EQ(unit("q[1](0) - q[2](0)"), "");
}

/// In DejaVu Sans at 13 pixels, by the advances of its glyphs.
TEST(Texts, AreNoWiderThanTheirRoom) {
  EXPECT_GT(text_width("w2 = 2.28898 ± 0.042"), 0.97 * 147);
  EXPECT_GT(text_width("c = 0.184989 ± 0.014"), 0.97 * 145);
}

TEST(Layout, AMapHasTheValuesAtTheirPlaces) {
  const Panel panel = layout(waves(elements("q", 16))).panels[0];
  const ColourMap& map = panel.maps.at(0);
  EXPECT_TRUE(map.diverging);
  EXPECT_EQ(map.scale.low, -map.scale.high);
  EXPECT_EQ(map.values.size(), map.rows * map.columns);
  ASSERT_EQ(map.rows % 16, 0u);
  for (const std::size_t element : {0u, 7u, 15u}) {
    const std::size_t row = element * map.rows / 16, column = 40;
    const double t = 3.0 * (column + 0.5) / static_cast<double>(map.columns);
    const double expected = (element + 1.0) * std::cos(t + static_cast<double>(element));
    EXPECT_NEAR(map.values[row * map.columns + column], expected, 16 * 0.03 * 0.03 / 8);
  }
}

TEST(Layout, LargeSystemsMakeBoundedFigures) {
  const Panel panel = layout(waves(elements("q", 5000))).panels[0];
  EXPECT_LE(panel.maps.at(0).values.size(), 640u * 640u);
  std::vector<std::string> scalars;
  for (int i = 0; i < 40; ++i) scalars.push_back("a" + std::to_string(i));
  EXPECT_EQ(planes(layout(waves(scalars))), (Texts{"t-coordinate"}));
}

/// Motions q = a t/T on a branch: λ = 1 − (a − 1)², which folds at a = 1, and another that begins at a = 0.5.
FollowedBranch parabola() {
  FollowedBranch branch{.title = "Fold", .parameter = "lambda", .names = {"q"}, .points = {}, .branches = {}};
  const auto add = [&](double a, int number, PointKind kind) {
    BranchPoint point{.parameter = 1 - (a - 1) * (a - 1), .kind = kind, .branch = number, .solution = {}};
    point.solution.trajectory = {.coordinates = 1, .degree = 1, .times = {0, 1}, .nodes = {0, a}};
    point.solution.morse_index = a > 1;
    branch.points.push_back(point);
  };
  for (const double a : {0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.55, 1.7})
    add(a, 0, a == 1 ? PointKind::fold : a == 0.5 ? PointKind::branch : PointKind::regular);
  add(0.6, 1, PointKind::regular);
  add(0.7, 1, PointKind::regular);
  branch.branches = {{.points = 13}, {.origin = 3, .points = 2}};
  return branch;
}

TEST(BranchLayout, ADiagramAndSolutionsWithAKey) {
  const FollowedBranch branch = parabola();
  BranchQuantity heights{"q(T)", {}};
  for (const BranchPoint& point : branch.points) heights.values.push_back(point.solution.trajectory.nodes[1]);
  const Figure figure = layout(BranchPicture{branch, heights, {.units = {{"lambda", "N"}}, .centres = {}}});
  const Panel& diagram = figure.panels[0];
  EXPECT_EQ(diagram.x.label, "lambda (N)");
  EXPECT_EQ(diagram.y.label, "q(T)");
  EXPECT_EQ(planes(figure), (Texts{"lambda (N)-q(T)", "t/T-q", "t/T-q", "view"}));
  EXPECT_EQ(figure.panels[2].caption, "branch at 0.75");
  ASSERT_EQ(keys(figure), 1u);
  EXPECT_EQ(figure.panels.back().key->scale.label, "lambda (N)");
  Texts legend;
  for (const LegendEntry& entry : figure.legend) legend.push_back(entry.text);
  EXPECT_EQ(legend, (Texts{"index 0", "higher index", "branch", "fold"}));
  // Curves pass through the points, turn at the fold and not beyond, and begin where branches cross.
  double farthest = 0;
  for (const Curve& curve : diagram.curves)
    for (const double x : curve.x) farthest = std::max(farthest, x);
  EXPECT_NEAR(farthest, 1, 1e-12);
  EXPECT_NEAR(diagram.curves.back().x.front(), 0.75, 1e-12);
  EXPECT_NEAR(diagram.curves.back().y.front(), 0.5, 1e-12);
  // Between the points they are near the parabola.
  for (const Curve& curve : diagram.curves)
    for (std::size_t k = 0; k < curve.x.size(); ++k)
      EXPECT_NEAR(curve.x[k], 1 - std::pow(curve.y[k] - 1, 2), 0.01);
}

TEST(BranchLayout, PointsWithoutAQuantityAreLeftOut) {
  const FollowedBranch branch = parabola();
  BranchQuantity heights{"log(q(0))", std::vector<double>(branch.points.size(), NAN)};
  EXPECT_THROW(layout(BranchPicture{branch, heights}), std::invalid_argument);
  heights.values[1] = heights.values[2] = 3;
  const Panel diagram = layout(BranchPicture{branch, heights}).panels[0];
  EXPECT_EQ(diagram.marks.size(), 2u);
}

TEST(Colours, Differ) {
  for (const std::size_t count : {1u, 3u, 6u, 7u, 40u}) {
    const std::vector<Colour> colours = distinct_colours(count);
    ASSERT_EQ(colours.size(), count);
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = 0; b < a; ++b) ASSERT_NE(colours[a], colours[b]) << count;
    }
  }
}

}  // namespace
}  // namespace extremal
