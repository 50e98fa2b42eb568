#include "python/study.hpp"

#include <fmt/format.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <stdexcept>
#include <utility>

#include "problem/extension.hpp"
#include "problem/inequalities.hpp"
#include "python/run.hpp"
#include "report/fitted.hpp"
#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"
#include "study/continued.hpp"
#include "study/fitting.hpp"
#include "study/phase.hpp"

namespace extremal::python {

Solver Solvers::take() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return Solver();
  Solver solver = std::move(waiting_.back());
  waiting_.pop_back();
  return solver;
}

void Solvers::give_back(Solver solver) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(solver));
}

std::shared_ptr<Solved> solved_by(std::shared_ptr<const Study> study, Solution solution,
                                  std::shared_ptr<const Fitted> fit) {
  if (fit) {
    Study own = *study;
    use_fitted(fit->values, own);
    study = std::make_shared<const Study>(std::move(own));
  }
  if (solution.extension) {
    ExtensionValues values = *solution.extension;
    if (!values.lagrangian) {
      const std::vector<double> constants = values.constants();
      values.lagrangian = study->problem.extension->at(constants);
      if (study->problem.extension->manifold_at)
        values.manifold = study->problem.extension->manifold_at(constants);
      solution.extension = std::make_shared<const ExtensionValues>(std::move(values));
    }
    Study own = *study;
    use_constants(solution, own);
    study = std::make_shared<const Study>(std::move(own));
  }
  if (solution.contacts && study->problem.inequalities) {
    PathContacts contacts = *solution.contacts;
    const std::vector<double> constants =
        solution.extension ? solution.extension->constants() : std::vector<double>();
    for (PathContacts::Arc& arc : contacts.arcs)
      if (!arc.held.empty() && !arc.manifold)
        arc.manifold = study->problem.inequalities->hold(arc.held, constants).manifold;
    solution.contacts = std::make_shared<const PathContacts>(std::move(contacts));
  }
  return std::make_shared<Solved>(Solved{std::move(study), std::move(solution), std::move(fit)});
}

namespace {

/// Of one call.
SolveOptions options_of(const Study& study, Interruptible& work, std::optional<double> tolerance,
                        const py::object& progress) {
  SolveOptions options = study.options;
  options.deadline = work.deadline(study.budget);
  options.progress = work.callback<Iteration>(progress);
  if (tolerance) options.tolerance = *tolerance;
  return options;
}

}  // namespace

PyStudy::PyStudy(const std::string& text, const std::string& name, bool family)
    : solvers_(std::make_shared<Solvers>()) {
  const py::gil_scoped_release unlocked;
  study_ = std::make_shared<const Study>(
      load(text_source(name, text), {}, family ? Purpose::family : Purpose::solution));
}

std::shared_ptr<Solved> PyStudy::fit(std::optional<double> tolerance, const py::object& progress) const {
  Interruptible work;
  Study study = *study_;
  study.options = options_of(*study_, work, tolerance, py::none());
  const auto callback = work.callback<FitStep>(progress);
  return work.run([&] {
    FitResult found = run_fit(study, 1, callback);
    const bool converged = found.solution.converged();
    auto fitted = converged ? std::make_shared<const Fitted>(fitted_of(*study.fit, found)) : nullptr;
    return solved_by(study_, std::move(found.solution), std::move(fitted));
  });
}

std::shared_ptr<Solved> PyStudy::solve(std::optional<double> tolerance, const py::object& progress) const {
  if (study_->fit) return fit(tolerance, progress);
  Interruptible work;
  const SolveOptions options = options_of(*study_, work, tolerance, progress);
  return work.run([&] {
    Solver solver = solvers_->take();
    auto solved = solved_by(study_, solver.solve(study_->problem, options));
    solvers_->give_back(std::move(solver));
    return solved;
  });
}

