#pragma once

#include <string>
#include <vector>

#include "motion/dop853.hpp"
#include "motion/flow.hpp"
#include "rivals/conditions.hpp"
#include "rivals/correction.hpp"
#include "rivals/verify.hpp"

/// \file The motion run beside a trajectory, piece by piece.

namespace extremal {

/// q' and p may be off by this many tolerances of their range.
inline constexpr double velocity_factor = 10;

class IntegrationCheck {
 public:
  /// The references must outlive it.
  IntegrationCheck(const Problem& problem, const Trajectory& trajectory, const VerifyOptions& options);

  /// Reads the trajectory at points of every element, and the scales off them. What failed, or nothing.
  std::string sample();
  /// Fills defects, growth and counts. What failed, or nothing.
  std::string run(Verification& result);

  const PhaseScales& scales() const { return scales_; }
  double allowed_q() const { return allowed_q_; }
  const EndStates& ends() const { return ends_; }
  /// Empty where there are too many coordinates.
  const std::vector<MotionPiece>& pieces() const { return pieces_; }

 private:
  /// (q, p) of the trajectory at time t; its velocity is left in v_. False if L is not finite there.
  bool state_at(double t, std::span<double> y);
  void begin_piece(double t);
  bool compare_step(double before, double now, Verification& result);
  /// In units of what is allowed.
  struct Miss {
    double q = 0, v = 0;
  };
  bool measure(double t, std::span<const double> q, std::span<const double> v, std::span<const double> state,
               Miss& miss);
  static void note(double t, const Miss& miss, Verification& result);
  double growth() const;
  double growth_limit() const;
  std::string run_piece(double& t, double limit, const IntegrationOptions& integration, Verification& result);
  void keep_waypoint(double t);
  bool end_piece(double start, double end, Verification& result);

  const Problem& problem_;
  const Trajectory& trajectory_;
  const VerifyOptions& options_;
  const std::size_t n_;
  const bool complete_;        ///< all variations are integrated, not only some
  const std::size_t columns_;  ///< variations
  Flow flow_;
  Dop853 integrator_, shorter_;
  PhaseScales scales_;
  double allowed_q_ = 0, allowed_v_ = 0;
  double reach_ = 1;  ///< range of q by its size: what the integrator's relative tolerance is measured by
  double length_ = INFINITY;  ///< of a piece that errors ended
  EndStates ends_;
  std::vector<double> y_, v_, motion_v_, interpolated_, next_, saved_;
  std::vector<double> t_samples_, q_samples_, v_samples_;
  std::size_t compared_ = 0;  ///< samples
  std::vector<MotionPiece> pieces_;
  std::vector<Waypoint> waypoints_;  ///< of the piece that is being integrated
  std::size_t kept_ = 0;             ///< numbers kept in waypoints
};

}  // namespace extremal
