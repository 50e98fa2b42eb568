#pragma once

#include <Eigen/Dense>
#include <optional>

#include "analysis/variation.hpp"
#include "solution/floquet.hpp"
#include "system/phase_space.hpp"

/// \file Floquet multipliers of a periodic orbit from its second variation.

namespace extremal {

/// Beyond this many coordinates they are not computed.
constexpr int most_coordinates_for_multipliers = 128;

/// An orbit that closes by q(T) = R q(0) + c.
struct ClosedOrbit {
  Eigen::MatrixXd map;        ///< R, n × n; empty for the identity
  double relative_error = 0;  ///< of its coordinates: the linearised flow is as uncertain, and λ + 1/λ
  bool autonomous = false;    ///< L does not depend on t
  int symmetries = 0;         ///< continuous ones of L and of the relation that move it, and not along itself
};

/// Large multipliers and small ones are as good, relative, as those of moderate size are. Nothing if one
/// overflows, or where the error of the orbit hides its shift in time, as next to a homoclinic orbit.
std::optional<Floquet> floquet(const SecondVariation& variation, const ClosedOrbit& orbit);

/// The same of a system with forces, by the second variation of two copies of its coordinates; `orbit` is of
/// both. Each multiplier is as good, relative, as the flow along the orbit.
std::optional<Floquet> floquet_with_forces(const SecondVariation& variation, const ClosedOrbit& orbit);

/// The same in phase space, by the second variation of the Lagrangian of system/phase_space.hpp in the
/// coordinates (q, p): those of the flow in (q, p) alone.
std::optional<Floquet> floquet_in_phase_space(const SecondVariation& variation, const ClosedOrbit& orbit,
                                              const PhaseWeights& weights);

/// Largest modulus first; those of equal moduli by |argument|, the positive one first.
void sort_multipliers(Floquet& floquet);

/// With forces Π (1 + λ)/(1 + |λ|), which changes its sign where one multiplier passes −1. Without,
/// asinh(μ/2) + asinh 1 with μ = λ + 1/λ for every pair on the unit circle or real; ascending. One changes
/// its sign where its pair passes −1. It is a smooth function of the orbit, and grows like log |λ|. Pairs at
/// 1 are left out.
std::vector<double> doubling_tests(const Floquet& floquet);

}  // namespace extremal
