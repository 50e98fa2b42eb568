#pragma once

#include "problem/problem.hpp"

/// \file Problems with forces as problems of two copies of the coordinates, see system/copies.hpp.

namespace extremal {

/// The problem of both copies: each satisfies the boundary relation, and natural conditions, momenta that are
/// given and closed paths agree for both. A free period is closed by the energy of the two copies, zero: it
/// is zero wherever they agree, and its derivative by the period is the missing equation of the adjoint
/// fields, so that steps of Newton's method change the period but not the difference of the copies. Its
/// boundary relation is solved; it is not checked, see make_problem().
Problem pair_of(const Problem& problem);

/// The guess of one copy, of n coordinates, for both.
Guess guess_of_both(const Guess& one, std::size_t n);

/// Symmetries of a problem of two copies, of one copy at a time. What moves both alike is a null direction of
/// the linearised equations; a force along it closes these, and that is a direction of the other copy.
std::vector<Generator> symmetries_of_copies(const std::vector<Generator>& found);

}  // namespace extremal
