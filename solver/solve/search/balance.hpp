#pragma once

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
/// tails give the energy by exponential functions of the length of the rest. So the shifts of the parts for
/// which the energies agree are known also where the energies themselves are below roundoff.
class Balance {
 public:
  /// Of the energies in the rests: by linear tails, or also by what these leave out.
  enum class Accuracy { linear, extrapolated };
  Balance(const Problem& problem, const Path& path, Accuracy accuracy = Accuracy::linear);

  /// Whether there are shifts for which the energies agree.
  bool exists() const { return exists_; }
  /// Of the slowest speeds of the rests the largest, by the largest speed of the path.
  double rest_speed() const { return rest_speed_; }
  /// The largest shift, times the rate of a rest beside it.
  double largest_shift() const { return largest_shift_; }
  /// Of q, absolute: the largest speed by the time in which the shifts are in doubt.
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
    RestEnergy::Value value() const { return energy.at(span.length()); }
  };
  struct Rest {
    Tails tails;
    Span slow;              ///< with all that is slower than the moving parts
    double cost;            ///< L at the equilibrium
    double correction = 0;  ///< of the logarithm of the energy, for tails that are no longer linear
    double doubt = 0;       ///< of that logarithm
    double length() const { return tails.span.length(); }
    RestEnergy::Value at(double length) const;
    RestEnergy::Value value() const { return at(length()); }
  };
  class Speeds;
  static std::optional<Tails> tails(const NearEquilibrium& equilibrium, Speeds& speeds, std::size_t slowest,
                                    double speed);
  static std::optional<Rest> measure(const Lagrangian& lagrangian, Speeds& speeds, std::size_t slowest,
                                     Accuracy accuracy);
  static void extrapolate(const NearEquilibrium& equilibrium, Speeds& speeds, std::size_t slowest,
                          double fastest_tail, double least, Rest& rest);
  void balance();
  double excess(const Rest& rest) const;
  std::size_t falling() const;

  std::vector<Rest> rests_;
  std::vector<Span> stretched_;  ///< of the rests, to shift what is between
  std::vector<double> shifts_;   ///< of the parts after the rests; the last is 0
  double rest_speed_ = 0, largest_shift_ = 0, kinetic_ = 0, fastest_ = 0, error_ = 0;
  bool exists_ = false;
};

/// Stretches of elements along which the path, on average, is slower than a rest may be.
int count_rests(const Trajectory& path);

}  // namespace extremal
