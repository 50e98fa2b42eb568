#pragma once

#include <iosfwd>
#include <string>

#include "study/compare.hpp"

/// \file A comparison as JSON, as a table and as a picture.

namespace extremal {

/// {"reference", "rows": [{"method", "tolerance", "seconds", "error", "status"}]}; the reference is null
/// where there is none, an error where none is known.
void write_json(std::ostream& out, const Comparison& comparison);

/// The reference in a line or two, and a table of the rows.
std::string summary(const Comparison& comparison);

/// Time against error, both logarithmic, a curve for each method. Throws as plot_image of a trajectory does.
std::string plot_image(const std::string& path, const Comparison& comparison);

}  // namespace extremal
