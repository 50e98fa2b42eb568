#include "catalogue.hpp"

namespace bench {
namespace {

/// Drives that repeat, and one that does not.
std::vector<Recipe> driven() {
  return {
      {.system = "driven-pendulum",
       .parameters = {{"g", 0.5, 3}, {"f", -1, 1}, {"w", 0.4, 4}},
       .positions = {{"x", -2.5, 2.5}},
       .velocities = {{"x", -2, 2}},
       .time = 6,
       .maps = {R"({ x = "-x" })", R"({ x = "x + 2*pi" })"},
       .autonomous = false,
       .lagrangian = "x'^2/2 + g*cos(x) + f*x*cos(w*t)",
       .period = "2*pi/w"},
      {.system = "swing",
       .parameters = {{"a", 0.02, 0.6}, {"w", 0.5, 4}},
       .positions = {{"x", -2.5, 2.5}},
       .velocities = {{"x", -2, 2}},
       .time = 6,
       .maps = {R"({ x = "-x" })"},
       .autonomous = false,
       .lagrangian = "x'^2/2 + (1 + a*cos(w*t))*cos(x)",
       .period = "2*pi/w"},
      {.system = "driven-well",
       .parameters = {{"b", 0.3, 2}, {"f", -0.5, 0.5}, {"w", 0.4, 3}},
       .positions = {{"x", -1.6, 1.6}},
       .velocities = {{"x", -1, 1}},
       .time = 6,
       .maps = {R"({ x = "-x" })"},
       .autonomous = false,
       .lagrangian = "x'^2/2 + x^2/2 - b*x^4/4 + f*x*cos(w*t)",
       .period = "2*pi/w"},
      {.system = "elliptic-restricted",
       .parameters = {{"mu", 0.001, 0.5}, {"e", 0.01, 0.5}},
       .positions = {{"x", -1.3, 1.3}, {"y", -0.8, 0.8}},
       .velocities = {{"x", -0.6, 0.6}, {"y", -0.6, 0.6}},
       .time = 3,
       .autonomous = false,
       .lagrangian = "(x'^2 + y'^2)/2 + x*y' - y*x' + ((x^2 + y^2)/2 + (1 - mu)/sqrt((x + mu)^2 + y^2) + "
                     "mu/sqrt((x - 1 + mu)^2 + y^2))/(1 + e*cos(t))",
       .period = "2*pi"},
      {.system = "wave",
       .parameters = {{"f", -0.6, 0.6}, {"w", 0.4, 3}},
       .positions = {{"x", -1, 1}, {"y", -1, 1}},
       .velocities = {{"x", -1, 1}, {"y", -1, 1}},
       .time = 6,
       .autonomous = false,
       .lagrangian = "(x'^2 + y'^2)/2 - (x^2 + 2*y^2 + x^4)/2 + f*y*cos(x - w*t)",
       .period = "2*pi/w"},
      {.system = "fading",
       .parameters = {{"f", -1, 1}, {"c", 0.05, 1}},
       .positions = {{"x", -1, 1}},
       .velocities = {{"x", -1, 1}},
       .time = 6,
       .autonomous = false,
       .lagrangian = "x'^2/2 - x^2/2 - x^4/8 + f*x*exp(-c*t)"},
  };
}

/// Forces that jump, and their slopes.
std::vector<Recipe> kinked() {
  return {
      {.system = "wedge",
       .parameters = {{"k", 0.3, 3}},
       .positions = {{"x", -1, 1}},
       .velocities = {{"x", -1, 1}},
       .time = 5,
       .maps = {R"({ x = "-x" })"},
       .lagrangian = "x'^2/2 - k*abs(x)"},
      {.system = "wall",
       .parameters = {{"k", 1, 100}},
       .positions = {{"x", -0.3, 1}},
       .velocities = {{"x", -1, 1}},
       .time = 5,
       .lagrangian = "x'^2/2 - x^2/2 - k*max(0, -x)^2/2"},
      {.system = "roof",
       .parameters = {{"k", 0.3, 2}},
       .positions = {{"x", -1, 1}, {"y", -1, 1}},
       .velocities = {{"x", -1, 1}, {"y", -1, 1}},
       .time = 5,
       .lagrangian = "(x'^2 + y'^2)/2 - (x^2 + y^2)/2 + k*min(x, y)"},
  };
}

/// Many extremals between any two ends.
std::vector<Recipe> confined() {
  return {
      {.system = "toda-ring",
       .parameters = {{"k", 0.5, 2}},
       .positions = {{"x", -0.8, 0.8}},
       .velocities = {{"x", -1, 1}},
       .time = 3.6,
       .least = 2,
       .most = 4,
       .lagrangian =
           "sum(i, 1, n, x[i]'^2/2) - sum(i, 1, n - 1, exp(k*(x[i] - x[i+1]))) - exp(k*(x[n] - x[1]))"},
      {.system = "double-well",
       .parameters = {{"h", 0.5, 4}},
       .positions = {{"x", -1.5, 1.5}},
       .velocities = {{"x", -1, 1}},
       .time = 6,
       .maps = {R"({ x = "-x" })"},
       .lagrangian = "x'^2/2 - h*(x^2 - 1)^2/4"},
  };
}

}  // namespace

std::vector<Recipe> written_recipes() {
  std::vector<Recipe> recipes;
  for (const auto& some : {driven(), kinked(), confined()})
    recipes.insert(recipes.end(), some.begin(), some.end());
  return recipes;
}

}  // namespace bench
