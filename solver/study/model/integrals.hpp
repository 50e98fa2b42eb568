#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "system/formula.hpp"

/// \file Integrals along the path that a scene gives, "g = c". Where c is made of unknowns, what is given is
/// that of g − c/T, zero.

namespace extremal {

/// What is given: c, a finite number, or 0.
double value_of_integral(const Text& text, const Scene& scene, const System& system);

/// Throws SceneError at the place in an integrand that is no Lagrangian.
void check_integrands(const Scene& scene);

/// L + Σ ν g with ν as the texts given.
Text law_with(const Scene& scene, const std::vector<std::string>& multipliers);
/// The same for numbers; L alone where there are none.
Text law_at(const Scene& scene, const std::vector<double>& multipliers);

}  // namespace extremal
