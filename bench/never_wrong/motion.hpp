#pragma once

#include <vector>

#include "problem/problem.hpp"

/// \file A motion integrated from a random start, so that a scene has a solution.

namespace bench {

struct State {
  std::vector<double> q, v;  ///< n entries each
};

struct Motion {
  State start, end;
  double duration = 0;  ///< 0 where it could not be integrated at all
  double energy = 0;
  std::vector<double> momentum = {};  ///< at the start
  bool starts_without_momentum = false;
};

/// From `start` over `duration`, or less where the integrator does not come so far; with the forces of the
/// problem.
Motion follow(const extremal::Problem& problem, const State& start, double duration);

/// The motion as a guess; not given where it cannot be followed.
extremal::Guess motion_guess(const extremal::Problem& problem, const State& start, double duration);

}  // namespace bench
