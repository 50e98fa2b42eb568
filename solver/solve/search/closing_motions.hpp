#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <span>

#include "motion/flow.hpp"
#include "problem/problem.hpp"
#include "solution/solution.hpp"

/// \file Periodic orbits under a drive from motions that do not close.

namespace extremal {

inline constexpr const char* from_open_motion = "newton from a motion that nearly closes";

/// The state y = (q, p) at the start determines an orbit. A lattice of starts fills a box; where the motion
/// of one closes better than those of its neighbours, an orbit may be near. Steps of bounded length
/// (Levenberg, Marquardt) make the motion close better still. Where that fails, as the motion is very
/// unstable, Newton's method on the whole path can close it: no unknown of the path changes by more than what
/// is missed.
class ClosingMotions {
 public:
  explicit ClosingMotions(const Problem& problem);
  /// For periodic problems that depend on t, with a flow, of few coordinates: else a shift in time moves
  /// orbits, or the box has too many dimensions to be filled.
  bool usable() const { return flow_.has_value(); }
  int dimensions() const { return 2 * n_; }
  /// The box: about rest at q, in units of these extents and of the momenta of swings as far as that with
  /// this frequency. Its half width is the reach. False if L is not finite there.
  bool around(std::span<const double> q, std::span<const double> extents, double frequency);
  double reach_of(const Solution& solution);

  /// Visits motions that nearly close, whose starts are between two reaches, on a lattice of so many points
  /// across the box. False if there were not enough
  /// integrator steps: `more` is told how many were taken.
  bool all(double nearest, double farthest, int across, const std::function<bool(int steps)>& more,
           const std::function<void(const Guess& motion)>& visit);

 private:
  using Vector = Eigen::VectorXd;
  enum class Closing {
    closed,
    fails,
    degenerate,  ///< closed, but only more digits would tell it from members of a continuum
  };
  Vector opening(const Vector& start, const Vector& end) const;
  template <class Slope>
  bool integrate(const Slope& slope, Vector& y, double tolerance, int cost);
  double opening_from(const Vector& start);
  Closing close(Vector& start);
  void try_from(const Vector& start, const std::function<void(const Guess& motion)>& visit);

  const Problem& problem_;
  int n_, cost_;
  std::optional<Flow> flow_;
  Eigen::MatrixXd back_, transposed_;  ///< R⁻¹ and Rᵀ of q(T) = R q(0) + c
  Vector shift_;                       ///< c
  Vector centre_, unit_;
  std::function<bool(int)> more_;
};

}  // namespace extremal
