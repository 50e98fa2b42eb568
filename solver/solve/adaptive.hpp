#pragma once

#include "solve/converge.hpp"
#include "solve/frequency.hpp"
#include "solve/levels.hpp"
#include "solve/resolution.hpp"
#include "solve/solve.hpp"
#include "solve/start.hpp"

/// \file Mesh and degree chosen for a tolerance, while Newton converges.

namespace extremal {

/// Memory that solves share.
struct Workspace {
  Levels levels;
  NewtonIteration iteration;
  Path path, other;
  Resolution resolution;
  Frequency frequency;
  std::vector<double> before;  ///< mesh nodes before the degree rose
  std::unique_ptr<SchemeTables> pinned_scheme;
  ElementTables pinned;
  const ElementTables* final_tables = nullptr;
};

/// Where a solve has got to: the path and tables in the workspace, and what is known of its error.
struct Outcome {
  Status status = Status::not_converged;
  std::string message;
  const char* strategy = "newton from the guess";
  double error = 0;      ///< of q, absolute
  double tolerance = 0;  ///< absolute
  int iterations = 0;
  const ElementTables* tables = nullptr;
};

/// Coarse elements first: Newton on them until the path is known to a few digits, which tells the degree
/// that the tolerance needs; then elements of that degree, started a few digits off. Where no degree
/// suffices, or Newton fails, elements are halved; where that does not help, Newton starts from other
/// guesses.
class AdaptiveSolve {
 public:
  AdaptiveSolve(const Problem& problem, const SolveOptions& options, Workspace& workspace);
  Outcome run();

 private:
  enum class Attempt { converged, refine, failed, unreachable };
  void start(const std::vector<double>& mesh, const Bend& bend);
  bool begin(std::vector<double>& mesh, Bend& bend);
  Attempt pursue();
  int steps_left(int wanted) const;
  Attempt attempt();
  /// Before the degree rose: expected truncation; how far the mesh nodes moved since; whether Newton's
  /// method had gone to the end before.
  struct NodeError {
    double truncation = 0, moved = 0;
    bool from_converged = false;
  };
  Attempt judge(const NewtonReport& newton, const NodeError& nodes);
  int needed_degree() const;
  double excess(const Resolution::Error& error) const;
  void raise(int degree);
  void halve();
  bool confirmed();
  void report_step();

  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  Outcome outcome_;
  std::vector<double> ends_;
  Scales scales_;
  int most_steps_ = 0;
  double longest_ = 0;  ///< undamped step so far, relative
  double worst_ = 0;    ///< error in units of the tolerance, when elements were last judged
  const ElementTables* tables_ = nullptr;
};

}  // namespace extremal
