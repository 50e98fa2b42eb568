#pragma once

#include "solve/search/guess_mesh.hpp"

/// \file Paths that the gradient flow of the action leads to.

namespace extremal {

/// Minimisers by the gradient flow of the action.
class FlowSearch {
 public:
  /// Both must outlive it.
  FlowSearch(Pursuit& pursuit, const GuessMesh& guess);

  /// From the guess, saddles that the flow meets left to that side (−1, 1); whether an extremal was found. A
  /// flow keeps symmetries of its first path, which may lead to a saddle, or to rests that hardly end: one of
  /// a bent path does not.
  bool run(double side = 1);
  /// Leaves a saddle along its direction of most negative curvature, to either side.
  bool descend_from(const Trajectory& saddle, double side);

 private:
  bool from_guess(const Bend& bend, double side, bool staged = false);
  bool stages() const;
  bool aside(double action, bool staged = false);
  bool from_path(double away, double side, bool staged = false);
  void leave_saddles();

  Pursuit& pursuit_;
  const GuessMesh& guess_;
  int family_steps_;  ///< left to families that flows end at
};

}  // namespace extremal
