#pragma once

#include <string>

#include "report/branch.hpp"
#include "report/comparison.hpp"
#include "report/plot.hpp"

/// \file Interactive pages: one HTML file that needs nothing else, with the motion, the curves and the
/// numbers. A page holds what write_json() writes of its subject, without samples, and beside it the samples
/// that its curves and its motion are drawn from, fewer where they are many.

namespace extremal {

/// Whether a path ends in .html.
bool is_page(const std::string& path);

/// Throws std::invalid_argument, with the reason, where the program was built without pages.
void require_pages();

/// The page of a converged result, with those of a search, a spectrum and a fit. `picture` holds what is to
/// be drawn: picture_of(). Throws as plot_image() does, and std::invalid_argument without pages.
std::string page(const Result& result, const Picture& picture);

/// The page of a branch: its diagram and the orbit of each point. Throws likewise.
std::string page(const BranchPicture& picture);

/// The page of a comparison. Throws likewise.
std::string page(const Comparison& comparison);

/// The page of a file that write_json() has written: of a result with samples, of a branch or a comparison.
/// `name` is that of the file. Throws std::invalid_argument, with what to do, for any other text.
std::string saved_page(const std::string& text, const std::string& name);

}  // namespace extremal
