#pragma once

#include <vector>

#include "problem/problem.hpp"

namespace bench {

/// Two points in the plane of a centre of strength 1, one at distance 1, the other at 0.5 to 2 and 17 to 343
/// degrees further, a duration of 3 to 25; and the energies of all ellipses between them with up to two
/// revolutions, both ways round.
struct LambertProblem {
  extremal::Problem problem;
  std::vector<double> energies;
};

std::vector<LambertProblem> lambert_problems(int count);

/// How many of the energies are among those found.
int arcs_found(const std::vector<double>& wanted, std::vector<double> found);

}  // namespace bench
