#pragma once

#include <vector>

#include "shooting/shooting.hpp"
#include "study/study.hpp"

/// \file The problem of a scene in the form that shooting by hand takes.

namespace bench {

struct HandProblem {
  shooting::SystemChoice system;
  shooting::BoundaryProblem boundary;
  std::vector<double> start;  ///< the first state; its unknown components are those of the guess
};

/// The system is the one whose accelerations are those of the scene's Lagrangian along the guess. Throws
/// std::invalid_argument where no equations are written for the system or its ends.
HandProblem hand_problem(const extremal::Study& study);

/// States (q, q') of the guess at the beginning of each segment, row by row.
std::vector<double> hand_guess(const HandProblem& hand, const extremal::Problem& problem, int segments);

}  // namespace bench
