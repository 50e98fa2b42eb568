#include <algorithm>
#include <cmath>

#include "solve/branch/branch.hpp"
#include "solve/branch/motion_sign.hpp"

/// \file Index and orientation of a branch, by the inertia of second variations.

namespace extremal {

/// Where the duration hardly changes along the extremals of all durations, as that of isochronous orbits, the
/// second variation with T held is nearly singular, and that by T as well is not.
bool Branch::ordered_by_energy() const { return std::abs(free_.energy) > std::abs(free_.duration); }

const Inertia& Branch::inertia_with_duration() const {
  if (!with_duration_)
    with_duration_ = w_.iteration.model().inertia(errors_.null, VariedBy::path_and_duration);
  return *with_duration_;
}

/// With K the second variation, T held, and B that by T as well, det K = (B⁻¹)_TT det B, and (B⁻¹)_TT is
/// −∂T/∂E: where it is zero, K has a null direction.
const Inertia& Branch::inertia() const {
  if (problem_.paired) inertia_ = Inertia{};
  if (inertia_) return *inertia_;
  if (!ordered_by_energy()) return inertia_.emplace(w_.iteration.model().inertia(errors_.null));
  Inertia found = inertia_with_duration();
  const double by_energy = free_.duration / free_.energy;
  if (std::abs(free_.duration) <= std::max(errors_.path, zero_eigenvalue)) {
    --found.negative;
    --found.positive;
    ++found.zero;
  } else {
    --(by_energy > 0 ? found.negative : found.positive);
  }
  return inertia_.emplace(found);
}

int Branch::orientation(double onward) const {
  if (problem_.paired) {
    ClosingEquation equation;
    const int sign = motion_sign(problem_, w_.iteration.action(), *tables_, path_,
                                 closing_equation(problem_, path_, equation));
    return sign == 0 || (sign < 0) == (onward * direction.parameter < 0) ? 1 : -1;
  }
  // det (K b; r 0) is det K ∂T/∂r, and det B −∂E/∂r, r the row that closes the duration.
  const bool by_energy = ordered_by_energy();
  const int count = by_energy ? inertia_with_duration().negative : inertia().negative;
  const double closing = by_energy ? -free_.energy : free_.duration;
  const double along = by_duration() ? 1 : direction.parameter;
  return (count % 2 != 0) != (onward * along * closing < 0) ? -1 : 1;
}

}  // namespace extremal
