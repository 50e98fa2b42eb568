#pragma once

#include <span>
#include <string>

#include "system/formula_names.hpp"

/// \file How messages spell names, and what they say of names that do not exist.

namespace extremal::formula {

/// "x", of an array "x[1]".
std::string spelled(const std::string& name, bool array);

/// "p_x", of an array "p_x[1]".
std::string momentum_of(const std::string& coordinate, bool array);

/// What may be meant by a name, or by the name of a function, that a formula of this kind does not know:
/// "; did you mean 'mu'?". `indices` are those that are known there.
std::string mend_of_unknown(const std::string& name, bool call, const Names& names, Kind kind,
                            std::span<const std::string> indices);

}  // namespace extremal::formula
