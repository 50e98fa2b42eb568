#pragma once

#include <string>
#include <vector>

#include "study/study.hpp"

/// \file Lines of a label and a text, as `check` and `list` print them.

namespace extremal::app {

void line(const std::string& label, const std::string& text);

/// The label beside the first of the texts, which are below each other.
void lines(const std::string& label, const std::vector<std::string>& texts);

/// "mu = 1", "m = [1, 2]"; of a long list the first values and their number.
std::string parameter_text(const std::string& name, const std::vector<std::string>& values, bool list);

/// The same of values as a scene or a system file writes them.
std::string assignment_text(const Assignment& assignment);

}  // namespace extremal::app
