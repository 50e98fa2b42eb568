#pragma once

#include <optional>
#include <stdexcept>

#include "system/expression_matrix.hpp"

namespace extremal::expression_matrix {

struct Singular : std::invalid_argument {
  Singular() : std::invalid_argument("the matrix is singular at every point") {}
};

/// a⁻¹ of a symmetric matrix, regular wherever a is. Nothing where it has no expression of reasonable size:
/// it is large and not of numbers, or elimination finds no pivot on the diagonal. Throws Singular where the
/// determinant vanishes identically.
std::optional<Matrix> inverse(Algebra& algebra, const Matrix& a);

}  // namespace extremal::expression_matrix
