#pragma once

#include <pybind11/pybind11.h>

/// \file Branches of extremals, as Python reads them.

namespace extremal::python {

void bind_branch(pybind11::module_& module);

}  // namespace extremal::python
