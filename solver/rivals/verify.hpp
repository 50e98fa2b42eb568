#pragma once

#include <optional>
#include <string>
#include <vector>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Whether a trajectory solves a problem, by means that share nothing with the discrete action.

namespace extremal {

struct VerifyOptions {
  double tolerance = 1e-9;  ///< that the trajectory was solved to
  double margin = 10;       ///< how often what the tolerance allows may be found
  double growth = 5;  ///< a piece ends before the errors allowed at its start could grow more, seen in q
  std::vector<double> ends = {};  ///< pieces end at these times in (0, T], ascending, instead
  int max_steps = 100000;         ///< of the integrator, in all
  Deadline deadline = {};
};

/// Each number in units of what the tolerance allows: for q, tolerance × the largest range of a coordinate;
/// for q' and p ten times the tolerance × their largest range. Pessimistic until proved otherwise.
struct Verification {
  bool verified = false;
  std::string message = "nothing has been verified";
  double defect = 0;           ///< largest |q − motion|, the motion from the trajectory's own state
  double velocity_defect = 0;  ///< largest |q' − motion|
  double worst_time = 0;       ///< where the larger of the two was found
  double conditions = 0;  ///< natural conditions and what closes the duration, in such errors of the ends
  std::optional<double> distance;  ///< of q from the extremal, to first order: one step of multiple shooting
  double orientation = 0;  ///< where L_vv > 0, positive (negative) if conjugate times are even (odd) in
                           ///< number, the surer the farther from zero; 0 if not known
  double growth = 0;       ///< largest of an error within a piece
  int pieces = 0, steps = 0;
};

/// Integrates from piece to piece, each from the trajectory's own (q, q') at its start, and compares
/// throughout. Conditions on the ends must hold to roundoff, natural ones, energy or `where` to what the
/// tolerance allows. Defects of pieces much shorter than the whole hide errors that vary slowly: with up to
/// 40 coordinates they are put together, with the ends, into the distance from the extremal. Throws
/// std::invalid_argument for a trajectory or options that are malformed.
Verification verify(const Problem& problem, const Trajectory& trajectory, const VerifyOptions& options = {});

}  // namespace extremal
