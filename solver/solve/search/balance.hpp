#pragma once

#include <Eigen/Dense>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "action/path.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"
#include "solve/search/rest_energy.hpp"

/// \file Where in time a path belongs that comes to rest near equilibria.

namespace extremal {

/// A path between fixed ends that rests near equilibria, at its ends or between. What lies between two rests
/// is held in time by the energy, which is the same in all of them. In a rest the motion is linear, and its
/// tails give the energy and the action by exponential functions of the length of the rest. So the shifts of
/// the parts for which the action of all rests is least are known also where energies are below roundoff.
class Balance {
 public:
  /// Of the energies in the rests: by linear tails, or also by what these leave out.
  enum class Accuracy { linear, extrapolated };
  Balance(const Problem& problem, const Path& path, Accuracy accuracy = Accuracy::linear);

  /// Whether there are shifts for which the action is least.
  bool exists() const { return exists_; }
  /// In the rests, where the action is least, by q'·Mq' where the path is fastest.
  double energy() const { return energy_; }
  /// The largest change of the length of a rest, times its fastest rate.
  double largest_shift() const { return largest_shift_; }
  /// Of q, absolute: the largest speed by the shifts.
  double displacement() const;
  /// Of q, absolute: the largest speed by what doubts of energies change of the shifts.
  double error() const { return error_; }
  /// Shifts the parts of `path`, by stretching and compressing the elements of the rests. False, and nothing
  /// is done, if those are too short.
  bool apply(Path& path) const;
  /// Whether the action falls as a rest becomes shorter, between parts or at an end: L is larger at its
  /// equilibrium than at that of another rest, or its energy stays negative, as where a path turns back. For
  /// ∂S/∂t of a part is the energy after it less that before, and what is above −L at the equilibrium falls
  /// in size as rests become longer.
  bool falls() const;
  /// Gives the time of the rest that falls most to the others: the parts beside it meet.
  bool fall(Path& path) const;

 private:
  struct Span {
    double from, to;
    double length() const { return to - from; }
  };
  /// A rest between the times at which the speed falls below that of a tail and rises above it.
  struct Tails {
    Span span;
    RestEnergy energy;  ///< by the length of span
  };
  struct Rest {
    Tails tails;
    Span slow;    ///< with all that is slower than the moving parts
    double cost;  ///< L at the equilibrium
    double length() const { return tails.span.length(); }
    RestEnergy::Value value() const { return tails.energy.at(length()); }
  };
  class Speeds;
  static std::optional<Tails> tails(const NearEquilibrium& equilibrium, Speeds& speeds, std::size_t slowest,
                                    double speed);
  static std::optional<Rest> measure(const Lagrangian& lagrangian, Speeds& speeds, std::size_t slowest,
                                     Accuracy accuracy);
  static RestEnergy extrapolate(const NearEquilibrium& equilibrium, Speeds& speeds, std::size_t slowest,
                                double fastest, double least, const Tails& measured);
  /// The values of RestEnergy::Action in all rests; the sum of the actions, and of their sizes.
  struct Actions {
    double value = std::numeric_limits<double>::infinity(), size = 0;
    Eigen::VectorXd energy, stiffness, most_stiffness, doubt;
  };
  Actions actions(const Eigen::VectorXd& shifts, double exponent) const;
  double largest_log(const Eigen::VectorXd& shifts) const;
  Eigen::MatrixXd hessian(const Actions& rests) const;
  std::optional<Eigen::VectorXd> least_action() const;
  void balance();
  double excess(const Rest& rest) const;
  std::size_t falling() const;

  std::vector<Rest> rests_;
  Eigen::VectorXd lengths_;      ///< of the rests
  Eigen::MatrixXd by_shifts_;    ///< what a shift of each part changes of the lengths
  std::vector<Span> stretched_;  ///< of the rests, to shift what is between
  std::vector<double> shifts_;   ///< of the parts after the rests; the last is 0
  double energy_ = 0, largest_shift_ = 0, kinetic_ = 0, fastest_ = 0, error_ = 0;
  bool exists_ = false;
};

}  // namespace extremal
