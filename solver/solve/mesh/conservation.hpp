#pragma once

#include "solution/observe.hpp"
#include "solve/mesh/resolution.hpp"

/// \file A close passage, a kink or a layer between the points of the elements shows as drift of the energy:
/// errors δq and δp change it by no more than |q'|·δp + |∂L/∂q|·δq.

namespace extremal {

/// Error allowed of p, in tolerances of its range: by contract.
inline constexpr double momentum_tolerances = 10;

/// Whether the drift is no more than a tolerance explains, relative to the ranges of q and, ten times, p.
bool conserves_energy(const Survey& survey, const Trajectory& trajectory, double tolerance);

/// Whether the truncation error of q and q' explains the drift.
bool conserves_energy(const Survey& survey, const Trajectory& trajectory, const Resolution::Error& left_out);

/// The error of q, in its units, with a drift that the smooth error `estimate` does not explain: slopes at
/// the ends of an element of degree s and length h amplify that by s(s + 1)/h. A kink makes slopes wrong over
/// h.
double error_behind_drift(const Survey& survey, const Trajectory& trajectory, double estimate);

}  // namespace extremal
