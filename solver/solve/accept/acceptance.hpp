#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "solve/adapt/outcome.hpp"
#include "solve/adapt/workspace.hpp"

/// \file Whether a path is an extremal, and its properties.

namespace extremal {

/// The solution that a converged path is: momenta, index, energy, windows, multipliers; or one that has not
/// converged, with the reason why the path is refused. Its history and the time until the path was found are
/// the caller's. The path stays as it is; the workspace is memory.
Solution accept(const Problem& problem, const SolveOptions& options, const Outcome& found,
                Workspace& workspace);

/// Why a solve found nothing, judged by its last path.
Solution explain_failure(const Problem& problem, const SolveOptions& options, const Outcome& last,
                         Workspace& workspace);

/// The paths of one solve, judged as they are found. A path that is refused is not the end: others may
/// follow.
class Acceptance {
 public:
  Acceptance(const Problem& problem, const SolveOptions& options, Workspace& workspace);

  enum class Verdict {
    accepted,
    refused,
    coarse,    ///< refused, but elements that end at finer_at() as well may do
    hopeless,  ///< and other guesses do not help
  };
  Verdict judge(const Outcome& found);
  /// Times by the duration at which forces change fast within elements of the last path.
  const std::vector<double>& finer_at() const { return finer_at_; }

  /// The solution that was accepted; else the first that was refused; else why the last path failed.
  Solution result(const Outcome& last);
  /// That was accepted.
  const Solution& solution() const { return *solution_; }
  /// One that was accepted before.
  void put_back(Solution solution) { solution_ = std::move(solution); }
  /// Of the solution that was accepted; 0 if it has none.
  int nullity() const { return solution_ ? solution_->nullity.value_or(0) : 0; }
  /// Whether the last path is refused for the error that the tolerance leaves, see judge_isolation().
  bool too_loose() const { return too_loose_; }
  /// Tighter tolerances leave less than roundoff of the action.
  static constexpr double isolating_tolerance = 1e-9;
  double seconds() const { return seconds_; }  ///< spent so far

 private:
  const Problem& problem_;
  const SolveOptions& options_;
  Workspace& w_;
  std::optional<Solution> solution_;
  std::vector<double> finer_at_;
  bool too_loose_ = false;
  double seconds_ = 0;
};

}  // namespace extremal
