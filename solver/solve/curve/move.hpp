#pragma once

#include <vector>

#include "solve/newton/model.hpp"

/// \file Changes of a path along a curve of extremals.

namespace extremal {

/// A change of a path and of the parameter of a curve.
struct Move {
  Step step;
  double parameter = 0;
  std::vector<double> times = {};  ///< by which the mesh nodes move, in τ; empty: they stay
  void add(const Move& other, double factor);
  void scale(double factor);
};
inline void add(Move& to, const Move& move, double factor) { to.add(move, factor); }
inline void scale(Move& move, double factor) { move.scale(factor); }

/// Where the duration T is the number that varies: with H and t the second derivatives of S_h in x and in x
/// and T, H δx + t δT = −g leaves one direction free. Solutions with two right-hand sides of the equation
/// that closes it differ by this direction, even where H is singular. Sets a move to one solution; its
/// parameter is δT.
void solve_with_duration(QuadraticModel& model, const DiscreteAction& action, const ClosingEquation& closing,
                         Move& move);

}  // namespace extremal
