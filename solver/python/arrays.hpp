#pragma once

#include <pybind11/complex.h>
#include <pybind11/numpy.h>

#include <complex>
#include <utility>
#include <vector>

/// \file Arrays of numpy.

namespace extremal::python {

namespace py = pybind11;

/// As functions take them: of doubles, C order; converted where they are not.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An array that cannot be written.
template <class Array>
Array read_only(Array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// A view of numbers, C order, which keeps the object that owns them alive.
template <class Number>
py::array_t<Number> view(const Number* data, std::vector<py::ssize_t> shape, const py::handle& owner) {
  return read_only(py::array_t<Number>(std::move(shape), data, owner));
}

template <class Number>
py::array_t<Number> view(const std::vector<Number>& numbers, const py::handle& owner) {
  return view(numbers.data(), {static_cast<py::ssize_t>(numbers.size())}, owner);
}

/// A copy.
inline std::vector<double> list(const Doubles& array) { return {array.data(), array.data() + array.size()}; }

}  // namespace extremal::python
