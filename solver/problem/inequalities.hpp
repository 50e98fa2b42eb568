#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "problem/manifold.hpp"
#include "system/lagrangian.hpp"

/// \file Inequalities g_k(q, t) >= 0 that hold along the whole path.

namespace extremal {

/// The motion while some of the inequalities are equalities.
struct HeldSystem {
  std::shared_ptr<const Lagrangian> lagrangian;  ///< L̃; null where as many are held as there are coordinates
  std::shared_ptr<const Manifold> manifold;      ///< of those that are held
};

struct Inequalities {
  std::vector<std::string> texts;  ///< as written
  /// Of all of them as equations, for their values and derivatives alone. An inequality "left <= right" has
  /// g = right − left. Unknown constants have the values of their guesses.
  std::shared_ptr<const Manifold> all;
  /// The same for other values of the constants k and ν; for a problem that has unknowns.
  std::function<std::shared_ptr<const Manifold>(const std::vector<double>& constants)> at{};
  /// The motion by L + Σ ν g with these held, at least one and at most as many as coordinates. Throws
  /// std::invalid_argument.
  std::function<HeldSystem(const std::vector<int>& held, const std::vector<double>& constants)> hold;

  int count() const { return static_cast<int>(texts.size()); }
};

}  // namespace extremal
