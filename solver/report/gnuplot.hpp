#pragma once

#include <string>

#include "report/figure.hpp"

/// \file Figures through gnuplot.

namespace extremal {

enum class Format { svg, png, pdf };

/// The commands that draw a figure onto standard output. Every text is a quoted literal in which gnuplot
/// substitutes nothing.
std::string gnuplot_script(const Figure& figure, Format format);

/// Throws std::runtime_error unless gnuplot is on the PATH: to be called before the work that is plotted.
void require_gnuplot();

/// Bytes of the drawn file. gnuplot runs without a shell and without start-up files; what it reads and writes
/// are files in memory without a name, so that an interrupt leaves nothing behind. Throws std::runtime_error
/// if it is missing or fails.
std::string draw(const Figure& figure, Format format);

}  // namespace extremal
