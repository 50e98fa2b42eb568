#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "problem/problem.hpp"

/// \file Orbits that motions with forces tend to.

namespace extremal {

/// Follows a motion of a closed problem of two copies until it closes nearly: with forces, motions tend to
/// orbits that attract them, on both sides of layers that no smooth guess has.
class SettledMotion {
 public:
  /// `problem` must outlive it; `more` says whether there may be another step of the integrator.
  SettledMotion(const Problem& problem, std::function<bool()> more);
  /// Whether there is a flow, whose returns are known: after a duration that L and its forces repeat
  /// themselves in, or to a plane where they do not depend on t.
  static bool suits(const Problem& problem);

  /// From the guess; whether it comes to an orbit, not to rest.
  bool run();
  /// That orbit as a guess for both copies, and its duration.
  const Guess& orbit() const { return orbit_; }
  double duration() const { return duration_; }

 private:
  using State = Eigen::VectorXd;  ///< (q, p)
  bool begin();
  bool follow(State& y, double& t, double end, const std::function<bool(double before)>& on_step = {});
  bool next_return(State& y, double& duration);
  State returned(const State& y) const;
  double distance(const State& a, const State& b) const;
  bool sample(const State& start, double duration);

  const Problem& problem_;
  std::function<bool()> more_;
  Eigen::Index n_;
  Flow flow_;
  Dop853 method_;
  Eigen::MatrixXd back_, transposed_;
  Eigen::VectorXd shift_;
  State start_;
  double size_[2] = {};  ///< of q and p along the motion
  Guess orbit_;
  double duration_ = 0;
};

}  // namespace extremal
