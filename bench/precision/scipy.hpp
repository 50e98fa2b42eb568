#pragma once

#include <string>
#include <vector>

#include "records.hpp"

/// \file scipy.integrate.solve_bvp, run beside by bench/precision/scipy_peer.py.

namespace bench {

/// Fills `scipy` of the scenes that the script has equations for. Returns why nothing was run, or nothing.
std::string measure_scipy(const std::string& python, const std::string& script, const std::string& data,
                          std::vector<SceneRecord>& scenes);

}  // namespace bench
