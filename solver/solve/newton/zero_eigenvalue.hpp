#pragma once

#include "action/path.hpp"
#include "linear/border.hpp"

/// \file Which eigenvalues of a second variation count as zero. Those of a family of extremals are zero but
/// for the error of the elements, of either sign; those of a soft direction are small and not zero.

namespace extremal {

/// Relative to the largest eigenvalue. Unless more is known smaller ones are zero: elimination keeps half of
/// the digits then (Border::deflated_below).
inline constexpr double zero_eigenvalue = Border::deflated_below;

/// For the nullity along a path of extent `size` known to `error`: eigenvalues so small, relative to those of
/// one element, or smaller count as zero. An error of the path changes them by about as much, relative, and
/// the Schur complement of the ends by the number of elements less.
double zero_eigenvalue_along(double size, double error, int elements);

/// The same for a path next to which there are others of its family, with all symmetries that are known held:
/// whatever is no error of the path, nor roundoff, is not zero. The index changes where it is.
double null_eigenvalue_of_branch(double size, double error, const Path& path);

/// For steps along a path of largest |q| `magnitude` known to `error`: larger eigenvalues, relative to the
/// largest, are neither an error of the elements nor roundoff of elimination, so that their directions are
/// soft, not null.
double largest_null_eigenvalue(double magnitude, double error, const Path& path);

/// A path moved by this part of its size, with a duration longer by as much: where a second variation is
/// singular to the last digit, that beside the path is not. Where L is quadratic the duration alone tells.
Path bumped(const Path& path, double by, double size);

/// By how much the error of a path changes an eigenvalue, relative to the diagonal, at most.
double doubt_of_eigenvalue(double size, double error);

}  // namespace extremal
