#pragma once

#include "solve/adapt/workspace.hpp"

/// \file A path on elements of a higher degree, which tell what its own elements leave out.

namespace extremal {

/// `path`, whose elements are those of `tables`, on elements of a degree higher by `raised` where there are
/// such: in memory of the workspace, whose iteration is bound to them.
Path& on_finer_elements(const Problem& problem, const Path& path, const ElementTables& tables, int raised,
                        Workspace& workspace);

}  // namespace extremal
