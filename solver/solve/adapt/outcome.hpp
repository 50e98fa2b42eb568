#pragma once

#include <string>

#include "problem/reduction.hpp"
#include "solve/adapt/options.hpp"
#include "solve/newton/iteration.hpp"

/// \file The result of a stage: a path with its error and its status.

namespace extremal {

struct Outcome {
  Path path;                              ///< where it has got to
  const ElementTables* tables = nullptr;  ///< of its elements
  Status status = Status::not_converged;
  std::string message;
  const char* strategy = "newton from the guess";
  /// Reached in another way than by Newton's method from the guess, or far from it.
  bool elsewhere = false;
  /// Only polynomials of higher degree (recovery.hpp) have velocities within the tolerance.
  bool recovered = false;
  /// Its parts between times of rest are held in time: roundoff hides what would hold them.
  bool shifts_held = false;
  double shift_error = 0;  ///< of q, absolute: what is not known of the shifts that are held
  double error = 0;        ///< of q, absolute
  double tolerance = 0;    ///< absolute
  int iterations = 0;      ///< steps that were taken
  int attempts = 0;        ///< these, and paths from which there was no step
  double first_range = 0;  ///< of the path that a closed orbit was started from; 0 for other paths
  /// Null directions of a path that is one of a family between conjugate fixed ends, and the index across it.
  int family = 0, index_across = 0;
  bool hidden = false;  ///< an extremal is near, but roundoff is more than the tolerance
  bool astray = false;  ///< of a scheme: Newton's method failed from the guess, or found no extremal
  /// Where symmetries left a part of an orbit to be found: the part, of which `path` is the whole.
  Path part;
  const Reduction* reduction = nullptr;

  /// Counts a step of an iteration along the path and reports it to options.progress.
  void record(const NewtonIteration& newton, const SolveOptions& options);
};

}  // namespace extremal
