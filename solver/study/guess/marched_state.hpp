#pragma once

#include <optional>
#include <span>

#include "machine/deadline.hpp"
#include "problem/problem.hpp"

/// \file Motions across kinks of L, as guesses.

namespace extremal {

/// The motion of a problem from (q, q') at t = 0 over its duration, by elements that end at the kinks of L:
/// the steps of an integrator shrink there to roundoff, and where a kink is crossed slowly they end before
/// it. Nothing where L has no kinks, or where the motion cannot be followed.
std::optional<Guess> motion_across_kinks(const Problem& problem, std::span<const double> q,
                                         std::span<const double> v, const Deadline& deadline);

}  // namespace extremal
