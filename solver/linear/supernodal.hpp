#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "linear/front_kernels.hpp"
#include "linear/inertia.hpp"
#include "linear/sparse_pattern.hpp"
#include "linear/supernodes.hpp"
#include "machine/aligned.hpp"
#include "machine/deadline.hpp"

/// \file LDLᵀ of a sparse symmetric matrix by dense fronts.

namespace extremal {

/// The multifrontal method (Duff and Reid, ACM TOMS 9 (1983) 302) over the supernodes of an ordering that is
/// found from the pattern alone. Pivots, 1×1 and 2×2, are chosen within a supernode only (as Schenk and
/// Gärtner do, ETNA 23 (2006) 158), so that the structure stays; what that costs is monitored.
class SupernodalFactor {
 public:
  /// How far elimination has gone wrong, for a matrix with entries of at most about 1.
  struct Growth {
    double most = 0;          ///< Σ l²|d|, largest over the rows
    double cancellation = 0;  ///< (|a_ii| + Σ l²|d|)/|d_i|, largest
    Inertia inertia;
  };

  /// Ordering and layout for a pattern; false, and nothing is laid out, if the deadline passes before. Throws
  /// std::bad_alloc without memory.
  bool analyse(const SparsePattern& lower, const Deadline& deadline = {});

  /// LDLᵀ of A + shift·I, with A's values in the order of the pattern. False where a pivot is zero or not
  /// finite, or where the deadline passes before.
  bool factor(std::span<const double> value, double shift, const Deadline& deadline = {});
  const Growth& growth() const { return growth_; }

  /// x := A⁻¹ x, n entries, after factor() has returned true.
  void solve(double* x);

 private:
  struct Source {
    int entry, place;  ///< of the values; in the front's W
  };
  struct Front {
    FrontShape shape;
    int first;                          ///< position of its first pivot
    std::size_t v, rows, sources, end;  ///< where its part of each begins; end of its sources
    std::size_t below;                  ///< on the stack: where U of its first child begins
  };
  void lay_out(const SparsePattern& lower);
  void plan_stack();
  bool eliminate(const Front& front, double shift);
  void load(std::size_t front, std::span<const double> value);
  bool update(const Front& front, const Deadline& deadline);

  FrontKernels kernels_ = {};
  Supernodes nodes_;
  std::vector<Front> fronts_;
  std::vector<int> child_begin_, child_;
  std::vector<Source> sources_;
  std::vector<int> to_, run_;  // of each row below a supernode: column in its parent, end of a run of those
  std::vector<int> chosen_;    // order of the pivots within each front
  std::vector<double> diagonal_, size_, taken_;
  AlignedDoubles v_, w_, u_, stack_, columns_, work_;
  std::size_t most_u_ = 0;
  std::vector<double> x_, rest_, pivots_;
  Growth growth_;
};

}  // namespace extremal
