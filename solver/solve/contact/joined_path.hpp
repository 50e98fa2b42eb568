#pragma once

#include "solution/solution.hpp"
#include "solve/contact/junctions.hpp"

/// \file Arcs as one solution.

namespace extremal {

/// The path of arcs that have been joined, with its contacts. There is neither index nor windows.
Solution joined_path(Arcs& arcs, const Junctions& path);

}  // namespace extremal
