#pragma once

#include <qd/dd_real.h>

#include <span>
#include <vector>

#include "action/extended_basis.hpp"
#include "action/path.hpp"
#include "machine/aligned.hpp"
#include "system/lagrangian.hpp"

/// \file The gradient of S_h in twice the precision: where the solution of a linear system amplifies
/// roundoff, the factors may be rounded, what they are applied to may not (iterative refinement; Wilkinson
/// 1963). Where bodies meet at a distance r, forces r⁻² are told by differences of coordinates, and momenta
/// by those of q/h: eleven more bits do not cover that.

namespace extremal {

/// Changes of the mesh nodes, (N + 1) × n, of the inner unknowns, laid out as Path::x, and of T.
struct PathChange {
  std::span<const double> nodes;
  const AlignedDoubles& inner;
  double duration;
};

class ExtendedGradient {
 public:
  /// S_h and its derivatives, or what they change by.
  struct Values {
    std::vector<DoubleDouble> inner;      ///< by the inner unknowns, (s − 1) n an element as in element.hpp
    std::vector<DoubleDouble> nodes;      ///< (N + 1) × n: the difference of momenta, at the ends a momentum
    DoubleDouble action, slope_duration;  ///< S_h, ∂S_h/∂T
    double momentum_scale;                ///< largest end gradient of an element
  };

  /// At a path, element by element. False where the Lagrangian or the quadrature (other than Lobatto's at the
  /// nodes, and Gauss's) cannot.
  bool evaluate(const Lagrangian& lagrangian, const ElementTables& tables, const Path& path);
  const Values& values() const { return values_; }

  /// The second variation at the path evaluated last, along a change of it: the difference that a small part
  /// of it makes, relative to that part.
  void evaluate_change(const Lagrangian& lagrangian, const Path& path, const PathChange& change);
  const Values& change() const { return change_; }

 private:
  struct Element;
  static void evaluate(Element& element, Values& values);

  ExtendedBasis basis_;
  Values values_, change_;
};

}  // namespace extremal
