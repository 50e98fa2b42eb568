#pragma once

#include <optional>
#include <vector>

#include "solve/branch/tracker.hpp"

/// \file Points of a branch, and those found on a step.

namespace extremal {

/// The kind of a point: `fold` where the number that varies turns back, `branch` where another branch
/// crosses, `period_doubling` where one of twice the period begins.
enum class PointKind { regular, fold, branch, period_doubling };

/// "regular", "fold", "branch", "period-doubling".
const char* name(PointKind kind);

struct BranchPoint {
  double parameter = 0;  ///< the number that varies
  PointKind kind = PointKind::regular;
  int branch = 0;     ///< which of several, see Diagram
  Solution solution;  ///< without windows
  /// Of the momenta from the derivatives of the action against ∂L/∂q' at the ends of the trajectory, the
  /// most, relative to the largest there or the mean along the path.
  double momentum_difference = 0;
  /// The energy is conserved, roughly, the equations hold along what is held too, and elements end at kinks.
  bool resolved = true;
};

/// Where other branches begin: the branch point, and a state of the known branch beside it, on the same
/// elements. After a period doubling both are orbits run through twice.
struct BranchStart {
  PointKind kind;  ///< branch or period_doubling
  struct Place {
    Path path;
    double coordinate, varied;  ///< see Branch
    double action;
  } at, beside;
  Branch::Units units;
  int count = 1;         ///< of the directions in which the equations are singular
  bool regular = false;  ///< see Branch, of the branch that is left
};

/// A point, and where another branch begins at it.
struct FoundPoint {
  BranchPoint point;
  std::optional<BranchStart> start = {};
};

/// A point on a step, and how far along the tangent.
struct Event {
  double at;
  FoundPoint found;
};

/// The search for points on the steps of a branch.
struct EventSearch {
  const ProblemFamily& family;
  const BranchState& first;  ///< of the branch
  bool starts = false;       ///< where other branches begin
};

/// The point at the tracker's state. Sets the doubling tests of the state.
BranchPoint read_point(Tracker& tracker, PointKind kind);

/// Tests of the tracker's state, by multipliers as they are, however near to −1: zero where a period doubles.
/// NaN if they are not known.
DoublingTests read_doubling_tests(Tracker& tracker);

/// Whether the number that varies turns back on a step, by more than its error, as the ends of the step show.
bool turns_back(const BranchStep& step);
/// Folds on a step.
std::vector<Event> find_folds(Tracker& tracker, const EventSearch& search, const BranchStep& step);
/// Points where branches cross. Where they explain how the index changes along the step they are complete:
/// else it is miscounted, or a point is missing.
struct Crossings {
  std::vector<Event> events = {};
  int change = 0;  ///< of the index along the step, on the elements that it begins with
  bool complete = true;
  /// The equations are nearly singular where no branches meet: the step leads from one branch to another.
  bool leaps = false;
};
Crossings find_branch_points(Tracker& tracker, const EventSearch& search, const BranchStep& step);
/// Points where a period doubles.
std::vector<Event> find_doublings(Tracker& tracker, const EventSearch& search, const BranchStep& step);

/// Index and nullity of a fold or a branch point, by states next to it on both sides: eigenvalues that pass
/// zero there are null, however far off it is located.
void count_null_directions(Solution& at, const BranchState& before, const BranchState& after);

/// Whether there may be any on a step, as its ends show.
bool may_fold(const BranchStep& step);
bool may_double(const BranchStep& step);
bool may_cross(const BranchStep& step);
/// A change of the index alone is a fold of the duration, or of the number that varies.
bool branches_cross(const BranchState& a, const BranchState& b);

/// Where branches begin at a point so far along the tangent, if they are asked for. At a branch point the
/// tracker's state is that of the point.
std::optional<BranchStart> branch_start(Tracker& tracker, const EventSearch& search, PointKind kind,
                                        const BranchState& from, double at, int count);

/// Along which the equations at the tracker's path are most nearly singular, of length one: the direction of
/// the response, then the one across the first that responds most, and so on, while they respond by more than
/// `least`.
std::vector<Move> singular_directions(Tracker& tracker, const Move& response, int count, double least);

}  // namespace extremal
