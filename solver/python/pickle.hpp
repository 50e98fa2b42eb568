#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "report/result.hpp"
#include "solution/solution.hpp"
#include "study/continued.hpp"

/// \file Solutions, fits and branches as tuples of Python, to the last digit.

namespace extremal::python {

pybind11::tuple packed(const Solution& solution);

/// Throws a Python exception for what packed() did not make.
Solution unpacked(const pybind11::tuple& state);

/// The same of what a fit found, or None.
pybind11::object packed(const std::shared_ptr<const Fitted>& fit);
std::shared_ptr<const Fitted> unpacked_fit(const pybind11::handle& state);

/// The same of branches.
pybind11::tuple packed(const FollowedBranch& branch);
FollowedBranch unpacked_branch(const pybind11::tuple& state);

}  // namespace extremal::python
