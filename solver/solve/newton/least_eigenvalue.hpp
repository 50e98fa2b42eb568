#pragma once

#include <optional>

#include "solve/newton/iteration.hpp"

/// \file How soft the second variation is along its softest direction.

namespace extremal {

/// The least eigenvalue κ of K v = κ D v on the nodes between elements, with K the second variation and D the
/// size of its diagonal, where the iteration last factored, `path`. By one step of inverse iteration: good
/// where κ is much less than the others. Nothing if the nodes are not condensed.
///
/// Pivots do not show κ: of what rests hold in time, each part is held by its ends.
std::optional<double> least_eigenvalue(NewtonIteration& newton, const Path& path);
/// The same with its direction. Of several that are as soft, another for each number `draw`.
std::optional<double> least_eigenvalue(NewtonIteration& newton, const Path& path, Step& direction,
                                       unsigned draw = 1);

}  // namespace extremal
