#pragma once

#include <Eigen/Dense>
#include <functional>
#include <random>
#include <span>

#include "solve/search/search.hpp"

/// \file Motions from the start of a problem.

namespace extremal {

/// Scales a velocity so that q'·∂L/∂q' − L is the energy. False if no scale does.
bool scale_to_energy(const Lagrangian& lagrangian, std::span<const double> q, double energy,
                     std::span<double> v);

/// The motion from (q, v) at t = 0; none where the integration fails, or `count` allows no more steps.
Guess motion_from(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
                  double duration, const std::function<bool()>& count);

inline constexpr const char* from_motion = "homotopy in the ends from a motion";

/// Motions whose velocities at the start fill a ball evenly, each led to the end that it misses. A velocity
/// is an extremal's name: all of those with velocities in the ball are led to, some by more motions than
/// others. Its radius, the reach, is in the norm of ∂²L/∂q'∂q' at the start; or, where the energy is given
/// and the duration free, the longest duration.
class MotionScan {
 public:
  MotionScan(const Problem& problem, Search& search);
  /// For ends that are fixed.
  bool usable() const { return usable_; }
  /// Of an extremal; and of a path that goes as far as `extent` in the duration.
  double reach_of(const Solution& solution) const;
  double least_reach(double extent) const;

  /// The next motion in reach; whether it is led to an extremal, which the search's path nearly is then.
  bool next(double reach);

 private:
  double unit();
  Eigen::VectorXd direction();

  const Problem& problem_;
  Search& search_;
  bool usable_;
  Eigen::VectorXd start_;
  Eigen::MatrixXd root_, inverse_root_;  ///< of the matrix of the norm
  std::mt19937_64 random_{20240229};
};

}  // namespace extremal
