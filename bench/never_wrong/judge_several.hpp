#pragma once

#include <vector>

#include "study/study.hpp"
#include "verdict.hpp"

/// \file Whether several extremals, and families of them, are what they are said to be.

namespace bench {

/// Of a search: each is an extremal, none is there twice, they are sorted; between fixed ends of one
/// coordinate none is missing between the first and the last, as far as a grid of velocities shows.
std::vector<Fault> deny_search(const extremal::Study& study, const std::vector<extremal::Solution>& found);

/// Of a family: each point is an extremal at its own parameter, and what bifurcates may do so.
std::vector<Fault> deny_family(const extremal::Study& study, const extremal::FollowedBranch& branch);

}  // namespace bench
