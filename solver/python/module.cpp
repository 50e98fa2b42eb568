#include <pybind11/pybind11.h>

#include "python/branch.hpp"
#include "python/files.hpp"
#include "python/solution.hpp"
#include "python/study.hpp"
#include "report/file.hpp"
#include "report/interrupts.hpp"
#include "scene/scene.hpp"
#include "scene/schema.hpp"
#include "study/suggestion.hpp"

/// \file The module extremal._core: what the package in extremal/ is written on.

namespace extremal::python {
namespace {

/// The line of a text that an error points to.
std::string line_of(const Location& at) {
  if (!at.source || at.line < 1 || !at.source->numbered) return "";
  std::string_view text = at.source->text;
  for (int line = 1; line < at.line; ++line) {
    const auto end = text.find('\n');
    if (end == text.npos) return "";
    text.remove_prefix(end + 1);
  }
  return std::string(text.substr(0, text.find_first_of("\r\n")));
}

void raise_scene_error(const SceneError& e) {
  const std::string whole = e.what(), place = to_string(e.at) + ": ";
  const std::string message = whole.starts_with(place) ? whole.substr(place.size()) : whole;
  const py::object type = py::module_::import("extremal._errors").attr("SceneError");
  const std::string file = e.at.source ? e.at.source->name : "";
  const py::object error = type(whole, message, file, e.at.line, e.at.column, line_of(e.at));
  PyErr_SetObject(type.ptr(), error.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const SceneError& e) {
    raise_scene_error(e);
  } catch (const Interrupted&) {
    if (PyErr_CheckSignals() == 0) PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

/// (table, key, whether it is a table) of each key of a scene that this version has.
py::list keys() {
  py::list list;
  for (const KeyRecord& record : key_records())
    if (record.table != "system file")
      list.append(py::make_tuple(record.table, record.key, record.kind == Kind::table));
  return list;
}

std::string read_text(const std::string& path) {
  return with_suggestion([&] { return scene_source(path)->text; });
}

void write_text(const std::string& path, const py::bytes& content) { write_files({{path, content}}); }

}  // namespace
}  // namespace extremal::python

PYBIND11_MODULE(_core, module) {
  using namespace extremal::python;
  py::register_exception_translator(translate);
  module.attr("__version__") = EXTREMAL_VERSION;
  bind_solution(module);
  bind_branch(module);
  bind_study(module);
  bind_files(module);
  module.def("keys", keys);
  module.def("read_text", read_text);
  module.def("write", write_text, py::arg("path"), py::arg("content"));
}
