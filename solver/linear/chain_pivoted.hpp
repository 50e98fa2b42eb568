#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "linear/inertia.hpp"

/// \file LDLᵀ of the block-tridiagonal matrix with chosen pivots, for the matrices that the kernels without
/// pivoting cannot do: a conjugate point on a node makes a pivot block singular, the matrix need not be.

namespace extremal {

/// `amount` was added to the diagonal entry `row` because what elimination had left of it was negligible.
struct Deflation {
  int row;
  double amount;
};

/// The multifrontal method on a chain (Duff and Reid, ACM TOMS 9 (1983) 302): the front holds what is left
/// of the blocks so far and the rows of the next block. A 1×1 or 2×2 pivot is taken where it bounds the
/// multipliers, |L| ≤ 1/u with u = 0.1, also in the rows of the next block; a row for which there is none is
/// delayed: it moves on into the next front, whose rows then may serve as its partners. In the last front
/// nothing is in the way, and by Bunch and Parlett's argument (SIAM J. Numer. Anal. 8 (1971) 639) there is
/// always a pivot with |L| ≤ 1/0.36. So the factorisation is backward stable and gives the inertia by
/// Sylvester's law, without shifts; a delayed row costs one row more in one front.
///
/// Rows and columns are scaled beforehand by powers of two, so that entries are at most about 1 and pivots
/// can be compared with roundoff. A column that has nothing above `smallest` left is a null direction: 1 is
/// added to its diagonal entry, which is reported, and elimination goes on: an exact factorisation of a
/// matrix that differs from A by a known diagonal matrix of low rank.
class PivotedChain {
 public:
  /// Blocks as in Chain. False if an entry is not finite, or if so many rows find no pivot that A is noise.
  bool factor(const double* diagonal, const double* lower, int blocks, int size, double smallest);

  /// X := (A + Σ amount e_row e_rowᵀ)⁻¹ X, row-major with `columns` columns.
  void solve(double* x, int columns) const;

  /// Of A; zero eigenvalues are the deflated ones.
  Inertia inertia() const { return inertia_; }
  std::span<const Deflation> deflated() const { return deflated_; }
  /// Smallest eigenvalue of a pivot, about, in the scaled matrix.
  double smallest_pivot() const { return smallest_pivot_; }

 private:
  /// Pivots `first_pivot` … of one front; row i of the front is row rows_[first_row + i] of A, eliminated
  /// rows first. Column p of L starts at l_[first_entry + p * order].
  struct Stage {
    int first_row, order, first_pivot, pivots;
    std::size_t first_entry;
  };
  struct Choice {
    int i = -1, j = -1;  ///< the same for a 1×1 pivot
    double quality = 0;  ///< 1 / bound of |L|
  };

  void extend(const double* diagonal, const double* coupling, int k, int size);
  void eliminate(int summed, double smallest);
  Choice choose(int summed, double smallest);
  double largest(int row, int i, int j) const;
  double quality(int i, int j) const;
  void swap_rows(int i, int j);
  void take_pivot(int count);
  void keep_rest(const Stage& stage);

  double& front(int i, int j) { return front_[std::size_t(i) * order_ + j]; }
  double front(int i, int j) const { return front_[std::size_t(i) * order_ + j]; }

  Inertia inertia_;
  double smallest_pivot_ = 0;
  std::vector<Deflation> deflated_;
  std::vector<double> scale_;  // powers of two
  std::vector<Stage> stages_;
  std::vector<int> rows_;
  std::vector<double> l_, pivot_, coupling_;  // D: diagonal, and the entry below it (0 for a 1×1 pivot)

  // The front: symmetric, both triangles, rows `done_` … not eliminated yet.
  int order_ = 0, done_ = 0;
  std::vector<double> front_, rest_;
  std::vector<int> front_rows_;
};

}  // namespace extremal
