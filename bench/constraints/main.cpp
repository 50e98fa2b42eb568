#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "../repeated_solve.hpp"

// Mechanisms by constraints between Cartesian coordinates and by angles: the same motions, solved in one run.

namespace bench {
namespace {

struct Pair {
  std::string name, constrained, minimal;
};

std::string swing(const std::string& angle, const std::string& rest) {
  return fmt::format("{{ x = \"l*sin({0})\", y = \"-l*cos({0})\" }}\n{1}", angle, rest);
}

const std::string rod =
    "[system]\ncoordinates = [\"x\", \"y\"]\nparameters = { m = 1.5, l = 2.0, g = 9.81 }\n"
    "lagrangian = \"m*(x'^2 + y'^2)/2 - m*g*y\"\nconstraints = [\"x^2 + y^2 = l^2\"]\n[boundary]\n";
const std::string rod_by_angle =
    "[system]\ncoordinates = [\"a\"]\nparameters = { m = 1.5, l = 2.0, g = 9.81 }\n"
    "lagrangian = \"m*l^2*a'^2/2 + m*g*l*cos(a)\"\n[boundary]\n";
const std::string orbit = "periodic = true\nduration = \"free\"\nenergy = -8\n[guess]\nduration = 3.1\n";

Pair pendulum() {
  return {"pendulum", rod + "start = " + swing("-0.5", "end = ") + swing("1.2", "duration = 1.3\n"),
          rod_by_angle + "start = { a = -0.5 }\nend = { a = 1.2 }\nduration = 1.3\n"};
}

Pair free_end() {
  return {"pendulum, free end", rod + "start = " + swing("-0.5", "duration = 2\n"),
          rod_by_angle + "start = { a = -0.5 }\nduration = 2\n"};
}

Pair periodic() {
  return {"pendulum, periodic",
          rod + orbit + "x = \"l*sin(1.2*cos(2*pi*t/T))\"\ny = \"-l*cos(1.2*cos(2*pi*t/T))\"\n",
          rod_by_angle + orbit + "a = \"1.2*cos(2*pi*t/T)\"\n"};
}

/// Places of the ends of rods of this length with these angles.
std::string places(const std::vector<double>& angles, double length) {
  std::vector<std::string> x, y;
  double right = 0, down = 0;
  for (const double a : angles) {
    x.push_back(fmt::format("{:.17g}", right += length * std::sin(a)));
    y.push_back(fmt::format("{:.17g}", down -= length * std::cos(a)));
  }
  return fmt::format("{{ x = [{}], y = [{}] }}\n", fmt::join(x, ", "), fmt::join(y, ", "));
}

/// n rods, each with a mass 1 at its end.
Pair chain(const std::string& name, int n, double length, const std::vector<double>& from,
           const std::vector<double>& to, double duration) {
  std::string constraints = fmt::format("\"x[1]^2 + y[1]^2 = {}\"", length * length);
  for (int i = 1; i < n; ++i)
    constraints +=
        fmt::format(", \"(x[{0}] - x[{1}])^2 + (y[{0}] - y[{1}])^2 = {2}\"", i + 1, i, length * length);
  return {name,
          fmt::format("[system]\ncoordinates = [\"x[{0}]\", \"y[{0}]\"]\n"
                      "lagrangian = \"sum(i, 1, {0}, (x[i]'^2 + y[i]'^2)/2 - 9.81*y[i])\"\n"
                      "constraints = [{1}]\n[boundary]\nstart = {2}end = {3}duration = {4}\n",
                      n, constraints, places(from, length), places(to, length), duration),
          fmt::format("[system]\ncoordinates = [\"a[{0}]\"]\n"
                      "lagrangian = \"sum(i, 1, {0}, sum(j, 1, {0}, {2}*({1} - max(i, j))*a[i]'*a[j]'*"
                      "cos(a[i] - a[j])/2)) + sum(i, 1, {0}, {3}*({1} - i)*cos(a[i]))\"\n[boundary]\n"
                      "start = {{ a = [{4}] }}\nend = {{ a = [{5}] }}\nduration = {6}\n",
                      n, n + 1, length * length, 9.81 * length, fmt::join(from, ", "), fmt::join(to, ", "),
                      duration)};
}

Pair ten_rods() {
  std::vector<double> from, to;
  for (int i = 0; i < 10; ++i) {
    from.push_back(0.3 - 0.03 * i);
    to.push_back(0.1 + 0.02 * i);
  }
  return chain("chain of 10 rods", 10, 0.1, from, to, 0.1);
}

Pair spherical() {
  return {"spherical pendulum",
          "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\n"
          "lagrangian = \"(x'^2 + y'^2 + z'^2)/2 - 9.81*z\"\nconstraints = [\"x^2 + y^2 + z^2 = 1\"]\n"
          "[boundary]\nstart = { x = \"sin(1)\", y = 0, z = \"-cos(1)\" }\n"
          "end = { x = \"sin(0.7)*cos(1.5)\", y = \"sin(0.7)*sin(1.5)\", z = \"-cos(0.7)\" }\n"
          "duration = 0.6\n",
          "[system]\ncoordinates = [\"a\", \"b\"]\n"
          "lagrangian = \"(a'^2 + sin(a)^2*b'^2)/2 + 9.81*cos(a)\"\n[boundary]\n"
          "start = { a = 1, b = 0 }\nend = { a = 0.7, b = 1.5 }\nduration = 0.6\n"};
}

Pair geodesic() {
  return {"geodesic on an ellipsoid",
          "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
          "constraints = [\"x^2/9 + y^2/4 + z^2 = 1\"]\n[boundary]\n"
          "start = { x = \"3*sin(1.2)\", y = 0, z = \"cos(1.2)\" }\n"
          "end = { x = \"3*sin(0.8)*cos(1.3)\", y = \"2*sin(0.8)*sin(1.3)\", z = \"cos(0.8)\" }\n"
          "duration = 1\n",
          "[system]\ncoordinates = [\"a\", \"b\"]\n"
          "lagrangian = \"((3*(cos(a)*cos(b)*a' - sin(a)*sin(b)*b'))^2 + (2*(cos(a)*sin(b)*a' + "
          "sin(a)*cos(b)*b'))^2 + (sin(a)*a')^2)/2\"\n[boundary]\nstart = { a = 1.2, b = 0 }\n"
          "end = { a = 0.8, b = 1.3 }\nduration = 1\n"};
}

/// Motions that turn farther than a chart of Cartesian coordinates holds.
Pair far_swing() {
  const std::string ends = "start = " + swing("-2.0", "end = ") + swing("2.2", "duration = 1.5\n");
  return {"pendulum, through 240 degrees",
          rod + ends + "[guess]\nx = \"l*sin(-2 + 4.2*t/T)\"\ny = \"-l*cos(-2 + 4.2*t/T)\"\n",
          rod_by_angle + "start = { a = -2.0 }\nend = { a = 2.2 }\nduration = 1.5\n"};
}

Pair rotation() {
  const std::string closed = "periodic = true\nduration = \"free\"\nenergy = 60\n";
  const std::string guess = "[guess]\nduration = 1.8\n";
  return {"pendulum, rotating", rod + closed + guess + "x = \"l*sin(2*pi*t/T)\"\ny = \"-l*cos(2*pi*t/T)\"\n",
          rod_by_angle + closed + "map = { a = \"a + 2*pi\" }\n" + guess + "a = \"2*pi*t/T\"\n"};
}

/// A crank of length 1/2 that turns, a rod of length 1.3 and a slider.
Pair slider_crank() {
  const std::string end = fmt::format("{{ x = \"cos(0.3)/2\", y = \"sin(0.3)/2\", s = {:.17g} }}\n",
                                      std::cos(0.3) / 2 + std::sqrt(1.69 - std::pow(std::sin(0.3) / 2, 2)));
  const std::string crank = "(0.3 + 2*pi*t/T)";
  return {"slider crank, whole turn",
          "[system]\ncoordinates = [\"x\", \"y\", \"s\"]\n"
          "lagrangian = \"x'^2 + y'^2 + 0.7*s'^2/2 - 2*y - s^2\"\n"
          "constraints = [\"x^2 + y^2 = 0.25\", \"(s - x)^2 + y^2 = 1.69\"]\n[boundary]\nstart = " +
              end + "end = " + end + "duration = 1.5\n[guess]\nx = \"cos" + crank + "/2\"\ny = \"sin" +
              crank + "/2\"\ns = \"cos" + crank + "/2 + 1.25\"\n",
          "[system]\ncoordinates = [\"a\"]\n"
          "lagrangian = \"a'^2/4 + 0.7*(a'*(-sin(a)/2 - sin(a)*cos(a)/4/sqrt(1.69 - sin(a)^2/4)))^2/2 - "
          "sin(a) - (cos(a)/2 + sqrt(1.69 - sin(a)^2/4))^2\"\n[boundary]\nstart = { a = 0.3 }\n"
          "end = { a = \"0.3 + 2*pi\" }\nduration = 1.5\n"};
}

/// A great circle, inclined by 0.5, over this angle.
Pair far_geodesic() {
  const double slope = 0.5, from = 0.2, to = from + 200 * std::acos(-1) / 180;
  const auto place = [&](double angle) {
    return fmt::format("{{ x = {:.17g}, y = {:.17g}, z = {:.17g} }}\n", std::cos(angle),
                       std::sin(angle) * std::cos(slope), std::sin(angle) * std::sin(slope));
  };
  const auto angles = [&](double angle) {
    double turned = std::atan2(std::sin(angle) * std::cos(slope), std::cos(angle));
    if (turned < 0) turned += 2 * std::acos(-1);
    return fmt::format("{{ a = {:.17g}, b = {:.17g} }}\n", std::acos(std::sin(angle) * std::sin(slope)),
                       turned);
  };
  return {"great circle, 200 degrees",
          "[system]\ncoordinates = [\"x\", \"y\", \"z\"]\nlagrangian = \"(x'^2 + y'^2 + z'^2)/2\"\n"
          "constraints = [\"x^2 + y^2 + z^2 = 1\"]\n[boundary]\nstart = " +
              place(from) + "end = " + place(to) +
              "duration = 1\n[guess]\nx = \"cos(0.2 + 3.49*t/T)\"\ny = \"sin(0.2 + 3.49*t/T)\"\nz = 0.1\n",
          "[system]\ncoordinates = [\"a\", \"b\"]\nlagrangian = \"(a'^2 + sin(a)^2*b'^2)/2\"\n[boundary]\n"
          "start = " +
              angles(from) + "end = " + angles(to) + "duration = 1\n"};
}

struct Times {
  double action = 0, solve = 0, whole = 0;  ///< microseconds; whole: with the analysis
};

Times measure(const std::string& text) {
  const extremal::Solution solution = repeated_solve(text);
  return {solution.action, 1e6 * solution.seconds_solve,
          1e6 * (solution.seconds_solve + solution.seconds_analyse)};
}

void compare(const Pair& pair) {
  const Times constrained = measure(pair.constrained), minimal = measure(pair.minimal);
  fmt::print("{:30} {:9.1f} {:9.1f} {:9.1f} {:9.1f} {:7.2f} {:7.2f} {:9.1e}\n", pair.name, constrained.solve,
             constrained.whole, minimal.solve, minimal.whole, constrained.solve / minimal.solve,
             constrained.whole / minimal.whole, std::abs(constrained.action - minimal.action));
}

}  // namespace
}  // namespace bench

int main() {
  using namespace bench;
  try {
    fmt::print(
        "microseconds, medians: constraints, then angles; solve, then with the analysis; ratios; "
        "difference of the actions\n");
    const Pair pairs[] = {pendulum(),    free_end(),
                          periodic(),    chain("double pendulum", 2, 1, {0.3, -0.4}, {0.5, 0.9}, 0.5),
                          spherical(),   geodesic(),
                          ten_rods(),    far_swing(),
                          rotation(),    slider_crank(),
                          far_geodesic()};
    for (const Pair& pair : pairs) compare(pair);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
