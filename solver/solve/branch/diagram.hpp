#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "solve/branch/continuation.hpp"

/// \file A branch of extremals with those that bifurcate from it.

namespace extremal {

/// One branch as a whole.
struct BranchRecord {
  std::optional<int> origin = {};  ///< number of the point, among all, that it begins next to; first: none
  BranchEnd end = BranchEnd::none;
  std::string message = {};  ///< why it ended
  int points = 0;
  std::optional<double> worst_action_slope = 0;  ///< see Continuation; none with forces
  std::optional<double> worst_momentum = 0;      ///< likewise
};

/// The branch of a family, and, if options.other_branches, each that bifurcates from it: where branches meet,
/// all others one way and the other; where a period doubles, the orbits of twice the period. Each has as many
/// points as the options allow. What bifurcates from those in turn is told, but not followed.
class Diagram {
 public:
  Diagram(ProblemFamily family, ContinuationOptions options);

  /// To the next point. False where all branches have ended.
  bool advance();
  const BranchPoint& point() const { return point_; }

  /// In the order of BranchPoint::branch, those that have begun or could not.
  const std::vector<BranchRecord>& branches() const { return branches_; }

 private:
  /// A branch that begins at a point, or the lack of any.
  struct Waiting {
    int origin;
    std::optional<FirstState> first = {};
    bool twice = false;
  };
  void find_others(const BranchStart& start);
  bool begin_next();
  bool to_next_point();
  void state_in_coordinates_of_scene();
  void note();

  std::optional<ProblemFamily> with_forces_;  ///< of one copy, if the family is of two
  ProblemFamily family_;
  ContinuationOptions options_;
  std::optional<Continuation> current_;  ///< none where all have ended
  std::deque<Waiting> waiting_;
  std::vector<BranchRecord> branches_;
  BranchPoint point_;
  int count_ = 0, not_followed_ = 0;  ///< points in all; points of this branch at which others begin
};

}  // namespace extremal
