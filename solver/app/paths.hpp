#pragma once

#include <string>

/// \file Where results go.

namespace extremal::app {

/// Refuses, before anything is solved, a path that cannot be written: throws OptionError with the option and
/// the reason. An empty path is none.
void check_writable(const char* option, const std::string& path);

}  // namespace extremal::app
