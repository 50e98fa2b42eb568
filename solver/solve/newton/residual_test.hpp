#pragma once

#include "solve/newton/iteration.hpp"

/// \file Whether the equations hold where an iteration came to rest.

namespace extremal {

/// The residual of the natural conditions where the action was evaluated last, at `path`: the largest
/// |component| above the roundoff of its own row, which is that of the forces that it sums, by its own second
/// derivatives, and what these make of a displacement of q. Coordinates may have masses of different orders.
double natural_residual(const Problem& problem, const DiscreteAction& action, const Path& path,
                        double displacement = 0);

/// Largest |q|: what NewtonIteration::stiffness() makes roundoff of.
double largest_coordinate(const Path& path);

/// Where the ends are not fixed, a second variation that is nearly singular lets steps become short although
/// δS does not vanish against the momenta.
class ResidualTest {
 public:
  /// At `path`, where the action was evaluated last. `allowed`, relative to the largest momentum: what holds
  /// the phase of a periodic path.
  bool passed(const Problem& problem, const NewtonIteration& newton, const Path& path, double allowed = 0);

  /// The residual of the last test, relative to the largest momentum.
  double share() const { return share_; }

  /// Why the last test was not passed.
  std::string message() const;

 private:
  double share_ = 0;
};

}  // namespace extremal
