#include "python/solution.hpp"

#include <pybind11/stl.h>

#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "action/rule.hpp"
#include "python/arrays.hpp"
#include "python/pickle.hpp"
#include "python/study.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"
#include "report/sampling.hpp"
#include "report/text.hpp"
#include "study/annotation.hpp"
#include "study/phase.hpp"

namespace extremal::python {

Result result_of(const Solved& s) {
  Result result{s.study->title, coordinate_names(s.study->problem), s.solution, s.study->seconds_read,
                std::nullopt};
  result.natural_conditions = natural_conditions(s.study->problem);
  if (s.fit) result.fit = *s.fit;
  return result;
}

namespace {

/// The bytes of a picture in the format that the path ends with; of several solutions of one study all.
py::bytes plot(const std::string& path, const std::vector<std::shared_ptr<Solved>>& solutions) {
  if (solutions.empty()) throw std::invalid_argument("there is no solution to plot");
  for (const auto& s : solutions)
    if (!s->solution.converged())
      throw std::invalid_argument("a solution that has not converged has no picture: " + s->solution.message);
  const Study& study = *solutions.front()->study;
  Result result = result_of(*solutions.front());
  if (solutions.size() > 1) {
    result.solutions.emplace();
    for (const auto& s : solutions) result.solutions->push_back(result_of(*s));
  }
  std::string image;
  {
    const py::gil_scoped_release unlocked;
    const Annotation labels = annotation(study);
    const Picture picture = picture_of(study.problem, result, labels);
    image = is_page(path) ? page(result, picture)
            : result.fit  ? fit_image(path, result, picture.samples, labels)
                          : plot_image(path, picture);
  }
  return image;
}

enum class Quantity { position, velocity, momentum };

/// (m, n) at m times; rates and momenta are NaN at an end where L is infinite.
py::array_t<double> at(const Solved& s, const Doubles& times, Quantity quantity) {
  const std::size_t n = s.study->problem.degrees_of_freedom(), m = times.size();
  py::array_t<double> values({m, n});
  double* const out = values.mutable_data();
  const std::span<const double> t(times.data(), m);
  const py::gil_scoped_release unlocked;
  std::vector<double> columns(3 * n * m);
  std::vector<double*> places[3];
  for (std::size_t row = 0; row < 3 * n; ++row) places[row / n].push_back(columns.data() + row * m);
  if (quantity != Quantity::momentum) places[2].clear();
  phase_columns(s.study->problem, s.solution.trajectory, t, places[0], places[1], places[2]);
  const std::vector<double*>& wanted = places[static_cast<std::size_t>(quantity)];
  const bool open_start = s.solution.momentum_start.empty(), open_end = s.solution.momentum_end.empty();
  const double duration = s.solution.duration();
  for (std::size_t k = 0; k < m; ++k) {
    const bool open = (open_start && t[k] == 0) || (open_end && t[k] == duration);
    const bool known = quantity == Quantity::position || !open;
    for (std::size_t a = 0; a < n; ++a)
      out[k * n + a] = known ? wanted[a][k] : std::numeric_limits<double>::quiet_NaN();
  }
  return values;
}

/// (m, k) forces of k constraints at m times; None without any.
py::object forces(const Solved& s, const Doubles& times, std::vector<Column> Samples::*member) {
  const std::size_t m = times.size();
  std::vector<Column> columns;
  {
    const std::vector<double> t = list(times);
    const py::gil_scoped_release unlocked;
    columns = sample(s.study->problem, s.solution, t).*member;
  }
  if (columns.empty()) return py::none();
  py::array_t<double> values({m, columns.size()});
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (std::size_t i = 0; i < m; ++i) values.mutable_at(i, k) = columns[k][i];
  return values;
}

/// A view of a member of the solution, which the Python object owns.
template <class Number>
auto view_of(std::vector<Number> Solution::*member) {
  return [member](const py::object& self) { return view(self.cast<const Solved&>().solution.*member, self); };
}

const Trajectory& trajectory(const py::object& self) {
  return self.cast<const Solved&>().solution.trajectory;
}

py::object nodes(const py::object& self, const std::vector<double> Trajectory::*member) {
  const Trajectory& path = trajectory(self);
  if ((path.*member).empty()) return py::none();
  return view((path.*member).data(), {path.elements(), path.degree + 1, path.coordinates}, self);
}

/// Of all Lobatto nodes of all elements, from 0 to T.
py::array_t<double> node_times(const Solved& s) {
  const Trajectory& path = s.solution.trajectory;
  const std::vector<double>& tau = lobatto_barycentric(path.degree).nodes;
  std::vector<double> times;
  for (int k = 0; k < path.elements(); ++k) {
    const double start = path.times[k], h = path.times[k + 1] - start;
    for (int j = 0; j < path.degree; ++j) times.push_back(start + h * tau[j]);
  }
  times.push_back(path.duration());
  return read_only(py::array_t<double>(static_cast<py::ssize_t>(times.size()), times.data()));
}

py::object windows(const py::object& self) {
  const Solution& s = self.cast<const Solved&>().solution;
  if (s.certificate == Certificate::none) return py::none();
  const double* const first = s.windows.empty() ? nullptr : s.windows.front().data();
  return view(first, {static_cast<py::ssize_t>(s.windows.size()), 2}, self);
}

py::object conjugate_times(const py::object& self) {
  const Solution& s = self.cast<const Solved&>().solution;
  if (s.certificate == Certificate::none || !s.conjugate_times_known) return py::none();
  return view(s.conjugate_times, self);
}

py::object multipliers(const py::object& self) {
  const Solution& s = self.cast<const Solved&>().solution;
  return s.floquet ? py::object(view(s.floquet->multipliers, self)) : py::none();
}

py::object krein(const py::object& self) {
  const Solution& s = self.cast<const Solved&>().solution;
  return s.floquet && s.floquet->paired ? py::object(view(s.floquet->krein, self)) : py::none();
}

/// Times and residuals of a column, where it was observed: (2, m).
py::array_t<double> residuals(const Fitted& fit, const Fitted::Column& column) {
  std::vector<double> t, left;
  for (std::size_t k = 0; k < fit.t.size(); ++k)
    if (column.residual[k]) {
      t.push_back(fit.t[k]);
      left.push_back(*column.residual[k]);
    }
  py::array_t<double> both({std::size_t{2}, t.size()});
  std::copy(t.begin(), t.end(), both.mutable_data());
  std::copy(left.begin(), left.end(), both.mutable_data() + t.size());
  return read_only(std::move(both));
}

/// Names, values, covariance, χ², degrees of freedom and residuals of a fit; None without one.
py::object fit_of(const Solved& s) {
  if (!s.fit) return py::none();
  const Fitted& fit = *s.fit;
  const std::size_t count = fit.values.size();
  py::array_t<double> covariance({count, count});
  for (std::size_t k = 0; k < count; ++k)
    std::copy(fit.covariance[k].begin(), fit.covariance[k].end(), covariance.mutable_data(k, 0));
  py::dict left;
  for (const Fitted::Column& column : fit.columns) left[py::str(column.name)] = residuals(fit, column);
  return py::make_tuple(fit.parameters, fit.open_ends, fit.values, read_only(std::move(covariance)),
                        fit.chi_squared, fit.freedom, left);
}

}  // namespace

void bind_solution(py::module_& module) {
  using Pointer = std::shared_ptr<Solved>;
  py::class_<Solved, Pointer> solved(module, "Solved");
  const auto value = [&](const char* name, auto member) {
    solved.def_property_readonly(name, [member](const Solved& s) { return s.solution.*member; });
  };
  solved.def_property_readonly("status", [](const Solved& s) { return name(s.solution.status); })
      .def_property_readonly("certificate", [](const Solved& s) { return name(s.solution.certificate); })
      .def_property_readonly("converged", [](const Solved& s) { return s.solution.converged(); })
      .def_property_readonly("duration", [](const Solved& s) { return s.solution.duration(); })
      .def_property_readonly("elements", [](const Solved& s) { return s.solution.trajectory.elements(); })
      .def_property_readonly("names", [](const Solved& s) { return coordinate_names(s.study->problem); });
  value("message", &Solution::message);
  value("strategy", &Solution::strategy);
  value("action", &Solution::action);
  value("energy", &Solution::energy);
  value("energy_drift", &Solution::energy_drift);
  value("work", &Solution::work);
  value("error_estimate", &Solution::error_estimate);
  value("residual", &Solution::residual);
  value("morse_index", &Solution::morse_index);
  value("nullity", &Solution::nullity);
  value("minimizing", &Solution::minimizing);
  value("minimal_period", &Solution::minimal_period);
  value("degree", &Solution::degree);
  value("unknowns", &Solution::unknowns);
  value("iterations", &Solution::iterations);
  value("history", &Solution::history);
  value("seconds_solve", &Solution::seconds_solve);
  value("seconds_analyse", &Solution::seconds_analyse);
  solved.def_property_readonly("momentum_start", view_of(&Solution::momentum_start))
      .def_property_readonly("momentum_end", view_of(&Solution::momentum_end))
      .def_property_readonly("windows", windows)
      .def_property_readonly("conjugate_times", conjugate_times)
      .def_property_readonly("multipliers", multipliers)
      .def_property_readonly("krein", krein)
      .def_property_readonly("times",
                             [](const py::object& self) { return view(trajectory(self).times, self); })
      .def_property_readonly("node_times", node_times)
      .def_property_readonly("nodes", [](const py::object& self) { return nodes(self, &Trajectory::nodes); })
      .def_property_readonly("slopes",
                             [](const py::object& self) { return nodes(self, &Trajectory::slopes); })
      .def("q", [](const Solved& s, const Doubles& t) { return at(s, t, Quantity::position); })
      .def("v", [](const Solved& s, const Doubles& t) { return at(s, t, Quantity::velocity); })
      .def("p", [](const Solved& s, const Doubles& t) { return at(s, t, Quantity::momentum); })
      .def("constraint_forces",
           [](const Solved& s, const Doubles& t) { return forces(s, t, &Samples::constraint_forces); })
      .def("path_forces",
           [](const Solved& s, const Doubles& t) { return forces(s, t, &Samples::path_forces); })
      .def("summary", [](const Solved& s) { return summary(result_of(s)); })
      .def_property_readonly("fit", fit_of)
      .def("state", [](const Solved& s) { return py::make_tuple(packed(s.solution), packed(s.fit)); });
  module.def("restored", [](const PyStudy& study, const py::tuple& state) {
    return solved_by(study.shared(), unpacked(state[0]), unpacked_fit(state[1]));
  });
  module.def("plot", plot, py::arg("path"), py::arg("solutions"));
}

}  // namespace extremal::python
