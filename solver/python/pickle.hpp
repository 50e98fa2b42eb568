#pragma once

#include <pybind11/pybind11.h>

#include "solution/solution.hpp"

/// \file A solution as a tuple of Python, to the last digit.

namespace extremal::python {

pybind11::tuple packed(const Solution& solution);

/// Throws a Python exception for what packed() did not make.
Solution unpacked(const pybind11::tuple& state);

}  // namespace extremal::python
