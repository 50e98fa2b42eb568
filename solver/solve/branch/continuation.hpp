#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <string>

#include "solve/adapt/options.hpp"
#include "solve/branch/branch.hpp"

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
  int branch = 0;     ///< which of several, see Diagram
  Solution solution;  ///< without windows
};

/// Why a branch ended.
enum class BranchEnd {
  none,         ///< it goes on
  not_started,  ///< no extremal to begin with
  target,       ///< it led where it was to lead
  points,       ///< as many points as were asked for
  closed,       ///< it came back to its first point
  rest,         ///< its orbits shrink onto an equilibrium
  collision,    ///< the path needs ever more elements
  limit,        ///< there is no problem beyond, or L is not finite there
  too_short,    ///< steps became too short
};

struct ContinuationOptions {
  SolveOptions solve = {};  ///< of the first point; each point meets its tolerance
  int points = 50;          ///< at most, folds and crossings included
  bool seeds = false;       ///< keep what other branches begin with
};

/// Of a test on a step: where along the tangent, and its value.
struct Reading {
  double at, value;
};

/// A path next to where another branch begins.
struct Seed {
  PointKind kind;     ///< branch or period_doubling
  Path path;          ///< after a period doubling that of the orbit run through twice
  double coordinate;  ///< see Branch
  Branch::Units units;
};

/// Extremals of a family of problems, from the one that a solve finds to where the family is to lead, past
/// folds, by pseudo-arclength (Keller 1977): a step along the cubic that the last tangents foresee, then
/// Newton's method across the tangent. Elements are chosen anew where those there are do not meet the
/// tolerance. Steps grow while Newton's method converges fast and the branch bends little. Found to 1e-11 of
/// the distance wanted: folds, where the derivative of what varies changes its sign; crossings, where the
/// orientation of the equations does (Branch::orientation) and their response to a load has no bound; period
/// doublings of periodic orbits, where a multiplier passes −1. Two folds or two doublings on one step are
/// seen where its ends foresee them.
///
///     Continuation branch(family, options);
///     while (branch.advance()) use(branch.point());
class Continuation {
 public:
  Continuation(ProblemFamily family, ContinuationOptions options);
  /// The branch that crosses another one near a seed, one way (side = 1) or the other (−1). The family is
  /// that of its orbits: after a period doubling, that of twice the period.
  Continuation(ProblemFamily family, ContinuationOptions options, Seed seed, int side);

  /// To the next point. False where the branch has ended.
  bool advance();
  const BranchPoint& point() const { return last_.point; }
  /// What begins at the point, if options.seeds are wanted.
  const std::optional<Seed>& seed() const { return last_.seed; }

  BranchEnd end() const { return end_; }
  /// Why it ended, with numbers.
  const std::string& message() const { return message_; }
  /// Largest |∂S/∂s − (−E ∂T/∂s + ∂S/∂p ∂p/∂s)| so far, relative to |S| or |E T| by the length of the path:
  /// at every few points differences of the action, that of Newton's method, are held against its
  /// derivatives.
  double worst_action_slope() const { return worst_action_slope_; }
  /// Largest |∂S/∂q(T) − p(T)|, |∂S/∂q(0) + p(0)| so far, relative to the largest momentum there or the mean
  /// along the path: derivatives of the action against the momenta of the trajectory.
  double worst_momentum() const { return worst_momentum_; }

 private:
  /// A place on the branch.
  struct Stand {
    Path path;
    Branch::Units units;  ///< lengths are measured in
    double coordinate = 0, varied = 0, action = 0;
    Move tangent;             ///< of length one
    Move bend, twist;         ///< of the branch off it, by σ² and σ³; empty if not known
    Move turning;             ///< of the tangent since the place before, by the way back to it; may be empty
    double back = 0;          ///< that way
    std::vector<double> row;  ///< see Branch::closing_row
    double rate = 0;          ///< ∂varied/∂s along the tangent
    double action_rate = 0;   ///< ∂S/∂s as its derivatives tell it
    double energy_time = 0;   ///< |E T|
    int orientation = 1, index = 0;
    std::vector<double> gaps, gaps_before;  ///< see doubling_gaps; those of the place before
    void scale(double factor);
    Move ahead(double length) const;
  };
  struct Found {
    BranchPoint point;
    std::optional<Seed> seed = {};
  };
  /// What is met on a step, and how far along the tangent.
  struct Meeting {
    double at;
    Found found;
  };
  enum class Elements { fine, changed, too_many };
  /// Why a step failed.
  enum class Refusal { none, no_problem, crowded, rough };
  /// A branch turns on a step by no more than the angle with this cosine.
  static constexpr double sharpest_turn = 0.9;

