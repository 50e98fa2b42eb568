#pragma once

#include <memory>
#include <span>
#include <vector>

#include "system/tape.hpp"

/// \file Where a Lagrangian is not smooth. abs(u), min(a, b), max(a, b) and step(u) are smooth on both sides
/// of a surface u(q, q', t) = 0, with u = a − b for min and max. Beside it
///   L = smooth part + w |u| + a sign u.
/// A Lagrangian has a = 0 there, or its action would jump with the time of the crossing. That of two copies
/// (system/copies.hpp) has a = λ·F₁ where a force has a part F₁ sign u, as friction has: a vanishes with λ
/// along the path, its slope does not. So ∂L/∂q jumps by 2 (w ∂u/∂q + ∂a/∂q) from u < 0 to u > 0.

namespace extremal {

/// One surface; all functions are Lagrangians of the same coordinates, evaluated like these.
struct KinkSurface {
  std::shared_ptr<const Lagrangian> u;
  std::shared_ptr<const Lagrangian> u_by_time;  ///< ∂u/∂t
  std::shared_ptr<const Lagrangian> odd;  ///< 2 w |u| + 2 a sign u: L − (L of the other side, continued)
  bool by_velocity = false;               ///< u depends on velocities
};

/// The surfaces of a Lagrangian; at least one.
class Kinks {
 public:
  explicit Kinks(std::vector<KinkSurface> surfaces) : surfaces_(std::move(surfaces)) {}
  std::span<const KinkSurface> surfaces() const { return surfaces_; }
  /// See Lagrangian::with().
  std::shared_ptr<const Kinks> with(std::span<const double> parameters) const;

 private:
  std::vector<KinkSurface> surfaces_;
};

/// abs, min, max and step.
bool has_kink(Op op);

/// Null where L is smooth. Surfaces on which only parameters decide do not count.
std::shared_ptr<const Kinks> find_kinks(const LagrangianGraph& lagrangian);

}  // namespace extremal
