#pragma once

#include "action/path.hpp"
#include "problem/reduction.hpp"

/// \file A whole orbit from the part that its symmetries leave to be found.

namespace extremal {

/// Fills `whole` with the images of `part`, a path of reduction.part on elements of `tables`; no digit is
/// lost.
void reconstruct_orbit(const Reduction& reduction, const Path& part, const ElementTables& tables,
                       Path& whole);

}  // namespace extremal
