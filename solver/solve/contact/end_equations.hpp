#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "problem/extension.hpp"
#include "problem/problem.hpp"

/// \file The ends of a path of arcs, its duration and what determines them.

namespace extremal {

/// An equation that holds at an end which the boundary relation leaves free: an inequality that is an
/// equality there, or a holonomic constraint.
struct EndContact {
  int constraint = 0;
  bool at_end = false;
  bool holonomic = false;  ///< `constraint` counts the constraints, not the inequalities
};

/// First and last state of a path.
struct EndState {
  Eigen::VectorXd p_start, p_end;
  double energy = 0;
};

/// What holds at the ends, for values of the constants k and ν.
struct EndLaws {
  std::vector<double> constants;
  std::shared_ptr<const Manifold> inequalities, constraints;
};

/// Nonlinear conditions and their multipliers.
struct EndCurvature {
  Eigen::MatrixXd slopes;     ///< c × 2n
  Eigen::MatrixXd curvature;  ///< Σ η ∂²r, 2n × 2n
};

/// Unknowns x: those of the boundary relation, the duration where it is free, and a multiplier η for each
/// condition r(q(0), q(T)) = 0. Equations, as many and in the same order: natural conditions of S + Σ η r,
/// the energy or the condition that closes the duration, and r = 0. All are in units of momentum.
class EndEquations {
 public:
  /// Keeps a reference to the problem. Contacts count at ends that are not fixed.
  EndEquations(const Problem& problem, std::vector<EndContact> contacts);

  int unknowns() const;
  int coordinates() const { return free_; }  ///< the first unknowns
  bool free_duration() const { return problem_.duration.free; }
  int multipliers() const { return static_cast<int>(conditions_ + contacts_.size()); }
  const std::vector<EndContact>& contacts() const { return contacts_; }

  /// x of a path with these ends (2n) and this duration; multipliers are zero.
  Eigen::VectorXd at(std::span<const double> ends, double duration) const;
  /// q(0) and q(T), 2n.
  Eigen::VectorXd ends(const Eigen::VectorXd& x) const;
  double duration(const Eigen::VectorXd& x) const;
  /// Whether an unknown changes q(0), or q(T).
  bool moves(int unknown, bool at_end) const;
  /// η of a contact.
  double multiplier(const Eigen::VectorXd& x, std::size_t contact) const;

  /// Units of q, t and momentum in what follows.
  void set_units(double size, double momentum, double time);
  /// A step in relative units, of those unknowns.
  Eigen::VectorXd scaled(const Eigen::VectorXd& step) const;
  Eigen::VectorXd residual(const Eigen::VectorXd& x, const EndState& state, const EndLaws& laws) const;
  /// What the conditions miss that determine the unknown constants.
  Eigen::VectorXd where_residual(const Eigen::VectorXd& x, const EndLaws& laws) const;
  /// Of the nonlinear conditions alone.
  EndCurvature curvature(const Eigen::VectorXd& x, const EndLaws& laws) const;

 private:
  struct Condition {
    double value = 0;
    Eigen::VectorXd slope;  ///< 2n
  };
  /// Each divided by the length of its slope.
  std::vector<Condition> conditions(const Eigen::VectorXd& x, const EndLaws& laws) const;
  Condition contact(const EndContact& contact, const Eigen::VectorXd& ends, double duration,
                    const EndLaws& laws) const;
  double closing(const Eigen::VectorXd& ends, const EndState& state, const EndLaws& laws) const;
  double missed(double value, const Eigen::VectorXd& gradient) const;

  const Problem& problem_;
  int n_, free_;
  std::size_t conditions_;
  std::vector<EndContact> contacts_;
  double size_ = 1, momentum_ = 1, time_ = 1;
};

/// A condition of an extension at ends (2n), for values of its constants: its value, its gradient (2n) and,
/// unless `hessian` is empty, its second derivatives (2n × 2n).
double condition_at(const EndCondition& condition, std::span<const double> constants,
                    std::span<const double> ends, std::span<double> gradient, std::span<double> hessian);

/// The condition that closes a free duration in place of the energy: value and gradient (2n); for a problem
/// that has one.
double closing_condition(const Problem& problem, std::span<const double> constants,
                         std::span<const double> ends, std::span<double> gradient);
/// Whether there is one.
bool closed_by_condition(const Problem& problem);
/// The first of the conditions `where` that determine unknown constants; before it is what closes the
/// duration.
std::size_t first_where(const Problem& problem);

}  // namespace extremal
