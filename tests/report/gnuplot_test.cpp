#include "report/gnuplot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace extremal {
namespace {

/// In gnuplot's units, 40 a pixel.
struct Vertex {
  double x, y;
};
constexpr double pixel = 40, side = 400 * pixel;

/// The points that the script draws for a curve y(x) over the unit square.
template <class Function>
std::vector<Vertex> drawn(const Function& y) {
  Panel panel{.box = {0, 0, 400, 400}, .x = make_axis({"x"}, 0, 1, 5), .y = make_axis({"y"}, 0, 1, 5)};
  Curve curve;
  for (int k = 0; k <= 800; ++k) {
    curve.x.push_back(k / 800.0);
    curve.y.push_back(y(k / 800.0));
  }
  panel.curves.push_back(curve);
  const Figure figure{.width = 400, .height = 400, .title = "", .panels = {panel}};
  const std::string script = gnuplot_script(figure, Format::svg);
  const std::string start = "$d0 << EOD\n";
  std::istringstream in(script.substr(script.find(start) + start.size()));
  std::vector<Vertex> vertices;
  for (Vertex vertex{}; in >> vertex.x >> vertex.y;) vertices.push_back(vertex);
  return vertices;
}

double distance(const std::vector<Vertex>& polygon, const Vertex& p) {
  double least = INFINITY;
  for (std::size_t k = 0; k + 1 < polygon.size(); ++k) {
    const Vertex &a = polygon[k], &b = polygon[k + 1];
    const double x = b.x - a.x, y = b.y - a.y;
    const double t = std::clamp(((p.x - a.x) * x + (p.y - a.y) * y) / (x * x + y * y), 0.0, 1.0);
    least = std::min(least, std::hypot(p.x - a.x - t * x, p.y - a.y - t * y));
  }
  return least;
}

TEST(Gnuplot, ALineHasTwoPoints) {
  EXPECT_EQ(drawn([](double x) { return 0.3 + 0.5 * x; }).size(), 2u);
}

TEST(Gnuplot, CurvesAreExactToATwentiethOfAPixel) {
  const auto wave = [](double x) { return 0.5 + 0.5 * std::sin(12 * x); };
  const std::vector<Vertex> polygon = drawn(wave);
  EXPECT_LT(polygon.size(), 200u);
  constexpr double rounding = 1.5;
  for (int k = 0; k <= 800; ++k)
    EXPECT_LE(distance(polygon, {side * k / 800, side * wave(k / 800.0)}), pixel / 20 + rounding);
}

/// A line whose points are all outside crosses the panel nevertheless.
TEST(Gnuplot, DrawsLinesThatCrossThePanel) {
  const Panel panel{.box = {0, 0, 400, 400}, .x = make_axis({"x"}, 0, 1, 5), .y = make_axis({"y"}, 0, 1, 5)};
  const Figure figure{.width = 400, .height = 400, .title = "", .panels = {panel}};
  EXPECT_NE(gnuplot_script(figure, Format::png).find("set clip two\n"), std::string::npos);
}

}  // namespace
}  // namespace extremal
