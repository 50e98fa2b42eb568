#include <nlohmann/json.hpp>
#include <vector>

#include "command.hpp"

using namespace extremal::test;
using Json = nlohmann::json;

namespace {

/// Of the points of a kind on a branch, this number.
std::vector<double> values_at(const Json& result, int branch, const std::string& kind,
                              const std::string& name) {
  std::vector<double> values;
  for (const Json& point : result["points"])
    if (point["branch"] == branch && point["kind"] == kind) values.push_back(point[name]);
  return values;
}

/// Three equal masses whose force falls like r^−(a + 1).
const std::string eight =
    "[system]\ncoordinates = ['x1', 'y1', 'x2', 'y2', 'x3', 'y3']\nparameters = { a = 0.9 }\n"
    "lagrangian = \"(x1'^2 + y1'^2 + x2'^2 + y2'^2 + x3'^2 + y3'^2)/2 + (((x1 - x2)^2 + (y1 - y2)^2)^(-a/2) "
    "+ ((x1 - x3)^2 + (y1 - y3)^2)^(-a/2) + ((x2 - x3)^2 + (y2 - y3)^2)^(-a/2))/a\"\n"
    "[boundary]\nperiodic = true\nduration = '2*pi'\n"
    "[guess]\n"
    "x1 = '1.1*sin(2*pi*t/T)'\ny1 = '0.35*sin(4*pi*t/T)'\n"
    "x2 = '1.1*sin(2*pi*(t/T + 1/3))'\ny2 = '0.35*sin(4*pi*(t/T + 1/3))'\n"
    "x3 = '1.1*sin(2*pi*(t/T + 2/3))'\ny3 = '0.35*sin(4*pi*(t/T + 2/3))'\n"
    "[continuation]\nparameter = 'a'\nto = 1.5\npoints = 30\n";

/// Lyapunov orbits about L1 of Earth and Moon, and what branches off from them.
const std::string lyapunov =
    "[system]\nuse = 'cr3bp'\nparameters = { mu = '0.0123000371/1.0123000371' }\n"
    "[boundary]\nperiodic = true\nduration = 2.695\n"
    "[guess]\nx = '0.8369152 - 0.005*cos(2*pi*t/T)'\ny = '0.0179*sin(2*pi*t/T)'\nz = '0'\n"
    "[continuation]\nparameter = 'duration'\nto = 3\npoints = 18\nswitch = true\n";

}  // namespace

/// H. Fukuda, T. Fujiwara, H. Ozaki, J. Phys. A 51 (2018) 145201: bifurcations at a = 0.9966 and 1.3424,
/// between which the index is 2; it is 4 before and 0 after.
TEST_F(Command, FigureEightOfOtherForces) {
  write("scene.toml", eight);
  const Outcome o = extremal({"continue", "scene.toml", "--output", "b.json"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const Json b = Json::parse(read_text(folder / "b.json"));
  const std::vector<double> found = values_at(b, 0, "branch", "parameter");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 0.9966, 5e-5);
  EXPECT_NEAR(found[1], 1.3424, 5e-5);
  for (const Json& point : b["points"]) {
    if (point["kind"] != "regular") continue;
    const double a = point["parameter"];
    EXPECT_EQ(point["morse_index"], a < found[0] ? 4 : a < found[1] ? 2 : 0) << a;
  }
}

/// arXiv 1903.01195: halo orbits begin at a constant of Jacobi C = −2E in [3.1743503, 3.1743536]; their
/// period doubles at 3.0216192479264.
TEST_F(Command, HaloOrbitsOfEarthAndMoon) {
  write("scene.toml", lyapunov);
  const Outcome o = extremal({"continue", "scene.toml", "--output", "b.json"});
  ASSERT_EQ(o.exit, 0) << o.error;
  const Json b = Json::parse(read_text(folder / "b.json"));
  const std::vector<double> begin = values_at(b, 0, "branch", "energy");
  ASSERT_FALSE(begin.empty());
  EXPECT_GT(-2 * begin[0], 3.1743503);
  EXPECT_LT(-2 * begin[0], 3.1743536);
  const std::vector<double> doubled = values_at(b, 1, "period-doubling", "energy");
  ASSERT_FALSE(doubled.empty());
  EXPECT_NEAR(-2 * doubled[0], 3.0216192479264, 1e-11);
}
