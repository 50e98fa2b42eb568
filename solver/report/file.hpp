#pragma once

#include <functional>
#include <iosfwd>
#include <string>

/// \file Files that are written whole or not at all.

namespace extremal {

/// Makes the folders of the path, opens it, lets `write` fill it and closes it. Throws std::runtime_error
/// with the path and the system's reason if any of this fails, and passes on what `write` throws; a regular
/// file written in part is then removed.
void write_file(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace extremal
