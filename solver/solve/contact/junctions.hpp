#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solve/contact/arcs.hpp"

/// \file Arcs joined to a path whose momentum is continuous.

namespace extremal {

/// A part of the path, and what is held there.
struct Interval {
  std::vector<int> held;  ///< ascending
  double from = 0, to = 0;
  /// Between two intervals that hold the same: what is touched where this one begins, for no time; else −1.
  int touched = -1;
};

/// q(t) of a path in [0, T].
using PathPoints = std::function<void(double t, std::span<double> q)>;

/// Newton's method for the points and times at which arcs meet. Where arcs meet, the inequalities of both are
/// equalities. Minimisers have no kinks: the momentum is the same on both sides. That is as many equations as
/// there are unknowns, since a contact begins and ends tangentially. ∂S/∂t of a junction is of second order
/// in the jump and determines nothing. A contact that is too short for an arc is a touch: the momentum may
/// jump across the surface, a little, and the mean velocity is tangent to it. Where two contacts begin at
/// once, there are more equations, which agree.
class Junctions {
 public:
  /// The intervals abut, from 0 to T; `path` is where points and arcs begin. `arcs` is kept by reference.
  Junctions(Arcs& arcs, const std::vector<Interval>& intervals, const PathPoints& path);

  enum class Result { matched, collapsed, failed };
  Result run();

  const std::vector<PathArc>& arcs() const { return parts_; }
  const std::vector<SolvedArc>& solved() const { return solved_; }
  int collapsed() const { return collapsed_; }  ///< the number of an arc that has shrunk to nothing
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

 private:
  /// Free unknowns of the ends; points and times of junctions.
  struct State {
    Eigen::VectorXd y;
    std::vector<Eigen::VectorXd> q;
    std::vector<double> t;
  };
  struct Trial {
    std::vector<PathArc> parts;
    std::vector<SolvedArc> solved;
    Eigen::VectorXd residual;
  };
  int ends() const { return static_cast<int>(state_.y.size()); }
  int count() const { return static_cast<int>(state_.t.size()); }
  bool place(State& state, std::vector<PathArc>& parts) const;
  bool solve(Trial& trial, int first, int last);
  Eigen::VectorXd residual(const Trial& trial) const;
  Eigen::VectorXd jump(const Trial& trial, int junction) const;
  Eigen::MatrixXd basis(int junction) const;
  State moved(const Eigen::VectorXd& step) const;
  bool differentiate();
  double longest_step(const Eigen::VectorXd& step) const;
  double movement_of(const Eigen::VectorXd& step) const;
  void measure();
  Eigen::VectorXd newton_step();

  Arcs& arcs_;
  const Problem& problem_;
  int n_;
  double duration_;
  State state_;
  std::vector<std::vector<int>> held_;  ///< of each junction
  std::vector<int> touched_;            ///< likewise
  std::vector<PathArc> parts_;
  std::vector<SolvedArc> solved_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd slopes_;
  double size_ = 1, momentum_ = 1, mismatch_ = INFINITY, movement_ = INFINITY;
  double amplification_ = 0;
  int collapsed_ = -1;
  std::string message_;
};

}  // namespace extremal
