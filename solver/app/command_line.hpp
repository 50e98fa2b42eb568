#pragma once

/// \file The command line.

namespace extremal::app {

/// Reads the arguments and runs the command that they name. Returns the exit code; throws where the command
/// line or the scene is refused.
int run(int argc, char** argv);

}  // namespace extremal::app
