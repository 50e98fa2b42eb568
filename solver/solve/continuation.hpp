#pragma once

#include <deque>
#include <string>

#include "solve/branch.hpp"

/// \file A branch of extremals, point by point.

namespace extremal {

/// What a point of a branch is: `fold` where what varies turns back, `branch` where another branch crosses,
/// `period_doubling` where one of twice the period begins.
enum class PointKind { regular, fold, branch, period_doubling };

/// "regular", "fold", "branch", "period-doubling".
const char* name(PointKind kind);

struct BranchPoint {
  double parameter = 0;  ///< the number that varies
  PointKind kind = PointKind::regular;
  Solution solution;  ///< without windows
};

/// Why a branch ended.
enum class BranchEnd {
  none,         ///< it goes on
  not_started,  ///< no extremal to begin with
  target,       ///< it led where it was to lead
  points,       ///< as many points as were asked for
  closed,       ///< it came back to its first point
  collision,    ///< the path needs ever more elements
  limit,        ///< steps became too short: there is nothing beyond
};

struct ContinuationOptions {
  SolveOptions solve = {};  ///< of the first point; each point meets its tolerance
  int points = 50;          ///< at most, folds and crossings included
};

/// Extremals of a family of problems, from the one that a solve finds to where the family is to lead, past
/// folds, by pseudo-arclength (Keller 1977): a step along the tangent, then Newton's method across it.
/// Elements are chosen anew where those there are do not meet the tolerance. Steps grow while Newton's method
/// converges fast and the branch bends little. Folds are found where the derivative of what varies changes
/// its sign, crossings where the orientation of the equations does (Branch::orientation), to 1e-8 of the
/// distance wanted.
///
///     Continuation branch(family, options);
///     while (branch.advance()) use(branch.point());
class Continuation {
 public:
  Continuation(ProblemFamily family, ContinuationOptions options);

  /// To the next point. False where the branch has ended.
  bool advance();
  const BranchPoint& point() const { return point_; }

  BranchEnd end() const { return end_; }
  /// Why it ended, with numbers.
  const std::string& message() const { return message_; }
  /// Largest |∂S/∂s − (−E ∂T/∂s + ∂S/∂p ∂p/∂s)| so far, relative to |S| by the length of the path.
  double worst_action_slope() const { return worst_action_slope_; }

 private:
  /// A place on the branch.
  struct Stand {
    Path path;
    Branch::Units units;  ///< lengths are measured in
    double coordinate = 0, varied = 0, action = 0;
    Move tangent;            ///< of length one
    double rate = 0;         ///< ∂varied/∂s along the tangent
    double action_rate = 0;  ///< ∂S/∂s as its derivatives tell it
    int orientation = 1, index = 0;
    void scale(double factor);
  };
  /// What is met on a step, and how far along the tangent.
  struct Meeting {
    double at;
    BranchPoint point;
  };
  enum class Elements { fine, changed, too_many };

  bool begin();
  bool step();
  bool go(const Stand& from, double length);
  bool correct(double length, const double* landing);
  Elements resolve();
  Scales sizes() const;
  bool turn(bool first = false);
  void measure_anew();
  BranchPoint read(PointKind kind) const;
  bool stop(BranchEnd end, std::string message);

  void meet(const Stand& from, const Stand& to, double length);
  double find_fold(const Stand& from, const Stand& to, double length);
  double find_crossing(const Stand& from, const Stand& to, double length);
  double find_value(const Stand& from, double value, double near, double before, double far, double after);
  template <class Test>
  double root(const Stand& from, double low, double at_low, double high, double at_high, const Test& test,
              double enough);
  bool is_first() const;
  void check_action();

  ProblemFamily family_;
  ContinuationOptions options_;
  Workspace w_;
  Branch branch_;
  Stand here_, first_;         ///< where the path in the workspace stands; the first point
  Move tangent_;               ///< that the path is corrected across
  double largest_extent_ = 0;  ///< of paths so far
  double rest_ = 0;            ///< paths whose extent is less are at rest
  double length_ = 0, longest_ = 0, cosine_ = 1, error_ = 0;
  int corrections_ = 0, count_ = 0;
  bool started_ = false, crowded_ = false;  ///< elements were too many
  double worst_action_slope_ = 0;
  std::deque<BranchPoint> found_;
  BranchPoint point_;
  BranchEnd end_ = BranchEnd::none;
  std::string message_ = "the branch has not been followed";
};

}  // namespace extremal