  bool begin();
  bool begin_from_solve();
  bool begin_from_seed();
  bool step();
  bool go(const Stand& from, double length, bool same_elements = false, const double* landing = nullptr);
  bool stays(const Stand& from, double length, bool same_elements = false);
  bool correct(double length, const double* landing);
  Elements resolve();
  Plan plan_for(const Scales& size);
  void adopt(const Plan& plan);
  Move carried(const Move& move, const Path& from);
  Move way_to(const Stand& to);
  Scales sizes() const;
  bool turn(bool first = false);
  void measure_anew();
  void curve(const Stand& before, double length);
  double foreseen() const;
  BranchPoint read(PointKind kind);
  /// The elements of the place, for second variations exact to 1e-6 of the tolerance.
  Condensed condensed() const {
    return {w_.iteration.condensed(), std::min(0.1 * std::sqrt(options_.solve.tolerance), 1e-3)};
  }
  void read_momenta(Solution& solution);
  bool stop(BranchEnd end, std::string message);
  bool give_up(const Stand& from);

  bool meet(const Stand& start, const Stand& to, double length);
  std::vector<Reading> meet_others(const Stand& from, const Stand& to, double length,
                                   std::vector<Meeting>& met);
  Stand aimed(const Stand& from, const Stand& to, double length);
  struct Rates;
  static Rates rates_between(const Stand& from, const Stand& to, double length);
  static bool may_fold(const Stand& from, const Stand& to, double length);
  void find_folds(const Stand& from, const Stand& to, double length, std::vector<Meeting>& met);
  double find_value(const Stand& from, double value, const Reading& near, const Reading& far);
  template <class Test, class Done>
  double root(const Stand& from, Reading low, Reading high, std::optional<Reading> third, const Test& test,
              const Done& done);
  template <class Test, class Use>
  void find_roots(const Stand& from, const std::vector<Reading>& places, std::optional<Reading> beside,
                  const Test& test, const Use& use);
  template <class Test>
  std::optional<Reading> dip(const Stand& from, const Reading& low, const Reading& high, double at,
                             const Test& test);
  bool settled(double change) const;
  bool is_first() const;
  void check_action();

  void find_crossings(const Stand& from, const Stand& to, double length, std::vector<Meeting>& met);
  struct Side;
  double find_crossing(const Stand& from, const Stand& before, double low, double high, Move& response);
  double narrow(const Stand& from, const Stand& before, Side (&sides)[2]);
  static bool differs(const Stand& a, const Stand& b);
  std::optional<BranchPoint> crossing_at(const Stand& from, double at, double length);
  std::optional<Stand> resolved_for(const Stand& from, const Move& response);
  static bool may_double(const Stand& from, const Stand& to, double length);
  static std::optional<double> nearing_doubling(const Stand& from, const Stand& to, double length,
                                                std::size_t k);
  void find_doublings(const Stand& from, const Stand& to, double length, std::vector<Meeting>& met);
  std::vector<double> read_gaps();
  double find_rest(const Stand& from, const Stand& to, double length);
  std::optional<Seed> seed_at(PointKind kind, const Stand& from, double at);

  ProblemFamily family_;
  ContinuationOptions options_;
  Workspace w_;
  Path path_;  ///< that is corrected
  Scratch momentum_memory_;
  Branch branch_;
  std::optional<Seed> seed_;  ///< what the branch begins with
  int side_ = 1;
  Stand here_, first_;         ///< where the path stands; the first point
  Stand from_, to_;            ///< of the last step, whose memory the next one uses
  Move tangent_;               ///< that the path is corrected across
  double largest_extent_ = 0;  ///< of paths so far
  double rest_ = 0;            ///< paths whose extent is less are at rest
  double length_ = 0, longest_ = 0, cosine_ = 1, error_ = 0;
  double landed_ = 0;  ///< so far from where go() went, along the tangent, the value wanted was
  int factors_ = 0;    ///< that the last corrections took
  int count_ = 0, steps_ = 0;
  bool started_ = false;
  Refusal refusal_ = Refusal::none;
  double worst_action_slope_ = 0, worst_momentum_ = 0;
  std::deque<Found> found_;
  Found last_;
  BranchEnd end_ = BranchEnd::none;
  std::string message_ = "the branch has not been followed";
};

}  // namespace extremal
