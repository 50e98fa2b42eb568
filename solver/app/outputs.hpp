#pragma once

#include <functional>
#include <iosfwd>
#include <string>

/// \file Where results go: a file, or standard output for the path "-".

namespace extremal::app {

/// Why a path cannot be written; "" where nothing speaks against it. Missing folders are made when the file
/// is written, so the nearest folder that exists counts.
std::string output_refusal(const std::string& path);

/// The same for a plot, whose suffix must be one that gnuplot can draw, and gnuplot be there.
std::string plot_refusal(const std::string& path);

/// Whether one of the outputs is standard output: nothing else is printed there then. Throws OptionError if
/// both are.
bool on_standard_output(const std::string& output, const std::string& csv);

/// Lets `write` fill the file, or standard output. Throws std::runtime_error if it cannot be written.
void write_output(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace extremal::app
