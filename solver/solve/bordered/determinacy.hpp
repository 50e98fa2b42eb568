#pragma once

#include <optional>
#include <vector>

#include "problem/problem.hpp"

/// \file Whether the formulas of a problem with an extension determine its unknowns.

namespace extremal {

/// What is singular in the equations of all paths about the guess, and so whatever the path is.
///
/// Either a row of an integral, a condition r or a condition w is made of those before it: what it says
/// follows from what else is given, or contradicts it. Or a column of a constant or a multiplier is made of
/// those before it: the equations contain them in a combination alone, and no path determines more.
struct Indeterminacy {
  enum class Kind { integral, condition, where, constant };
  Kind kind;
  int last;                    ///< of its kind, the one that is made of others
  std::vector<int> constants;  ///< of a constant: those of the combination, it included
  std::vector<int> integrals;  ///< and the integrals whose multipliers are in it
};
std::optional<Indeterminacy> indeterminacy(const Problem& problem);

}  // namespace extremal
