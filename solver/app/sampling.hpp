#pragma once

#include <string>
#include <vector>

#include "report/result.hpp"
#include "study/study.hpp"

/// \file The times that samples are wanted at, and the samples.

namespace extremal::app {

/// "0,0.5,2" as times. Throws OptionError with what is no time, or is negative.
std::vector<double> parse_times(const std::string& text);

/// Throws OptionError for a time beyond the duration.
void check_times(const std::vector<double>& times, double duration);

/// `count` equal steps' ends, from 0 to the duration.
std::vector<double> equal_times(int count, double duration);

Samples sample(const Problem& problem, const Trajectory& trajectory, const std::vector<double>& times);

}  // namespace extremal::app
