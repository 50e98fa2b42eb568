#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "solve/accept/acceptance.hpp"
#include "solve/adapt/refinement.hpp"

/// \file First paths, brought to the tolerance and judged.

namespace extremal {

inline constexpr const char* newton_from_guess = "newton from the guess";

/// What came of starting paths of one kind.
enum class Trial {
  none,     ///< no path was started
  in_vain,  ///< none led to an extremal
  found,
};

/// Brings a first path to the tolerance within a bounded number of steps, and has it judged. Callers put a
/// path on elements, as they like, and ask for its pursuit; one path follows the other.
class Pursuit {
 public:
  /// All three must outlive it.
  Pursuit(const Problem& posed, const SolveOptions& how, Workspace& workspace);
  ~Pursuit();
  Pursuit(const Pursuit&) = delete;
  Pursuit& operator=(const Pursuit&) = delete;

  const Problem& problem;
  const SolveOptions& options;
  Workspace& w;
  Outcome outcome;
  Path& path = outcome.path;
  Refinement refinement;

  /// Makes the path an empty one, to be filled by the caller.
  const ElementTables& open(const std::vector<double>& mesh, int degree);
  /// Of the path.
  const ElementTables& tables() const { return refinement.tables(); }

  struct Result {
    Refinement::Result result;
    bool doubtful;  ///< the equations were nearly singular
    bool converged() const { return result == Refinement::Result::converged; }
  };
  /// Pursues the path.
  Result pursue(const char* strategy);
  /// The same with the ends that the problem asks for, unless the effort is spent; whether an extremal was
  /// found.
  bool found(const char* strategy);
  /// The same on elements of `tables`, and concludes.
  bool refine(const ElementTables& tables, const char* strategy);
  /// Makes the outcome converged or not. Returns which.
  bool conclude(bool converged);
  /// Whether the path that meets the tolerance is an extremal: if not, another guess may lead to one.
  Refinement::Result judge();

  /// Paths from now on are judged by `acceptance`; by none if null. Returns what judged them before.
  Acceptance* judge_by(Acceptance* acceptance) { return std::exchange(acceptance_, acceptance); }
  Acceptance* acceptance() const { return acceptance_; }

  /// Bounds the effort by the elements of the path, and lengths by its size.
  void measure_first_path();
  /// Effort and sizes are those of another pursuit.
  void be_like(const Pursuit& other);
  /// Newton steps of one solve.
  int allowance() const { return allowance_; }
  /// Effort that further paths may take together, in shares of that of one solve.
  void renew(double share = 1);
  /// Counts a step that the caller takes; false if there may be no more.
  bool count_step() { return refinement.count_step(); }
  bool exhausted() const { return refinement.exhausted(); }

  /// Whether a path so far has shrunk to a point of equilibrium.
  bool met_equilibrium() const { return met_equilibrium_; }
  /// The path becomes the last one that was found on some elements, but not on others, if there is one: where
  /// ends are conjugate, different elements find different members of a family.
  void return_to_unheld();
  /// The outcome, with a message where it is the budget that has ended the search.
  const Outcome& unless_spent();

 private:
  bool collapsed() const;

  Acceptance* acceptance_ = nullptr;
  double magnitude_ = 0;        ///< of the guess
  int allowance_ = 0;           ///< see allowance()
  std::optional<Path> unheld_;  ///< see return_to_unheld()
  bool met_equilibrium_ = false;
};

}  // namespace extremal
