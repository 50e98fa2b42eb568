#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solve/contact/arcs.hpp"
#include "solve/contact/end_equations.hpp"

/// \file Arcs joined to a path whose momentum is continuous.

namespace extremal {

/// A part of the path, and what is held there.
struct Interval {
  std::vector<int> held;  ///< ascending
  double from = 0, to = 0;
  /// Between two intervals that hold the same: what is touched where this one begins, for no time; else −1.
  int touched = -1;
  /// Of the first and the last interval: what is touched at a free start, or a free end, of the path.
  std::vector<int> at_start = {}, at_end = {};
};

/// q(t) of a path in [0, T].
using PathPoints = std::function<void(double t, std::span<double> q)>;

/// Newton's method for the ends, the duration, the constants k and ν of an extension, and the points and
/// times at which arcs meet. Where arcs meet, the inequalities of both are equalities. Minimisers have no
/// kinks: the momentum is the same on both sides. That is as many equations as there are unknowns, since a
/// contact begins and ends tangentially. ∂S/∂t of a junction is of second order in the jump and determines
/// nothing. A contact that is too short for an arc is a touch: the momentum may jump across the surface, a
/// little, and the mean velocity is tangent to it. Where two contacts begin at once, there are more
/// equations, which agree. A closed path of an autonomous system may be shifted in time; its first junction
/// keeps its time.
class Junctions {
 public:
  /// The intervals abut, from 0 to T; `path` is where points and arcs begin, and `constants` what k and ν are
  /// there. `arcs` is kept by reference.
  Junctions(Arcs& arcs, const std::vector<Interval>& intervals, const PathPoints& path,
            const std::vector<double>& constants);

  /// `simultaneous`: contacts that were taken to change at one junction do so at times of their own.
  enum class Result { matched, collapsed, simultaneous, failed };
  Result run();

  const std::vector<PathArc>& arcs() const { return parts_; }
  const std::vector<SolvedArc>& solved() const { return solved_; }
  double duration() const { return parts_.back().to; }
  const std::vector<double>& constants() const { return parts_.front().constants; }  ///< k and ν
  int collapsed() const { return collapsed_; }  ///< the number of an arc that has shrunk to nothing
  /// The intervals of this path, with each change of what is held at its own time.
  std::vector<Interval> separated(const std::vector<Interval>& intervals) const;
  const std::string& message() const { return message_; }
  double mismatch() const { return mismatch_; }  ///< of momenta, relative to the largest
  double movement() const { return movement_; }  ///< of points by what is left of it, in units of q
  double size() const { return size_; }          ///< largest range of a coordinate
  int unknowns() const;
  /// Displacements of junctions by relative errors of momenta, in relative units; whether some directions do
  /// not change the momenta.
  double amplification() const { return amplification_; }
  bool singular();
  /// What is touched where each arc but the first begins; −1: nothing.
  const std::vector<int>& touched() const { return touched_; }
  /// ∫ μ dt of the touch at a junction.
  double impulse(int junction) const;
  /// What is touched at ends that are free, and ∫ μ dt there by the length of the slope.
  const std::vector<EndContact>& end_contacts() const { return ends_.contacts(); }
  double end_impulse(std::size_t contact) const { return -ends_.multiplier(state_.ends, contact); }
  /// The momentum that is zero for `end_impulse`.
  double momentum() const { return momentum_; }
  EndCurvature end_curvature() const { return ends_.curvature(state_.ends, laws(constants())); }

 private:
  /// Unknowns of the ends; k and ν; points and times of junctions.
  struct State {
    Eigen::VectorXd ends, constants;
    std::vector<Eigen::VectorXd> q;
    std::vector<double> t;
  };
  struct Trial {
    State state;
    std::vector<PathArc> parts;
    std::vector<SolvedArc> solved;
    Eigen::VectorXd residual;
  };
  /// Inequalities that begin, or cease, to be equalities at one time.
  struct Change {
    std::vector<int> constraints;
    double time = 0;
  };
  int count() const { return static_cast<int>(state_.t.size()); }
  int constant_count() const { return static_cast<int>(state_.constants.size()); }
  int unknown_constants() const { return problem_.extension ? problem_.extension->unknowns() : 0; }
  int integrals() const { return constant_count() - unknown_constants(); }
  int first_of_junctions() const { return ends_.unknowns() + constant_count(); }
  EndLaws laws(const std::vector<double>& constants) const {
    return {constants, arcs_.inequalities(constants), arcs_.manifold({}, constants)};
  }
  Eigen::VectorXd integral_residual(const Trial& trial) const;
  std::vector<Change> changes_at(int junction) const;
  bool find_changes();
  /// Directions of the point of a junction, and whether its time is an unknown.
  Eigen::Index directions(int junction) const;
  bool timed(int junction) const { return junction > 0 || !phase_held_; }
  bool place(State& state, std::vector<PathArc>& parts) const;
  bool solve(Trial& trial, int first, int last);
  Eigen::VectorXd residual(const Trial& trial) const;
  Eigen::VectorXd jump(const Trial& trial, int junction) const;
  Eigen::MatrixXd basis(int junction) const;
  State moved(const Eigen::VectorXd& step) const;
  bool start();
  bool solve_closed();
  bool conditions_hold(const Eigen::VectorXd& step);
  bool take_step(const Eigen::VectorXd& step, double factor, Trial& trial);
  double difference_at(int junction) const;
  bool differentiate();
  double longest_step(const Eigen::VectorXd& step) const;
  double movement_of(const Eigen::VectorXd& step) const;
  int shrunken(double part) const;
  void measure();
  Eigen::VectorXd newton_step();
  /// The part of a residual that steps can change. What is left where contacts begin at nearly one time is of
  /// their difference in time.
  double reducible(const Eigen::VectorXd& residual) const { return (range_.transpose() * residual).norm(); }

  Arcs& arcs_;
  const Problem& problem_;
  int n_;
  EndEquations ends_;
  double duration_;  ///< at the start
  bool phase_held_ = false;
  State state_;
  std::vector<std::vector<int>> held_;  ///< of each junction
  std::vector<int> touched_;            ///< likewise
  std::vector<PathArc> parts_;
  std::vector<SolvedArc> solved_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd slopes_, range_;  ///< derivatives of the residual; an orthonormal basis of their columns
  Eigen::VectorXd constant_units_;
  double size_ = 1, momentum_ = 1, speed_ = 0, mismatch_ = INFINITY, movement_ = INFINITY;
  double amplification_ = 0;
  int collapsed_ = -1;
  std::vector<std::vector<Change>> changes_;  ///< of each junction, in order of their times
  std::string message_;
};

}  // namespace extremal
