#pragma once

#include <set>
#include <string>
#include <utility>

#include "solve/search/from_flow.hpp"
#include "solve/search/guess_mesh.hpp"
#include "solve/search/pursuit.hpp"

/// \file Where Newton's method starts from: the guess, and other paths where the guess fails.

namespace extremal {

/// Starting paths in turn, cheapest first, each pursued to the tolerance, within a bounded number of steps.
class Search {
 public:
  Search(const Problem& problem, const SolveOptions& options, Workspace& workspace);

  /// To a path that meets the tolerance and that `acceptance`, if given, accepts. The outcome stays the
  /// search's own until it is taken.
  const Outcome& run(Acceptance* acceptance = nullptr);
  /// The same from the guess only and without acceptance; a path far from the guess is a failure.
  const Outcome& run_near_guess();
  Outcome take() { return std::move(pursuit_.outcome); }
  const Path& path() const { return pursuit_.path; }

  /// For other paths after those of a run.
  Pursuit& pursuit() { return pursuit_; }
  GuessMesh& guess() { return guess_; }
  FlowSearch& flow() { return flow_; }

 private:
  /// Ways that were tried, in the order of the message.
  enum class Route { other_durations, other_ends, noise, motions, weaker_forces };
  struct End {
    Refinement::Result result;
    bool doubtful;   ///< the equations were nearly singular
    bool no_family;  ///< the ends are conjugate near the guess, without a family
    bool converged() const { return result == Refinement::Result::converged; }
  };
  End from_guess();
  bool from_hidden();
  bool from_others(GuessMesh::Kind kind);
  bool by_other_starts(GuessMesh::Kind kind, std::set<Route>& tried);
  void report_failure(const std::string& failure, const std::set<Route>& tried);
  void report_singular(const End& end);

  const Problem& problem_;
  Pursuit pursuit_;
  GuessMesh guess_;
  FlowSearch flow_;
};

}  // namespace extremal
