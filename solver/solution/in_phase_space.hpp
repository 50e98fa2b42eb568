#pragma once

#include "solution/solution.hpp"

/// \file Solutions in phase space, found with the Lagrangian of system/phase_space.hpp.

namespace extremal {

/// The largest of |q' − ∂H/∂p|, over the range of the coordinates, and |p' + ∂H/∂q|, over that of the
/// momenta, times the duration, in the mean square over Gauss's points of all elements. Zero for motions, up
/// to errors.
double phase_defect(const Problem& problem, const Trajectory& trajectory, int degree);

/// Energy and momenta as H and p tell them; what tells of the second variation is left out.
void observe_in_phase_space(const Problem& problem, Solution& solution);

/// The discrete energy −∂L_d/∂h of elements of degree one with a shift: H at their point. Empty where H
/// depends on t.
std::vector<double> shifted_energies(const Problem& problem, const Trajectory& trajectory);

/// Between two trajectories of one duration, in any coordinate, at points of the elements of the first.
double largest_difference(const Trajectory& one, const Trajectory& other);

/// Of p and of q: largest range of any, else its largest value. Neither is less than a share of the other, in
/// the units of the squares in the phase-space Lagrangian: less is roundoff of momenta that vanish.
struct PhaseRanges {
  double q = 0, p = 0;
};
PhaseRanges phase_ranges(const Problem& problem, const Trajectory& trajectory);

}  // namespace extremal
