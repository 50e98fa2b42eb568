#pragma once

#include <pybind11/pybind11.h>

#include "python/study.hpp"
#include "report/result.hpp"

/// \file Solutions, as Python reads them.

namespace extremal::python {

/// What reports show of it, without samples.
Result result_of(const Solved& s);

void bind_solution(pybind11::module_& module);

}  // namespace extremal::python
