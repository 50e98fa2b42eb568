#pragma once

#include <pybind11/pybind11.h>

/// \file Solutions as files and texts, as the command writes them: Python has no copies of them.

namespace extremal::python {

void bind_files(pybind11::module_& module);

}  // namespace extremal::python
