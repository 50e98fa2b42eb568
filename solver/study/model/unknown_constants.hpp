#pragma once

#include <set>
#include <string>
#include <vector>

#include "scene/scene.hpp"

/// \file The unknown constants of a scene, and what its formulas make of them.

namespace extremal {

/// The scene with its unknowns as parameters, which have the values of their guesses.
Scene with_unknowns(Scene scene);

/// Names of unknowns and of what is made of them.
using Dependents = std::set<std::string>;

bool any_of(const std::set<std::string>& names, const Dependents& dependents);
/// Null: the quantity is a number.
const std::string* as_formula(const Quantity& quantity);

/// The unknowns, and the parameters and definitions that are made of them.
Dependents dependents_of(const Scene& scene);
/// Those that are the same at all times: no coordinate, velocity or time is in them.
Dependents constants_of(const Scene& scene, const Dependents& dependents);

/// A condition with each of the constants as an end value, k(0): they are coordinates of the extended system.
struct Rewritten {
  std::string text;
  std::vector<std::size_t> added;  ///< where "(0)" was added, in `text`

  /// The place in the condition of one in `text`.
  std::size_t original(std::size_t offset) const;
};
Rewritten rewritten(const std::string& text, const Dependents& constants);

}  // namespace extremal
