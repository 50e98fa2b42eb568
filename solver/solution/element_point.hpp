#pragma once

#include <cstddef>

#include "action/rule.hpp"
#include "solution/solution.hpp"

/// \file The polynomial of one element.

namespace extremal {

/// q and q' of element k at the point of `basis`; coordinate a goes to q[a*stride] and v[a*stride].
void element_point(const Trajectory& trajectory, int k, const Basis::Row& basis, double* q, double* v,
                   std::ptrdiff_t stride);

}  // namespace extremal
