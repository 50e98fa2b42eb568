#pragma once

#include <string>

/// \file Other programs, started through the shell.

namespace bench {

/// A word that the shell takes as it is.
std::string quoted(const std::string& word);

/// The standard output of a command; `exit` is its exit status, -1 where it cannot be started.
std::string output_of(const std::string& command, int& exit);

}  // namespace bench
