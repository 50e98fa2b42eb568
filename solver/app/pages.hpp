#pragma once

#include "app/records.hpp"

/// \file Pages made from the record of the program: completion scripts of shells and the manual.

namespace extremal::app {

/// Commands, options, *.toml for scenes, names of systems.
std::string bash_completion(const ProgramRecord& program);
std::string zsh_completion(const ProgramRecord& program);

/// extremal(1) in roff.
std::string manual_page(const ProgramRecord& program);

}  // namespace extremal::app
