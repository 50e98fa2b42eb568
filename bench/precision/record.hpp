#pragma once

#include <string>
#include <vector>

#include "machine.hpp"
#include "records.hpp"

/// \file Everything that was measured, as JSON.

namespace bench {

/// Throws std::runtime_error if the file cannot be written.
void write_record(const std::string& path, const Machine& machine, const std::vector<SceneRecord>& scenes);

}  // namespace bench
