#include "catalogue.hpp"

namespace bench {
namespace {

std::vector<Recipe> one_coordinate() {
  return {
      {.system = "oscillator",
       .parameters = {{"m", 0.2, 5}, {"omega", 0.3, 3}},
       .positions = {{"x", -1, 1}},
       .velocities = {{"x", -1, 1}},
       .time = 6.3,
       .maps = {R"({ x = "-x" })"}},
      {.system = "driven-oscillator",
       .parameters = {{"omega", 0.3, 3}, {"f", -2, 2}, {"drive", 0.3, 4}},
       .positions = {{"x", -1, 1}},
       .velocities = {{"x", -1, 1}},
       .time = 6.3,
       .autonomous = false,
       .period = "2*pi/drive"},
      {.system = "anharmonic-oscillator",
       .parameters = {{"m", 0.2, 5}, {"alpha", -1.5, 1.5}, {"beta", 0.1, 3}},
       .positions = {{"x", -2, 2}},
       .velocities = {{"x", -1.5, 1.5}},
       .time = 5,
       .maps = {R"({ x = "-x" })"}},
      {.system = "morse",
       .parameters = {{"m", 0.3, 3}, {"depth", 0.2, 2}, {"a", 0.5, 2}},
       .positions = {{"x", -0.6, 3}},
       .velocities = {{"x", -0.5, 0.5}},
       .time = 7},
      {.system = "pendulum",
       .parameters = {{"l", 0.2, 3}, {"g", 1, 20}},
       .positions = {{"theta", -3.1, 3.1}},
       .velocities = {{"theta", -7, 7}},
       .time = 2.5,
       .maps = {R"({ theta = "-theta" })", R"({ theta = "theta + 2*pi" })"}},
  };
}

std::vector<Recipe> two_coordinates() {
  return {
      {.system = "henon-heiles",
       .parameters = {{"coupling", 0.1, 1.2}},
       .positions = {{"x", -0.4, 0.4}, {"y", -0.4, 0.6}},
       .velocities = {{"x", -0.4, 0.4}, {"y", -0.4, 0.4}},
       .time = 6.3,
       .maps = {R"({ x = "-x" })", R"({ x = "-x/2 - sqrt(3)/2*y", y = "sqrt(3)/2*x - y/2" })"}},
      {.system = "kepler",
       .parameters = {{"mu", 0.3, 3}},
       .positions = {{"x", -1.5, 1.5}, {"y", -1.5, 1.5}},
       .velocities = {{"x", -1, 1}, {"y", -1, 1}},
       .time = 6.3,
       .maps = {R"({ x = "-x", y = "-y" })", R"({ x = "0.6*x - 0.8*y", y = "0.8*x + 0.6*y" })"}},
      {.system = "double-pendulum",
       .parameters = {{"m1", 0.3, 3}, {"m2", 0.3, 3}, {"l1", 0.5, 2}, {"l2", 0.5, 2}},
       .positions = {{"a", -2.5, 2.5}, {"b", -2.5, 2.5}},
       .velocities = {{"a", -4, 4}, {"b", -4, 4}},
       .time = 2.5,
       .maps = {R"({ a = "-a", b = "-b" })", R"({ b = "b + 2*pi" })"}},
      {.system = "spring-pendulum",
       .parameters = {{"k", 1, 20}, {"l", 0.3, 1.5}},
       .positions = {{"x", -1, 1}, {"y", -1.5, 0.5}},
       .velocities = {{"x", -1, 1}, {"y", -1, 1}},
       .time = 5,
       .maps = {R"({ x = "-x" })"}},
      {.system = "swinging-atwood",
       .parameters = {{"ratio", 1.1, 5}},
       .positions = {{"r", 0.5, 2}, {"theta", -1.5, 1.5}},
       .velocities = {{"r", -0.5, 0.5}, {"theta", -1.5, 1.5}},
       .time = 5,
       .maps = {R"({ theta = "-theta" })"}},
      {.system = "mueller-brown",
       .parameters = {{"m", 0.5, 2}},
       .positions = {{"x", -1.2, 1}, {"y", -0.2, 1.7}},
       .velocities = {{"x", -8, 8}, {"y", -8, 8}},
       .time = 0.4},
      {.system = "ellipsoid-geodesic",
       .parameters = {{"a", 1, 3}, {"b", 1, 3}, {"c", 1, 3}},
       .positions = {{"u", -1.3, 1.3}, {"v", -3, 3}},
       .velocities = {{"u", -1, 1}, {"v", -1, 1}},
       .time = 3,
       .maps = {R"({ v = "v + 2*pi" })"}},
      {.system = "torus-geodesic",
       .parameters = {{"ring", 1.5, 4}, {"tube", 0.4, 1.2}},
       .positions = {{"u", -3, 3}, {"v", -3, 3}},
       .velocities = {{"u", -1, 1}, {"v", -1, 1}},
       .time = 4,
       .maps = {R"({ v = "v + 2*pi" })", R"({ u = "u + 2*pi", v = "v + 2*pi" })"}},
  };
}

std::vector<Recipe> three_coordinates() {
  return {
      {.system = "cr3bp",
       .parameters = {{"mu", 0.001, 0.5}},
       .positions = {{"x", -1.3, 1.3}, {"y", -0.8, 0.8}, {"z", -0.3, 0.3}},
       .velocities = {{"x", -0.6, 0.6}, {"y", -0.6, 0.6}, {"z", -0.3, 0.3}},
       .time = 3,
       .maps = {R"({ z = "-z" })"}},
      {.system = "hill",
       .parameters = {},
       .positions = {{"x", -1.5, 1.5}, {"y", -1.5, 1.5}, {"z", -0.5, 0.5}},
       .velocities = {{"x", -1, 1}, {"y", -1, 1}, {"z", -0.5, 0.5}},
       .time = 2,
       .maps = {R"({ z = "-z" })", R"({ x = "-x", y = "-y" })"}},
      {.system = "j2-orbit",
       .parameters = {{"j2", 1e-5, 0.01}},
       .positions = {{"x", -16000, 16000}, {"y", -16000, 16000}, {"z", -8000, 8000}},
       .velocities = {{"x", -5, 5}, {"y", -5, 5}, {"z", -3, 3}},
       .time = 10000,
       .maps = {R"({ z = "-z" })", R"({ x = "-x", y = "-y" })"}},
      {.system = "kepler-space",
       .parameters = {{"mu", 1e5, 1e6}},
       .positions = {{"x", -16000, 16000}, {"y", -16000, 16000}, {"z", -8000, 8000}},
       .velocities = {{"x", -5, 5}, {"y", -5, 5}, {"z", -3, 3}},
       .time = 10000,
       .maps = {R"({ z = "-z" })"}},
      {.system = "magnetic-dipole",
       .parameters = {{"alpha", 0.3, 3}},
       .positions = {{"x", -1.5, 1.5}, {"y", -1.5, 1.5}, {"z", -0.5, 0.5}},
       .velocities = {{"x", -0.5, 0.5}, {"y", -0.5, 0.5}, {"z", -0.3, 0.3}},
       .time = 5,
       .maps = {R"({ x = "-x", y = "-y" })"}},
      {.system = "magnetic-field",
       .parameters = {{"m", 0.3, 3}, {"charge", -2, 2}, {"bx", -1, 1}, {"by", -1, 1}, {"bz", 0.3, 2}},
       .positions = {{"x", -1, 1}, {"y", -1, 1}, {"z", -1, 1}},
       .velocities = {{"x", -1, 1}, {"y", -1, 1}, {"z", -1, 1}},
       .time = 6.3},
  };
}

std::vector<Recipe> many_coordinates() {
  return {
      {.system = "triple-pendulum",
       .parameters = {{"m", 0.3, 3, true}, {"l", 0.5, 2, true}, {"g", 1, 20}},
       .positions = {{"theta", -1.5, 1.5}},
       .velocities = {{"theta", -2, 2}},
       .time = 2.5,
       .least = 1,
       .most = 4},
      {.system = "nbody",
       .parameters = {{"g", 0.3, 3}, {"m", 0.2, 3, true}},
       .positions = {{"x", -1.5, 1.5}, {"y", -1.5, 1.5}},
       .velocities = {{"x", -0.8, 0.8}, {"y", -0.8, 0.8}},
       .time = 5,
       .least = 2,
       .most = 4},
      {.system = "nbody-space",
       .parameters = {{"g", 0.3, 3}, {"m", 0.2, 3, true}},
       .positions = {{"x", -1.5, 1.5}, {"y", -1.5, 1.5}, {"z", -1, 1}},
       .velocities = {{"x", -0.8, 0.8}, {"y", -0.8, 0.8}, {"z", -0.5, 0.5}},
       .time = 5,
       .least = 2,
       .most = 4},
      {.system = "lennard-jones",
       .parameters = {{"epsilon", 0.5, 2}, {"sigma", 0.7, 1.2}, {"m", 0.5, 2}},
       .positions = {{"x", -1.5, 1.5}, {"y", -1.5, 1.5}, {"z", -1.5, 1.5}},
       .velocities = {{"x", -0.6, 0.6}, {"y", -0.6, 0.6}, {"z", -0.6, 0.6}},
       .time = 1.5,
       .least = 2,
       .most = 5},
      {.system = "fpu-chain",
       .parameters = {{"alpha", -0.5, 0.5}, {"beta", 0.1, 3}},
       .positions = {{"q", -0.7, 0.7}},
       .velocities = {{"q", -0.5, 0.5}},
       .time = 5,
       .least = 2,
       .most = 24},
      {.system = "phi4-lattice",
       .parameters = {{"h", 0.3, 1}, {"lambda", 0.3, 3}},
       .positions = {{"u", -1.3, 1.3}},
       .velocities = {{"u", -0.5, 0.5}},
       .time = 4,
       .least = 2,
       .most = 24},
  };
}

}  // namespace

const std::vector<Recipe>& catalogue() {
  static const std::vector<Recipe> all = [] {
    std::vector<Recipe> recipes;
    for (const auto& some :
         {one_coordinate(), two_coordinates(), three_coordinates(), many_coordinates(), written_recipes()})
      recipes.insert(recipes.end(), some.begin(), some.end());
    return recipes;
  }();
  return all;
}

}  // namespace bench
