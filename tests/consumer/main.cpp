#include <cstdio>

#include "solve/solve.hpp"
#include "system/tape.hpp"

int main() {
  extremal::Problem problem;
  problem.names = {"x", "y"};
  problem.lagrangian = extremal::trace(2, [](auto q, auto v, auto) {
    return (v[0] * v[0] + v[1] * v[1]) / 2 + 1 / sqrt(q[0] * q[0] + q[1] * q[1]);
  });
  problem.boundary.coordinates = 2;
  problem.boundary.fix(0, false, 1.0);
  problem.boundary.fix(1, false, 0.0);
  problem.boundary.fix(0, true, -0.6);
  problem.boundary.fix(1, true, 0.9);
  problem.duration.value = 2.5;

  extremal::Solver solver;
  const extremal::Solution arc = solver.solve(make_problem(problem), {.tolerance = 1e-12});
  if (!arc.converged()) {
    std::fprintf(stderr, "%s\n", arc.message.c_str());
    return 1;
  }
  std::printf("velocity %.9f %.9f\n", arc.momentum_start[0], arc.momentum_start[1]);
}
