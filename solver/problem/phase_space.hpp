#pragma once

#include <memory>
#include <span>
#include <vector>

#include "problem/problem.hpp"
#include "problem/symmetry.hpp"
#include "system/phase_space.hpp"

/// \file Problems in phase space: the 2n coordinates are q and p, see system/phase_space.hpp.

namespace extremal {

/// What is kept of a problem in phase space beside its Lagrangian.
struct PhaseSpace {
  std::shared_ptr<const LagrangianGraph> formula;  ///< H(q, p, t), with momenta for velocities
  std::shared_ptr<const Lagrangian> hamiltonian;   ///< the same, to be evaluated
  /// The Lagrangian without squares, in its symmetric form where the other one is: it has all symmetries of
  /// the problem.
  std::shared_ptr<const Lagrangian> bare;
  PhaseWeights weights;
};

/// q' and p' by Hamilton's equations at (q, p), 2n entries each.
void hamilton_equations(const Lagrangian& hamiltonian, std::span<const double> state, double t,
                        std::span<double> rate, Scratch& scratch);

/// Sets the Lagrangian and the phase space of a problem whose ends, duration and guess stand. Its weights
/// follow from these, or are those of `like`. Throws std::invalid_argument.
void set_phase_space(const LagrangianGraph& hamiltonian, Problem& problem, const PhaseSpace* like = nullptr);

/// The same problem with another shift of its points, see PhaseWeights.
Problem with_shift(const Problem& problem, double shift);

/// The symmetries of a periodic problem in phase space, by its Lagrangian without squares. Those that only
/// translate, by amounts that depend on the place, are left out where translations by any amount are
/// symmetries: along motions these amounts are constant, as the centre of vorticity of vortices is.
std::vector<Generator> phase_symmetries(Problem problem, const SymmetrySearch& search = {});

}  // namespace extremal
