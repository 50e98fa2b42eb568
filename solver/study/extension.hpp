#pragma once

#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "scene/scene.hpp"
#include "study/constraints/constraints.hpp"
#include "study/study.hpp"
#include "system/formula.hpp"

/// \file Unknown constants, integrals, nonlinear conditions and waypoints of a scene.

namespace extremal {

/// What a scene asks for beside its path, and what is left of [boundary]: a linear relation between numbers.
struct ExtendedScene {
  bool extended = false;
  BoundaryTable linear;
  std::vector<Text> conditions;  ///< nonlinear ones, and those that contain unknowns
  std::vector<Text> momenta;     ///< given by unknowns: "p·q(0) = 0" at the start, "-p·q(T) = 0" at the end
  std::vector<Text> where;
};
/// `extended`: also where the scene asks for nothing of that.
ExtendedScene split(const Scene& scene, const System& system, bool extended = false);

/// Throws SceneError where such a problem cannot be solved for this purpose or in this way.
void check_extended(const Scene& scene, Purpose purpose);

/// Whether it can, as far as the scene alone tells.
bool may_be_extended(const Scene& scene, Purpose purpose);

/// L + Σ g, with the unknowns at their guesses: what stands for L until the multipliers are known.
std::shared_ptr<const Lagrangian> extended_lagrangian(const Scene& scene);

/// The system with L + Σ ν g for values of the unknowns, then of the multipliers.
SystemTable table_at(const Scene& scene, const std::vector<double>& constants);

/// Whether an unknown changes a constraint.
bool constraints_vary(const Scene& scene);

/// Ends of a problem with constraints: whether the relation is one of ends on the manifold, and points near
/// them.
struct CompletedEnds {
  bool suited = true;
  EndPoints near{};
};

/// The extension of a problem, whose relation, duration and guess are read; a guess through the waypoints
/// where there is none. With constraints the problem has its manifold, and the guess is moved onto it; where
/// the relation is not suited to it, it becomes a part of the extension.
void read_extension(const Scene& scene, const ExtendedScene& parts, const System& system,
                    const CompletedEnds& ends, Problem& problem);

}  // namespace extremal
