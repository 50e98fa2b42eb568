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
  bool starts_without_momentum = false;
};

/// From `start` over `duration`, or less where the integrator does not come so far.
Motion follow(const extremal::Lagrangian& lagrangian, const State& start, double duration);

/// The motion as a guess; not given where it cannot be followed.
extremal::Guess motion_guess(const extremal::Lagrangian& lagrangian, const State& start, double duration);

}  // namespace bench
