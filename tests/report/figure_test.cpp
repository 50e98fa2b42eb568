#include "report/figure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
  EXPECT_EQ(texts(make_axis("x", 0, 1, 5)), (Texts{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(texts(make_axis("x", -0.13, 0.52, 4)), (Texts{"0.0", "0.2", "0.4"}));
  EXPECT_EQ(texts(make_axis("x", -3, 3, 3)), (Texts{"−2", "0", "2"}));
  EXPECT_EQ(texts(make_axis("x", 0, 2500, 5)), (Texts{"0", "500", "1000", "1500", "2000", "2500"}));
}

TEST(Axis, TicksAreInsideAndWithinTheCount) {
  for (double low = -3.7; low < 4; low += 0.61) {
    for (double size = 1e-3; size < 1e9; size *= 3.1) {
      for (const double count : {3.0, 5.0, 9.0}) {
        const Axis axis = make_axis("x", low * size, (low + 1) * size, count);
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
  const Axis small = make_axis("x", 0, 2e-5, 2);
  EXPECT_EQ(small.label, "x  (10⁻⁵)");
  EXPECT_EQ(texts(small), (Texts{"0", "1", "2"}));
  const Axis large = make_axis("x", -1.5e6, 0, 3);
  EXPECT_EQ(large.label, "x  (10⁶)");
  EXPECT_EQ(texts(large), (Texts{"−1.5", "−1.0", "−0.5", "0.0"}));
}

TEST(Axis, NeighboursOnALargeOffsetDiffer) {
  EXPECT_EQ(texts(make_axis("x", 1.0000001, 1.0000003, 2)), (Texts{"1.0000001", "1.0000002", "1.0000003"}));
}

TEST(Axis, RefusesWhatCannotBeDrawn) {
  EXPECT_THROW(make_axis("x", 1, 1, 5), std::invalid_argument);
  EXPECT_THROW(make_axis("x", -1.7e308, 1.7e308, 5), std::invalid_argument);
  EXPECT_THROW(make_axis("x", 0, std::numeric_limits<double>::quiet_NaN(), 5), std::invalid_argument);
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

TEST(Layout, SeveralSolutionsAreDrawnTogether) {
  const auto several = [](const std::vector<std::string>& names, std::size_t count) {
    Picture picture = waves(names);
    picture.labels = {"1"};
    for (std::size_t k = 2; k <= count; ++k) {
      picture.others.push_back(picture.samples);
      for (double& t : picture.others.back().t) t *= static_cast<double>(k);
      picture.labels.push_back(std::to_string(k));
    }
    return layout(picture);
  };
  const Figure one = several({"u"}, 3);
  EXPECT_EQ(planes(one), (Texts{"t-u", "t-u'"}));
  for (const Panel& panel : one.panels) {
    ASSERT_EQ(panel.curves.size(), 3u);
    EXPECT_DOUBLE_EQ(panel.curves[2].x.back(), 9);
    EXPECT_GE(panel.x.high, 9);
  }
  ASSERT_EQ(one.panels[0].legend.size(), 3u);
  EXPECT_EQ(one.panels[0].legend[2].text, "3");
  EXPECT_TRUE(several({"u"}, 9).panels[0].legend.empty());
  EXPECT_EQ(planes(several({"x", "y"}, 3)), (Texts{"x-y"}));
  EXPECT_EQ(several({"x", "y"}, 3).panels[0].legend[1].text, "2");
  EXPECT_EQ(planes(several({"x", "y", "z"}, 2)), (Texts{"x-y", "x-z", "y-z", "view"}));
  const Figure first = several({"a", "b", "c", "d"}, 4);
  EXPECT_EQ(first.title, "Waves (the first of 4 solutions)");
  EXPECT_EQ(first.panels[0].curves.size(), 1u);
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
