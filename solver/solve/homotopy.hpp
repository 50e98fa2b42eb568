#pragma once

#include <functional>
#include <vector>

#include "solve/workspace.hpp"

/// \file Extremals of other durations lead to the one wanted.

namespace extremal {

/// Durations, the best first, in which the forces along the workspace's path bend it about as it is bent;
/// those near the wanted one first where the forces bend it little. With g the gradient of S_h in a duration
/// T and K the second variation as T → 0, which is that of the motion without forces, K⁻¹g is how far the
/// path is from such a motion; for a straight line it grows like T², for a curved one it has a minimum.
std::vector<double> natural_durations(const Problem& problem, Workspace& workspace,
                                      const ElementTables& tables);

/// Follows the family of extremals of all durations, with the boundary relation given, past folds by
/// pseudo-arclength (Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems, 1977). For
/// L = q'ᵀM q'/2 − V this is the homotopy in λ of q'ᵀM q'/2 − λV, λ = (duration/T)², from the straight line.
/// The Lagrangian must not depend on t.
class DurationHomotopy {
 public:
  /// `count` is called for each factorisation and says whether there may be more.
  DurationHomotopy(const Problem& problem, Workspace& workspace, std::function<bool()> count);

  /// From the workspace's path with the duration it has onto the family, and along it to the problem's
  /// duration: nearly an extremal then. False if it does not lead there.
  bool follow(const ElementTables& tables);

 private:
  bool linearise();
  bool approach();
  bool correct(double length);
  bool turn();
  bool land(double from, double& length);
  double dot(const Step& a, const Step& b) const;
  bool apply(const Step& step, double factor);
  void restore();

  Problem problem_;
  Workspace& w_;
  std::function<bool()> count_;
  double wanted_, scale_ = 1;
  int steps_ = 0;
  Step correction_, direction_;  ///< all solutions of the linearised equations: correction + α·direction
  Step tangent_, next_;          ///< of length one
  double cosine_ = 1;            ///< between the last two
  Path saved_;
};

}  // namespace extremal
