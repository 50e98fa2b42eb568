#pragma once

#include <span>
#include <string>
#include <vector>

namespace extremal {

/// "x = 1, y = 2" with that many digits; of many coordinates the first. Those without a name are q[1], q[2].
std::string point_text(const std::vector<std::string>& names, std::span<const double> q, int digits = 6);

}  // namespace extremal
