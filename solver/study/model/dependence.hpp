#pragma once

#include <set>
#include <string>
#include <vector>

#include "scene/scene.hpp"

/// \file What of a scene depends on which names.

namespace extremal {

/// Whether any of these names stands in a formula.
bool names_any(const std::string& formula, const std::set<std::string>& names);
bool names_any(const Quantity& quantity, const std::set<std::string>& names);
bool names_any(const std::vector<Assignment>& assignments, const std::set<std::string>& names);

/// The names, and those of all parameters and definitions that depend on them through formulas.
std::set<std::string> with_dependent(std::set<std::string> names, const SystemTable& table);

}  // namespace extremal
