#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands.hpp"
#include "app/lines.hpp"
#include "app/terminal.hpp"
#include "study/annotation.hpp"
#include "study/fitting.hpp"
#include "study/inspection.hpp"

namespace extremal::app {
namespace {

std::string coordinates_text(const System& system) {
  std::vector<std::string> texts;
  for (const Coordinate& c : system.coordinates)
    texts.push_back(c.array ? fmt::format("{}[{}]", c.name, c.count) : c.name);
  return fmt::format("{}: {}", system.names.size(), fmt::join(texts, ", "));
}

std::vector<std::string> parameter_texts(const System& system) {
  std::vector<std::string> texts;
  for (const auto& [name, parameter] : system.parameters) {
    std::vector<std::string> values;
    for (const double value : parameter.value) values.push_back(fmt::format("{}", value));
    texts.push_back(parameter_text(name, values, parameter.list));
  }
  return texts;
}

std::string boundary_text(const Problem& problem) {
  const int n = problem.coordinates(), rows = problem.boundary.rows;
  if (problem.periodic) return "periodic";
  if (problem.initial) return fmt::format("initial data, {} coordinates and {} momenta", n, n);
  return fmt::format("{} conditions on {} end values, {} natural", rows, 2 * n, problem.ends.free);
}

/// The end values that the boundary relation does not fix, of one end, with the momenta that are given there.
std::string open_text(const Problem& problem, bool at_end) {
  constexpr std::size_t most = 12;
  const int n = problem.coordinates();
  std::vector<std::string> names;
  for (int a = 0; a < n; ++a) {
    const int e = at_end ? n + a : a;
    if (problem.ends.fixed[e]) continue;
    const double p = problem.boundary.momenta.empty() ? 0 : problem.boundary.momenta[e];
    names.push_back(fmt::format("{}({})", problem.names[a], at_end ? "T" : "0"));
    if (p != 0) names.back() += fmt::format(" with p_{} = {}", problem.names[a], p);
  }
  if (names.empty()) return "none";
  if (names.size() > most) names[most] = fmt::format("… {} in all", names.size());
  names.resize(std::min(names.size(), most + 1));
  return fmt::format("{}", fmt::join(names, ", "));
}

void print_ends(const Problem& problem) {
  line("boundary", boundary_text(problem));
  if (problem.periodic || problem.initial || problem.ends.free == 0) return;
  line("not fixed",
       fmt::format("at the start {}; at the end {}", open_text(problem, false), open_text(problem, true)));
}

void print_fit(const Study& study) {
  if (!study.fit) return;
  const FitTask& task = study.fit->task;
  std::vector<std::string> unknowns, columns;
  for (const FitUnknown& unknown : task.unknowns)
    unknowns.push_back(fmt::format("{} (from {:.6g})", unknown.name, unknown.start));
  for (const ObservedColumn& column : task.data.columns)
    columns.push_back(
        fmt::format("{}: {}{}", column.name, column.values.size(), column.turn > 0 ? " of an angle" : ""));
  line("fit", fmt::format("to be found: {}", fmt::join(unknowns, ", ")));
  line("", fmt::format("values observed of {}; loss: {}", fmt::join(columns, ", "), name(task.loss)));
}

std::string duration_text(const Duration& duration) {
  if (!duration.free) return fmt::format("{}", duration.value);
  const std::string closed = duration.energy  ? fmt::format("energy = {}", *duration.energy)
                             : duration.where ? "where"
                                              : "the orbit itself";
  return fmt::format("free, guess {}, closed by {}", duration.value, closed);
}

/// Formulas as they are written.
std::vector<std::string> force_texts(const Study& study) {
  std::vector<std::string> texts;
  for (const Assignment& force : study.forces) texts.push_back(assignment_text(force));
  return texts;
}

std::vector<std::string> as_written(const std::vector<Text>& formulas) {
  std::vector<std::string> texts;
  for (const Text& formula : formulas) texts.push_back(formula.value);
  return texts;
}

void print_structure(const Inspection& found) {
  if (!found.autonomous)
    line("time", "L depends on t");
  else if (!found.with_forces)
    line("time", "L does not depend on t: energy is conserved");
  else
    line("time", found.forces_autonomous ? "L and the forces do not depend on t"
                                         : "L does not depend on t, but the forces do");
  if (found.quadratic)
    line("velocities",
         fmt::format("constant mass, entries: {}; gyroscopic: {}{}", found.mass_entries,
                     found.gyroscopic_entries,
                     found.velocity_free ? "; separable: the rest of L depends on positions only" : ""));
  else
    line("velocities", "L is not quadratic in them with a constant mass");
  if (found.momenta_solved) line("momenta", "∂H/∂p = q' is solved for p at each point; L has no expression");
  line("Hessian", fmt::format("entries evaluated: {}; in (q, q): {}, in (q', q): {}, in (q', q'): {}",
                              found.qq + found.vq + found.vv, found.qq, found.vq, found.vv));
  if (found.kinks > 0)
    line("kinks",
         fmt::format("surfaces of abs, min, max or step: {}; elements end where the path crosses one",
                     found.kinks));
  for (const Inspection::Tape& tape : found.tapes)
    line(tape.order.c_str(), fmt::format("instructions: {}; kernels: {}; executed at each point: {}",
                                         tape.instructions, tape.kernels, tape.played));
}

std::string point_text(const Study& study, const WorstDerivative& worst) {
  constexpr std::size_t most = 4;
  std::vector<std::string> texts;
  const auto& names = study.problem.names;
  for (std::size_t a = 0; a < std::min(names.size(), most); ++a)
    texts.push_back(fmt::format("{0} = {1:.4g}, {0}' = {2:.4g}", names[a], worst.q[a], worst.v[a]));
  if (names.size() > most) texts.emplace_back("…");
  return fmt::format("{}, t = {:.4g}", fmt::join(texts, ", "), worst.t);
}

void print_worst(const Study& study, const char* order, const WorstDerivative& worst) {
  if (worst.name.empty()) return;
  const std::string off =
      worst.error > 0 ? fmt::format("off by {:.1e}", worst.error) : "equal up to roundoff";
  line(order, fmt::format("at worst {} = {:.15g}, by differences {:.15g}: {}", worst.name, worst.derivative,
                          worst.difference, off));
  line("", "at " + point_text(study, worst));
}

}  // namespace

int check(const CheckArguments& arguments) {
  const Study study = load(arguments.scene, arguments.sets);
  annotation(study);  // refuses what the system file says wrongly of pictures
  const Inspection found = inspect(study);
  const DerivativeCheck& derivatives = found.derivatives;
  if (!study.title.empty()) line("title", study.title);
  line("coordinates", coordinates_text(study.system));
  lines("parameters", parameter_texts(study.system));
  lines("forces", force_texts(study));
  lines("constraints", as_written(study.constraints));
  lines("along the path", as_written(study.inequalities));
  print_ends(study.problem);
  line("duration", duration_text(study.problem.duration));
  lines("integrals", as_written(study.integrals));
  lines("unknowns", found.unknowns);
  lines("waypoints", found.waypoints);
  print_fit(study);
  print_structure(found);
  line("derivatives", fmt::format("against differences of sixth order at {} points, by {} of {} variables",
                                  derivatives.points, derivatives.columns, 2 * study.problem.coordinates()));
  print_worst(study, "first", derivatives.gradient);
  print_worst(study, "second", derivatives.hessian);
  if (found.with_forces) {
    print_worst(study, "forces, first", found.with_forces->gradient);
    print_worst(study, "second", found.with_forces->hessian);
  }
  if (derivatives.agree() && (!found.with_forces || found.with_forces->agree())) return Exit::done;
  print_error(fmt::format("{}: {}", arguments.scene,
                          derivatives.points ? "derivatives and difference quotients do not agree"
                                             : "L is not finite at any point that was tried"));
  return Exit::not_converged;
}

}  // namespace extremal::app
