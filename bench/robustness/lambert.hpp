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

/// Energies of all ellipses between points at distances 1 and r from a centre of strength 1, `angle` apart,
/// that take `duration` with up to so many revolutions, both ways round.
std::vector<double> lambert_energies(double r, double angle, double duration, int revolutions);

std::vector<LambertProblem> lambert_problems(int count);

/// How many of the energies are among those found.
int arcs_found(const std::vector<double>& wanted, std::vector<double> found);

}  // namespace bench
