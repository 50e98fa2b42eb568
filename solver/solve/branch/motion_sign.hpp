#pragma once

#include "solve/newton/iteration.hpp"

/// \file Branches of motions with forces.

namespace extremal {

/// The sign of the determinant of the linearised equations of motion, of one copy, of a problem of two that
/// were evaluated last at the path: with the boundary relation, the equation that closes a free duration and
/// the conditions of symmetries. The determinant of both copies together is its square but for the sign, and
/// their inertia is balanced: neither tells of branch points. 0 where it is not known.
int motion_sign(const Problem& problem, const DiscreteAction& action, const ElementTables& tables,
                const Path& path, const ClosingEquation* closing);

}  // namespace extremal
