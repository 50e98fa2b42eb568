#pragma once

#include <Eigen/Dense>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>

#include "motion/flow.hpp"
#include "solve/search/arrivals.hpp"
#include "solve/search/guess_mesh.hpp"

/// \file Motions from the start of a problem.

namespace extremal {

/// Scales a velocity so that q'·∂L/∂q' − L is the energy. False if no scale does.
bool scale_to_energy(const Lagrangian& lagrangian, std::span<const double> q, double energy,
                     std::span<double> v);

/// The motion from (q, v) at t = 0, with this error of a step; none where the integration fails, or `count`
/// allows no more steps.
Guess motion_from(const Lagrangian& lagrangian, std::span<const double> q, std::span<const double> v,
                  double duration, double step_error, const std::function<bool()>& count);

inline constexpr const char* from_motion = "homotopy in the ends from a motion";
inline constexpr const char* from_arrival = "newton from a motion that arrives";

/// Motions from the start whose momenta lie in a ball. The momentum at the start determines an extremal. The
/// radius of the ball, the reach, is in the norm of the inverse of ∂²L/∂q'∂q' at the start; or, where the
/// energy is given and the duration free, the longest duration. In two coordinates, in one where the duration
/// is free, and on manifolds of one or two dimensions curves of arrivals are followed. Else motions fill the
/// ball evenly, and each is led to the end that it misses: all extremals with momenta in the ball are led to,
/// some by more motions than others.
class MotionScan {
 public:
  /// Both must outlive it.
  MotionScan(Pursuit& pursuit, const GuessMesh& guess);
  /// For ends that are fixed.
  bool usable() const { return usable_; }
  /// Of an extremal; and of a path that goes as far as `extent` in the duration.
  double reach_of(const Solution& solution);
  double least_reach(double extent) const;

  /// Whether curves of arrivals can be followed.
  bool has_curves() const;
  /// The least reach of motions whose energy suffices for the end. q'·∂L/∂q' − L grows along q' where L is
  /// convex in q': so at the end it is at least −L(q(T), 0).
  double slowest();
  /// Visits the motions that meet the end, whose curves come through a reach between two. False if others
  /// may be missing, because motions did not last, or there were not enough integrator steps: `more` is told
  /// how many were taken.
  bool all(double nearest, double farthest, const std::function<bool(int steps)>& more,
           const std::function<void(const Guess& motion, double duration)>& visit);

  /// The next of motions that fill the ball; whether it is led to an extremal, which the search's path nearly
  /// is then.
  bool next(double reach);

 private:
  Eigen::VectorXd momentum(const Eigen::VectorXd& v);
  Eigen::VectorXd unknown(const Eigen::VectorXd& v);
  Eigen::VectorXd velocity(const Eigen::VectorXd& w);
  double unit();
  Eigen::VectorXd direction();
  void find_tangents(const double* last);

  const Problem& problem_;
  Pursuit& pursuit_;
  const GuessMesh& guess_;
  bool usable_;
  std::optional<Flow> flow_;
  Eigen::VectorXd start_, rest_;         ///< the start, and the momentum of rest there
  Eigen::MatrixXd root_, inverse_root_;  ///< of ∂²L/∂q'∂q'; w = root⁻¹ (p − rest)
  Arrivals::Tangents tangents_;          ///< no columns: w that lead along the manifold are no plane
  std::unique_ptr<Arrivals> arrivals_;
  std::mt19937_64 random_{20240229};
};

}  // namespace extremal
