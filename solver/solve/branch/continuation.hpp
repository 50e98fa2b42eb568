#pragma once

#include <deque>
#include <optional>
#include <string>

#include "solve/adapt/options.hpp"
#include "solve/branch/events.hpp"
#include "solve/branch/other_branches.hpp"

/// \file A branch of extremals, point by point.

namespace extremal {

struct ContinuationOptions {
  SolveOptions solve = {};      ///< of the first point; each point meets its tolerance
  int points = 50;              ///< at most, folds and branch points included
  bool other_branches = false;  ///< keep where other branches begin
};

/// Extremals of a family of problems, from the one that a solve finds to where the family is to lead, past
/// folds, by pseudo-arclength (see Tracker). Steps grow while Newton's method converges fast and the branch
/// bends little. Found to 1e-11 of the distance wanted: folds, where the derivative of the number that varies
/// changes its sign; branch points, where the orientation of the equations does (Branch::orientation) and
/// their response to a load has no bound; period doublings of periodic orbits, where a multiplier passes −1.
/// Two folds or two doublings on one step are found where its ends predict them.
///
///     Continuation branch(family, options);
///     while (branch.advance()) use(branch.point());
class Continuation {
 public:
  /// How the number that varies changes with the period, where that is free.
  struct PeriodGrowth {
    double duration = 0, varied = 0;
    double slope = 0;    ///< ∂varied/∂T
    double error = 0;    ///< of the number
    double at_rest = 0;  ///< share of the period in which the path hardly moves
  };

  Continuation(ProblemFamily family, ContinuationOptions options);
  /// The branch on from a state; see other_branches().
  Continuation(ProblemFamily family, ContinuationOptions options, FirstState first);

  /// To the next point. False where the branch has ended.
  bool advance();
  const BranchPoint& point() const { return last_.point; }
  /// Where another branch begins at the point, if options.other_branches are wanted.
  const std::optional<BranchStart>& start() const { return last_.start; }

  BranchEnd end() const { return end_; }
  /// Whether there is an extremal to begin with, but the equations are singular there.
  bool singular_at_first() const { return singular_at_first_; }
  /// Why it ended, with numbers.
  const std::string& message() const { return message_; }
  /// Largest |∂S/∂s − (−E ∂T/∂s + ∂S/∂p ∂p/∂s)| so far, relative to |S| or |E T| by the length of the path:
  /// at every few points differences of the action, that of Newton's method, are compared with its
  /// derivatives.
  double worst_action_slope() const { return worst_action_slope_; }
  /// Largest BranchPoint::momentum_difference so far.
  double worst_momentum() const { return worst_momentum_; }

 private:
  bool begin();
  bool begin_from_solve();
  bool begin_beside(const Path& path, double at_rest);
  bool begin_across_family(double at_rest);
  bool end_at_first();
  bool begin_from_state();
  bool step();
  bool lands();
  bool step_over();
  bool ends_on_crossing() const;
  void end_beside_crossing();
  bool retry(double length);
  void check_action();
  double half_distance() const;
  bool halves_period();
  void end_at_half_period(double length, StepEvents& events);
  bool reach_half_period(double length, double before);
  void count_index(StepEvents& events, BranchPoint& next);
  std::optional<Problem> problem_at(double value) const;
  bool end_where_period_diverges(double error, const BranchState& last);
  void add(FoundPoint found);
  bool stop(BranchEnd end, std::string message);
  bool give_up(const BranchState& from);
  std::string onward() const;

  ProblemFamily family_;
  ContinuationOptions options_;
  Tracker tracker_;
  std::optional<FirstState> start_;        ///< the branch begins there
  std::optional<FoundPoint> first_point_;  ///< where the branch begins beside it
  BranchState first_;
  int index_ = 0, unknown_indices_ = 0, hidden_points_ = 0;
  PeriodGrowth before_, here_;
  BranchState from_, to_;  ///< of the last step, whose memory the next one uses
  double length_ = 0, longest_ = 0;
  int count_ = 0, steps_ = 0;
  std::optional<double> turned_at_;  ///< the last fold
  bool started_ = false, singular_at_first_ = false;
  double worst_action_slope_ = 0, worst_momentum_ = 0;
  std::deque<FoundPoint> found_;
  FoundPoint last_;
  BranchEnd end_ = BranchEnd::none;
  std::string message_ = "the branch has not been followed";
};

}  // namespace extremal
