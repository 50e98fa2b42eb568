#pragma once

#include <optional>

#include "action/path.hpp"
#include "solve/newton/iteration.hpp"

/// \file Newton's method with 106 bits, for paths that doubles do not hold along one direction.

namespace extremal {

/// What a step of Newton's method leaves.
struct Stepped {
  bool contracted;    ///< the next step is shorter by as much as Kantorovich asks for, or below all roundoff
  double eigenvalue;  ///< the least one of the second variation, see least_eigenvalue()
};
/// Nothing where the equations cannot be solved.
std::optional<Stepped> take_step(NewtonIteration& newton, Path& path);

/// Whether the least eigenvalue changes by as little as lets Newton's method converge.
bool same_eigenvalue(double eigenvalue, double next);

/// Where Newton's method ends on elements of a degree.
struct Resolved {
  int degree;
  double eigenvalue;
  int index;  ///< of the second variation with 106 bits
};
/// Moves the path there, which the iteration is bound to. Nothing if it does not converge, or if the system
/// has no factors with 106 bits.
std::optional<Resolved> resolve(NewtonIteration& newton, Path& path);

/// Of q at the nodes of `path`, in time: steps with 106 bits move the nodes of the other.
double largest_change(const Path& path, const Path& finer);

}  // namespace extremal
