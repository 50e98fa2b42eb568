#pragma once

#include "rivals/shooting.hpp"
#include "solve/laws.hpp"

/// \file Boundary problems of which one extremal is known.

namespace extremal::laws {

/// The ends of the motion from a state; no guess.
inline Problem ends_of_motion(std::shared_ptr<const Lagrangian> lagrangian, const Values& q, const Values& v,
                              double duration) {
  const Flight flight = fly(*lagrangian, q, v, Values{duration});
  return fixed_ends(std::move(lagrangian), q, flight.q, duration);
}

}  // namespace extremal::laws
