#include "python/branch.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>

#include "python/arrays.hpp"
#include "python/pickle.hpp"
#include "python/study.hpp"
#include "report/branch.hpp"
#include "report/file.hpp"
#include "study/annotation.hpp"
#include "study/continued.hpp"
#include "study/quantity.hpp"

namespace extremal::python {
namespace {

/// The bytes of a picture; `quantity` is a formula, or empty.
py::bytes plot(const FollowedBranch& branch, const PyStudy& study, const std::string& path,
               const std::string& shown) {
  try {
    if (!shown.empty()) check_quantity(study.study(), shown);
  } catch (const FormulaError& e) {
    throw std::invalid_argument("quantity: " + std::string(e.what()));
  }
  std::string image;
  {
    const py::gil_scoped_release unlocked;
    image = plot_image(
        path, BranchPicture{branch, quantity(study.study(), branch, shown), annotation(study.study())});
  }
  return image;
}

/// (m, n) at the start of each point.
py::array_t<double> starts(const FollowedBranch& branch, bool velocities) {
  const std::size_t m = branch.points.size(), n = branch.names.size();
  py::array_t<double> values({m, n});
  std::vector<double> other(n);
  for (std::size_t k = 0; k < m; ++k) {
    const std::span<double> wanted(values.mutable_data() + k * n, n);
    branch.points[k].solution.trajectory.at(0, velocities ? other : wanted, velocities ? wanted : other);
  }
  return read_only(values);
}

}  // namespace

void bind_branch(py::module_& module) {
  py::class_<BranchPoint>(module, "BranchPoint", "A point of a family, as progress is called with it.")
      .def_readonly("branch", &BranchPoint::branch, "Number of its branch; 0 is the one asked for.")
      .def_readonly("parameter", &BranchPoint::parameter, "Value of what varies.")
      .def_property_readonly(
          "kind", [](const BranchPoint& p) { return name(p.kind); },
          "Either \"regular\", \"fold\", \"branch\" or \"period-doubling\".")
      .def_property_readonly(
          "duration", [](const BranchPoint& p) { return p.solution.duration(); }, "T.")
      .def_property_readonly(
          "energy", [](const BranchPoint& p) { return p.solution.energy; },
          "Energy; None where L depends on t.")
      .def_property_readonly(
          "action", [](const BranchPoint& p) { return p.solution.action; }, "Action.")
      .def("__repr__", [](const BranchPoint& p) {
        return fmt::format("<BranchPoint of branch {}: parameter {:.10g}, {}>", p.branch, p.parameter,
                           name(p.kind));
      });

  py::class_<FollowedBranch, std::shared_ptr<FollowedBranch>>(module, "FollowedBranch")
      .def_readonly("parameter", &FollowedBranch::parameter)
      .def_readonly("names", &FollowedBranch::names)
      .def("__len__", [](const FollowedBranch& b) { return b.points.size(); })
      .def("q", [](const FollowedBranch& b) { return starts(b, false); })
      .def("v", [](const FollowedBranch& b) { return starts(b, true); })
      .def("json",
           [](const FollowedBranch& b) { return text_of([&](std::ostream& out) { write_json(out, b); }); })
      .def("csv",
           [](const FollowedBranch& b) { return text_of([&](std::ostream& out) { write_csv(out, b); }); })
      .def("summary", [](const FollowedBranch& b) { return summary(b); })
      .def("plot", plot, py::arg("study"), py::arg("path"), py::arg("quantity"))
      .def("state", [](const FollowedBranch& b) { return packed(b); })
      .def("solved", [](const FollowedBranch& b, std::size_t k, const PyStudy& study) {
        return solved_by(study.shared(), b.points.at(k).solution);
      });
  module.def("restored_branch", unpacked_branch, py::arg("state"));
}

}  // namespace extremal::python
