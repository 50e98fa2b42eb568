#pragma once

#include <string>
#include <vector>

#include "machine.hpp"
#include "records.hpp"

/// \file Everything that was measured, as JSON.

namespace bench {

/// How the times at an error are named: "1e-08".
std::string error_key(double error);

/// Throws std::runtime_error if the file cannot be written.
void write_record(const std::string& path, const Machine& machine, const std::vector<SceneRecord>& scenes);
void write_text(const std::string& path, const std::string& text);

}  // namespace bench
