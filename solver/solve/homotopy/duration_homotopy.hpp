#pragma once

#include <vector>

#include "solve/homotopy/homotopy.hpp"

/// \file The extremal of a duration by continuation from those of others.

namespace extremal {

/// Durations, the best first, in which the forces along a path bend it about as it is bent;
/// those near the wanted one first where the forces bend it little. With g the gradient of S_h in a duration
/// T and K the second variation as T → 0, which is that of the motion without forces, K⁻¹g is how far the
/// path is from such a motion; for a straight line it grows like T², for a curved one it has a minimum.
std::vector<double> natural_durations(const Problem& problem, Path& path, Workspace& workspace,
                                      const ElementTables& tables);

/// The family of extremals of all durations, with the boundary relation given; the parameter is the
/// excess of the duration over the wanted one. For L = q'ᵀM q'/2 − V this is the homotopy in λ of q'ᵀM q'/2 −
/// λV, λ = (duration/T)², from the straight line. The Lagrangian must not depend on t.
class DurationHomotopy : public Homotopy {
 public:
  DurationHomotopy(const Problem& problem, Path& path, Workspace& workspace, std::function<bool()> count);

  /// Takes the path with the duration it has onto the family, and along it to the problem's
  /// duration: nearly an extremal then. False if it does not end there.
  bool trace(const ElementTables& tables);
  /// From an extremal of the problem, to longer durations or to shorter ones. False if it cannot set out.
  bool leave(const ElementTables& tables, bool longer);

 private:
  bool solve_linearised(Move& correction, Move& direction) override;
  const Problem& problem() const override { return problem_; }
  double parameter() const override { return path_.duration() - wanted_; }
  bool set_parameter(double value) override;
  double onward(const Move& direction) const override;

  Problem problem_;
  double wanted_, sense_ = 0;
};

}  // namespace extremal
