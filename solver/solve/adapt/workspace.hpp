#pragma once

#include <memory>
#include <string>
#include <vector>

#include "action/recovery.hpp"
#include "problem/reduction.hpp"
#include "solve/adapt/options.hpp"
#include "solve/mesh/frequency.hpp"
#include "solve/mesh/levels.hpp"
#include "solve/mesh/plan.hpp"
#include "solve/newton/iteration.hpp"

/// \file What the stages of a solve hand to each other.

namespace extremal {

/// Memory that solves share.
struct Workspace {
  Levels levels;
  NewtonIteration iteration;
  Path path, other, saved;
  Path whole;  ///< orbit of which the path is a part
  Recovery recovery;
  Path recovered;
  Resolution resolution;
  Planner planner;
  Frequency frequency;
  std::vector<double> before;  ///< mesh nodes when the present elements were opened
  std::unique_ptr<SchemeTables> pinned_scheme;
  ElementTables pinned;
  const ElementTables* final_tables = nullptr;
};

/// Makes `recovered` from the path, on whose elements its iteration is; false where it cannot be.
bool recover(const Problem& problem, Workspace& workspace);

/// Where a solve has got to: the path and tables in the workspace, and what is known of its error.
struct Outcome {
  Status status = Status::not_converged;
  std::string message;
  const char* strategy = "newton from the guess";
  /// Reached in another way than by Newton's method from the guess, or far from it.
  bool elsewhere = false;
  bool polished = false;  ///< to the last digit, after it converged
  /// Only polynomials of higher degree (recovery.hpp) have velocities within the tolerance.
  bool recovered = false;
  double error = 0;      ///< of q, absolute
  double tolerance = 0;  ///< absolute
  int iterations = 0;
  const ElementTables* tables = nullptr;
  /// The path in the workspace is its part, and the workspace has the whole.
  const Reduction* reduction = nullptr;
  bool hidden = false;  ///< an extremal is near, but roundoff is more than the tolerance

  /// Counts a step of the workspace's iteration and tells whoever listens.
  void record(const Workspace& workspace, const SolveOptions& options);
};

}  // namespace extremal
