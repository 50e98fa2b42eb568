#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "solve/branch/branch_state.hpp"

/// \file From one state on a branch to others: predictor, corrector, elements.

namespace extremal {

/// Why a step failed.
enum class StepFailure {
  none,
  no_problem,  ///< there is no such problem, or L is not finite
  crowded,     ///< the path needs too many elements
  rough,       ///< corrections do not shrink, or the branch turns too much
  hidden,      ///< corrections are roundoff, and longer than the tolerance allows
};

/// Steps of pseudo-arclength (Keller 1977): along the cubic that the last tangents predict, then Newton's
/// method across the tangent, on elements that meet the tolerance.
class Tracker {
 public:
  /// `family` must outlive it.
  Tracker(const ProblemFamily& family, double tolerance);
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// Of the path that was reached last.
  BranchState state;

  /// Begins at a path, on elements that meet the tolerance; `rest`: paths whose extent is less are at rest.
  bool begin(Path path, double coordinate, double rest);
  /// Begins next to where branches meet, on the elements that there are, in these units of length.
  bool begin(const Path& path, double coordinate, const Branch::Units& units, double rest);
  /// Begins at a state.
  bool begin(const BranchState& from, double rest);

  /// Begins at the extremal with this value of the number that varies, near that of a state, and to which
  /// Newton's method leads from where its tangent does. How far that is from the state; nothing if it fails.
  std::optional<double> begin_beside(const BranchState& from, double value, double rest);

  /// So far along the tangent from a state, and back onto the branch; with `landing` to where the number that
  /// varies has that value. On elements that meet the tolerance, or on those of the state. False if it fails.
  bool reach(const BranchState& from, double length, bool same_elements = false,
             const double* landing = nullptr);
  /// By a move from a state, on its elements, and back across its tangent.
  bool reach(const BranchState& from, const Move& by);
  /// Along the tangent, and onto no other branch that is near.
  bool reach_smoothly(const BranchState& from, double length, bool same_elements = false);
  /// Whether the branch may lead on from a state to this one, which was reached from it: if its tangent turns
  /// one way, the chord is between those of both.
  bool turns_one_way(const BranchState& from);
  /// From the path to where the number that varies has a value near its own.
  bool land(double value);
  /// The state, measured anew in lengths of its own path, or in a share of the largest before: a path that
  /// shrinks to nothing is passed.
  void measure_anew();

  /// Steps let a closed path cross kinks of L inside the elements beside T, lest these shorten to nothing.
  /// Elements on which it meets the tolerance there; nothing if it does on its own.
  std::optional<std::vector<double>> mesh_beside_closing() const;
  /// The state on other elements, with its value of the number that varies, or across its tangent. False if
  /// it fails.
  bool move_to(const std::vector<double>& mesh, bool across);

  /// The state begins elsewhere on its orbit where that begins beside a kink.
  void begin_off_kinks();

  /// The predictor of the state, from the state before, so far back.
  void predict(const BranchState& before, double length);
  /// How far the tangent is predicted to turn by no more than a step may.
  double predictable_length() const;
  /// A state from which the step to another one is predicted as the cubic through both, with their tangents.
  BranchState with_cubic(const BranchStep& step);
  /// The state with a predictor that is right in the mean of two states, reached from it as far before and
  /// after `at` as the length tells.
  BranchState corrected(const BranchState& from, const BranchStep& around, double at);
  /// A state on elements that resolve also the way to a branch that crosses there; nothing if its own do.
  std::optional<BranchState> resolved_for(const BranchState& from, const Move& response);

  /// Corrections have nothing along these directions, which belong to the elements of the path, until the
  /// next call: branch points are reached so. Empty for none.
  void hold(const std::vector<Move>& directions) { branch_.hold(directions); }
  /// Holds the directions in which the extremals with the state's value are a family, and takes the tangent
  /// across them. False if there are none.
  bool hold_family();
  /// As many, as they are at the state.
  bool hold_family_anew();
  /// Begins at a state without.
  void let_family_go(const BranchState& at, double rest);
  /// From the path to that of another state, on the elements of the path.
  Move difference_to(const BranchState& to);
  /// From a state to another one: how far in all, and along its tangent.
  struct Way {
    double length, along;
  };
  Way way(const BranchState& from, const BranchState& to);
  /// The response of the equations at the path, with what is held; see Branch::respond. False where they
  /// cannot be solved.
  bool respond(Move& response, int which = 0);

  /// Whether the equations hold at the path, along directions that are held too.
  bool balanced() const;

  Branch& branch() { return branch_; }
  const Branch& branch() const { return branch_; }
  /// Sizes of the path, that of a path at rest zero.
  Scales sizes() const;
  /// The elements of the path, for second variations exact to 1e-6 of the tolerance.
  Condensed condensed() const {
    return {w_.iteration.condensed(), std::min(0.1 * std::sqrt(tolerance_), 1e-3)};
  }
  Workspace& workspace() { return w_; }
  const Move& tangent() const { return tangent_; }

  double tolerance() const { return tolerance_; }
  double error() const { return error_; }    ///< of q, absolute
  double cosine() const { return cosine_; }  ///< of the angle by which the last step turned
  bool turn_is_small() const { return cosine_ > sharpest_turn; }
  int factorisations() const { return factorisations_; }  ///< of the last corrections
  double landed() const { return landed_; }               ///< how far beyond reach()'s length
  StepFailure failure() const { return failure_; }
  void fail(StepFailure failure) { failure_ = failure; }

 private:
  static constexpr double sharpest_turn = 0.9;
  enum class Fit { fine, changed, too_many };
  bool correct(double length, const double* landing, double share = 1);
  bool settle();
  double left_at_value() const;
  double value_missed() const;
  bool update_tangent(bool first = false);
  double crossing_test();
  bool resolve_forces(double length, const double* landing);
  std::optional<int> node_off_kinks() const;
  void begin_at_node(int node);
  Fit fit_elements();
  Plan plan_for(const Scales& size);
  void adopt(const Plan& plan);
  void change_elements(int degree, const std::vector<double>& mesh);
  Move transferred(const Move& move, const Path& from);
  bool return_to(const BranchState& from);
  bool move_aside(double by);
  std::vector<Move> responses(int count, std::vector<double>& sizes);
  bool hold_at(BranchState at, std::vector<Move> directions);
  bool displace(const BranchState& from, const Move& by, double length, const double* landing);

  const ProblemFamily& family_;
  const double tolerance_;
  Workspace w_;
  Path path_;  ///< that is corrected
  Branch branch_;
  Move tangent_;               ///< that the path is corrected across
  double largest_extent_ = 0;  ///< of paths so far
  double rest_ = 0;
  double cosine_ = 1, error_ = 0, landed_ = 0;
  int factorisations_ = 0;
  StepFailure failure_ = StepFailure::none;
};

}  // namespace extremal
