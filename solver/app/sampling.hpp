#pragma once

#include <string>
#include <vector>

/// \file The times that samples are wanted at.

namespace extremal::app {

/// "0,0.5,2" as times. Throws OptionError with what is no time, or is negative.
std::vector<double> parse_times(const std::string& text);

/// Throws OptionError for a time beyond the duration.
void check_times(const std::vector<double>& times, double duration);

}  // namespace extremal::app
