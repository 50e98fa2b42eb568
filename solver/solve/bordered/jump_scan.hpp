#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "solve/bordered/found.hpp"

/// \file The jump of the energy at a waypoint as a function of its time.

namespace extremal {

/// A state that is stationary with the time of the waypoint held, and ∂S/∂t there.
struct JumpAtTime {
  double time, jump;
  Found found;
};

/// The solution at a time, from the one at another time or, without one, from the guess; nothing where there
/// is none.
using SolveAtTime = std::function<std::optional<JumpAtTime>(double time, const JumpAtTime* near)>;

/// States beside zeros of the jump between two times: at many times it is computed, and between neighbours of
/// different sign zeros are bracketed; |jump| is followed down to its minima, beside which zeros may lie in
/// pairs. A pole, as at a conjugate time, is no zero.
std::vector<JumpAtTime> zeros_of_jump(double from, double to, const SolveAtTime& solve);

}  // namespace extremal
