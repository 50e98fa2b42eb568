#pragma once

#include <pybind11/pybind11.h>

/// \file Solutions, as Python reads them.

namespace extremal::python {

void bind_solution(pybind11::module_& module);

}  // namespace extremal::python