std::vector<std::shared_ptr<Solved>> PyStudy::search(int most, std::optional<double> tolerance,
                                                     const py::object& progress) const {
  Interruptible work;
  const SolveOptions options = options_of(*study_, work, tolerance, progress);
  return work.run([&] {
    Solver solver = solvers_->take();
    std::vector<std::shared_ptr<Solved>> found;
    for (Solution& solution : solver.solve_all(study_->problem, options, most))
      found.push_back(solved_by(study_, std::move(solution)));
    solvers_->give_back(std::move(solver));
    return found;
  });
}

std::shared_ptr<FollowedBranch> PyStudy::follow(const py::object& progress) const {
  Interruptible work;
  Study study = *study_;
  study.options.deadline = work.deadline(study.budget);
  const auto callback = work.callback<BranchPoint>(progress);
  return work.run([&] { return std::make_shared<FollowedBranch>(extremal::follow(study, callback)); });
}

void bind_study(py::module_& module) {
  py::list statuses;
  for (int k = 0; k <= static_cast<int>(Status::iteration_limit); ++k) statuses.append(name(Status{k}));
  module.attr("STATUSES") = statuses;

  py::class_<FitStep>(module, "FitStep", "A step of a fit, as progress is called with it.")
      .def_readonly("iteration", &FitStep::iteration, "Its number.")
      .def_readonly("elements", &FitStep::elements, "Number of elements.")
      .def_readonly("degree", &FitStep::degree, "Degree of the elements.")
      .def_readonly("chi_squared", &FitStep::chi_squared, "The sum that is made least.")
      .def("__repr__", [](const FitStep& f) {
        return fmt::format("<FitStep {}: {} elements of degree {}, chi squared {:.6g}>", f.iteration,
                           f.elements, f.degree, f.chi_squared);
      });
  py::class_<Iteration>(module, "Iteration", "A step of Newton's method, as progress is called with it.")
      .def_readonly("elements", &Iteration::elements, "Number of elements.")
      .def_readonly("degree", &Iteration::degree, "Degree of the elements.")
      .def_readonly("residual", &Iteration::residual,
                    "Largest component of the discrete equations, divided by the largest momentum.")
      .def_readonly("step", &Iteration::step, "Largest change of q.")
      .def_readonly("damping", &Iteration::damping, "The part of the step that was taken, in (0, 1].")
      .def("__repr__", [](const Iteration& i) {
        return fmt::format(
            "<Iteration: {} elements of degree {}, residual {:.1e}, step {:.1e}, damping {:.3g}>", i.elements,
            i.degree, i.residual, i.step, i.damping);
      });

  py::class_<PyStudy>(module, "Study")
      .def(py::init<const std::string&, const std::string&, bool>(), py::arg("text"), py::arg("name"),
           py::arg("family") = false)
      .def_property_readonly("title", [](const PyStudy& s) { return s.study().title; })
      .def_property_readonly("names", [](const PyStudy& s) { return coordinate_names(s.study().problem); })
      .def_property_readonly("coordinates",
                             [](const PyStudy& s) {
                               py::list list;
                               for (const Coordinate& c : s.study().system.coordinates)
                                 list.append(py::make_tuple(c.name, c.first, c.count, c.array));
                               return list;
                             })
      .def_property_readonly("solutions", [](const PyStudy& s) { return s.study().solutions; })
      .def_property_readonly("adaptive", [](const PyStudy& s) { return s.study().options.elements == 0; })
      .def_property_readonly("initial",
                             [](const PyStudy& s) { return s.study().problem.initial.has_value(); })
      .def("solve", &PyStudy::solve, py::arg("tolerance") = py::none(), py::arg("progress") = py::none())
      .def("search", &PyStudy::search, py::arg("most"), py::arg("tolerance") = py::none(),
           py::arg("progress") = py::none())
      .def("follow", &PyStudy::follow, py::arg("progress") = py::none())
      .def("solve_many", &PyStudy::solve_many, py::arg("start"), py::arg("end"), py::arg("duration"),
           py::arg("tolerance"), py::arg("threads"));
}

}  // namespace extremal::python
