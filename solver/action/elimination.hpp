#pragma once

#include "machine/simd.hpp"

/// \file Elimination of the inner unknowns of a batch of elements, a lane each. Plain data only, because the
/// same header serves the kernels of every instruction set.
///
/// The multifrontal LDLᵀ (Duff and Reid, ACM TOMS 9 (1983) 302) with an order that is known beforehand and
/// without pivoting. A front eliminates the inner unknowns of some coordinates, its pivots. Its panel holds
/// their columns of the matrix: y_ij = L_ij d_j in the rows of the pivots and of what they are coupled with.
/// What elimination takes from the other entries goes straight to the panels of later fronts, or to the
/// matrix of the ends.

namespace extremal {

/// Part of the rows below the pivots as columns: those that are pivots of one later front, or those of the
/// ends. All places are numbers of groups.
struct FrontTarget {
  int begin, end;     ///< of the front's rows
  const int* row;     ///< where row `begin`, begin + 1, … goes; up to the front's last, and two for vectors
  const int* column;  ///< and column `begin` … end − 1; the two add up
};

struct FrontView {
  int pivots, rows;    ///< rows in all, the pivots first
  int panel;           ///< place of the panel: rows + 2 rows of `pivots` columns, the last two for vectors
  int first;           ///< pivots of the fronts before
  const int* unknown;  ///< local number of each row
  const int* start;    ///< least of the first columns that may differ from zero in rows i … i + 3; rows + 2
  int targets;
  const FrontTarget* target;
};

struct Elimination {
  /// Zeros what counts of `matrix` (fronts.hpp), whose ends start at place `ends`.
  void (*clear)(const FrontView* fronts, int front_count, double* matrix, int ends, int end_count);
  /// Eliminates the inner unknowns of `matrix` (fronts.hpp), whose ends start at place `ends`, and at the
  /// same time of `vectors`: the gradient and, where count is 2, the border, one after the other. In these,
  /// inner entries become y_gj, those of the ends become reduced. `inverse` receives 1/d_j; `negative` the
  /// number of negative pivots; `ratio` the least |d_j| against the diagonal entry it came from. `work` has
  /// room for twice the most pivots.
  void (*condense)(const FrontView* fronts, int front_count, double* matrix, int ends, int end_count,
                   double* vectors, int count, double* inverse, double* negative, double* ratio,
                   double* work);
  /// The gradient alone, with a factor from before.
  void (*reduce)(const FrontView* fronts, int front_count, const double* matrix, const double* inverse,
                 double* gradient, double* work);
  /// Inner steps from the steps of the ends (2n, q_a then q_b) and of the border (or null):
  /// x_j = −(y_gj + y_hj·δh + Σ_{i>j} y_ij x_i)/d_j. x has m entries, the last 2n given.
  void (*expand_step)(const FrontView* fronts, int front_count, const double* matrix, const double* inverse,
                      const double* gradient, const double* border, const double* step_h, double* x);
  /// Entry lane of group c goes to to[lane][c], added to what is there or in its place, for c < count and the
  /// first `used` lanes.
  void (*scatter)(const double* groups, int count, int used, bool add, double* const* to);
};

EXTREMAL_DECLARE_AT_EACH_LEVEL(Elimination elimination_kernels())

/// Those of the level in use.
const Elimination& elimination();

}  // namespace extremal
