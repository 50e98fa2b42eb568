#include <fmt/core.h>

#include <cmath>
#include <exception>
#include <string>

#include "../repeated_solve.hpp"

// Solves from a Hamiltonian and from its Lagrangian, in one run. The first have L on the expression graph;
// the momenta of the others are searched for at each point.

namespace bench {
namespace {

struct Pair {
  std::string name, coordinates, hamiltonian, lagrangian, boundary;
};

Pair pendulum() {
  return {"pendulum", "\"x\"", "p_x^2/2 - cos(x)", "x'^2/2 + cos(x)",
          "start = { x = 0 }\nend = { x = 1.5 }\nduration = 2\n"};
}

Pair kepler() {
  return {"Kepler", "\"x\", \"y\"", "(p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)",
          "(x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)",
          "start = { x = 1, y = 0 }\nend = { x = -0.6, y = 0.9 }\nduration = 2.5\n"};
}

/// x' = e^p − 1, so that L = (1 + x') (log(1 + x') − 1) − x²/2.
Pair one_momentum() {
  return {"one momentum", "\"x\"", "exp(p_x) - p_x + x^2/2", "(1 + x')*(log(1 + x') - 1) - x^2/2",
          "start = { x = 0.2 }\nend = { x = 0.6 }\nduration = 1.5\n"};
}

/// q' = 3 p √(1 + p²), so that p² = w with 2w = √(1 + 4|q'|²/9) − 1, and L = 3w √(1 + w) − (1 + w)^(3/2) −
/// q²/2.
Pair coupled(const std::string& name, const std::string& coordinates, const std::string& momenta,
             const std::string& velocities, const std::string& squares, const std::string& boundary) {
  const std::string w = "(sqrt(1 + 4*(" + velocities + ")/9) - 1)/2";
  return {name, coordinates, "(1 + " + momenta + ")^1.5 + (" + squares + ")/2",
          "3*" + w + "*sqrt(1 + " + w + ") - (1 + " + w + ")^1.5 - (" + squares + ")/2", boundary};
}

struct Solved {
  double action, microseconds;
};

Solved solve(const Pair& pair, bool hamiltonian) {
  const std::string text =
      "[system]\ncoordinates = [" + pair.coordinates + "]\n" +
      (hamiltonian ? "hamiltonian = \"" + pair.hamiltonian : "lagrangian = \"" + pair.lagrangian) +
      "\"\n[boundary]\n" + pair.boundary;
  const extremal::Solution solution = repeated_solve(text);
  return {solution.action, 1e6 * solution.seconds_solve};
}

}  // namespace
}  // namespace bench

int main() {
  using namespace bench;
  try {
    fmt::print(
        "microseconds of a solve, medians: Hamiltonian, Lagrangian; ratio; difference of the actions\n");
    const Pair pairs[] = {
        pendulum(), kepler(), one_momentum(),
        coupled("two coupled momenta", "\"x\", \"y\"", "p_x^2 + p_y^2", "x'^2 + y'^2", "x^2 + y^2",
                "start = { x = 0.2, y = 0.5 }\nend = { x = 0.7, y = 0.2 }\nduration = 1.2\n"),
        coupled(
            "three coupled momenta", "\"x\", \"y\", \"z\"", "p_x^2 + p_y^2 + p_z^2", "x'^2 + y'^2 + z'^2",
            "x^2 + y^2 + z^2",
            "start = { x = 0.2, y = 0.5, z = 0 }\nend = { x = 0.9, y = -0.3, z = 0.4 }\nduration = 1.2\n")};
    for (const Pair& pair : pairs) {
      const Solved h = solve(pair, true), l = solve(pair, false);
      fmt::print("{:22} {:9.1f} {:9.1f} {:7.2f} {:9.1e}\n", pair.name, h.microseconds, l.microseconds,
                 h.microseconds / l.microseconds, std::abs(h.action - l.action));
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
