#include "report/branch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <iterator>
#include <ostream>

#include "report/figure.hpp"
#include "report/json_parts.hpp"
#include "report/result.hpp"
#include "report/sampling.hpp"
#include "report/text.hpp"
#include "solution/extension_values.hpp"

namespace extremal {

namespace {

/// A branch that went as far as it was to go has converged, however it was to end.
const char* status(BranchEnd end) {
  switch (end) {
    case BranchEnd::collision:
      return name(Status::collision);
    case BranchEnd::limit:
    case BranchEnd::too_short:
      return name(Status::no_solution_near);
    case BranchEnd::budget:
      return name(Status::iteration_limit);
    case BranchEnd::none:
    case BranchEnd::not_started:
      return name(Status::not_converged);
    default:
      return name(Status::converged);
  }
}

/// Coordinates and velocities at t = 0.
struct Start {
  std::vector<double> q, v;
  explicit Start(const Trajectory& trajectory) : q(trajectory.coordinates), v(trajectory.coordinates) {
    trajectory.at(0, q, v);
  }
};

template <class Value>
Json known(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json multipliers(const Solution& solution) {
  if (!solution.floquet) return nullptr;
  Json values = Json::array();
  for (const std::complex<double>& value : solution.floquet->multipliers)
    values.push_back({value.real(), value.imag()});
  return values;
}

Json object(const BranchPoint& point, const std::vector<std::string>& names) {
  const Solution& solution = point.solution;
  const Start start(solution.trajectory);
  Json state = Json::object();
  for (std::size_t a = 0; a < names.size(); ++a) state[names[a]] = start.q[a];
  for (std::size_t a = 0; a < names.size(); ++a) state[velocity_key(names[a])] = start.v[a];
  Json object = {
      {"branch", point.branch},
      {"parameter", point.parameter},
      {"duration", solution.duration()},
      {"energy", known(solution.energy)},
      {"action", solution.action},
      {"morse_index", known(solution.morse_index)},
      {"nullity", known(solution.nullity)},
      {"multipliers", multipliers(solution)},
      {"krein", solution.floquet && solution.floquet->paired ? Json(solution.floquet->krein) : Json(nullptr)},
      {"kind", name(point.kind)},
      {"start", std::move(state)}};
  if (solution.extension)
    for (const auto& [unknown, value] : solution.extension->unknowns) object["unknowns"][unknown] = value;
  return object;
}

/// Lines in the place of a value, indented by so much more.
std::string indented(const Json& value, const std::string& indent) {
  std::string text;
  for (const char c : value.dump(2, ' ', false, Json::error_handler_t::replace)) {
    text += c;
    if (c == '\n') text += indent;
  }
  return text;
}

/// The list of points, as the tree of all without samples is written.
void write_points(std::ostream& out, const FollowedBranch& branch, int samples) {
  const std::string indent = "    ", end = "\n" + indent + "}";
  for (const BranchPoint& point : branch.points) {
    std::string text = indented(object(point, branch.names), indent);
    out << (&point == branch.points.data() ? "\n" : ",\n") << indent;
    if (samples > 0) text.resize(text.size() - end.size());
    out << text;
    if (samples == 0) continue;
    write_motion(out, indent + "  ", sampled(point.solution.trajectory, samples), branch.names);
    out << end;
  }
}

Json object(const BranchRecord& record) {
  return {{"origin", known(record.origin)},
          {"status", status(record.end)},
          {"message", printable(record.message, 2000)},
          {"points", record.points},
          {"action_defect", known(record.worst_action_slope)},
          {"momentum_defect", known(record.worst_momentum)}};
}

template <class Value>
std::string cell(const std::optional<Value>& value) {
  return value ? fmt::format("{}", *value) : "";
}

bool periodic(const FollowedBranch& branch) {
  return std::any_of(branch.points.begin(), branch.points.end(),
                     [](const BranchPoint& point) { return point.solution.floquet.has_value(); });
}

/// The multiplier farthest from the unit circle, or that there is none.
std::string stability(const Solution& solution) {
  if (!solution.floquet || solution.floquet->multipliers.empty()) return "-";
  if (solution.floquet->stable()) return "stable";
  const std::complex<double> largest = solution.floquet->multipliers.front();
  return largest.imag() == 0 ? fmt::format("{:.5g}", largest.real())
                             : fmt::format("{:.4g} ± {:.4g}i", largest.real(), std::abs(largest.imag()));
}

/// What of dS is checked along the branch.
const char* law(const FollowedBranch& branch) {
  return branch.parameter == "duration" || branch.parameter == "energy" ? "dS = -E dT"
                                                                        : "dS = -E dT + dS/dp dp";
}

std::string record_text(const FollowedBranch& branch, std::size_t number) {
  const BranchRecord& record = branch.branches[number];
  std::string text;
  if (record.origin)
    text += fmt::format("\n{:<16}from the {} at {:.10g}, {} points\n", fmt::format("branch {}", number),
                        name(branch.points[*record.origin].kind), branch.points[*record.origin].parameter,
                        record.points);
  text += fmt::format("{:<16}{}\n", "end", printable(record.message, 2000));
  if (record.points == 0 || !record.worst_momentum) return text;
  const std::string action = record.worst_action_slope
                                 ? fmt::format("{} along the branch to {:.1e} of S; dS/dq = p", law(branch),
                                               *record.worst_action_slope)
                                 : "momenta of the action against dL/dq'";
  return text + fmt::format("{:<16}{} to {:.1e}\n", "check", action, *record.worst_momentum);
}

}  // namespace

void write_json(std::ostream& out, const FollowedBranch& branch, const SavedOrbits& orbits) {
  Json branches = Json::array();
  for (const BranchRecord& record : branch.branches) branches.push_back(object(record));
  const BranchRecord& first = branch.branches.front();
  std::string head = Json{{"status", status(first.end)},
                          {"message", printable(first.message, 2000)},
                          {"title", branch.title},
                          {"varied", branch.parameter},
                          {"branches", std::move(branches)}}
                         .dump(2, ' ', false, Json::error_handler_t::replace);
  head.resize(head.size() - 2);  // without the last brace
  out << head;
  if (orbits.samples > 0) write_about(out, "  ", orbits.annotation);
  out << ",\n  \"points\": [";
  write_points(out, branch, orbits.samples);
  out << (branch.points.empty() ? "]\n}\n" : "\n  ]\n}\n");
}

void write_csv(std::ostream& out, const FollowedBranch& branch) {
  std::string text = "branch,parameter,duration,energy,action,morse_index,nullity,kind";
  const std::size_t count = periodic(branch) ? 2 * branch.names.size() : 0;
  for (const std::string& name : branch.names) text += "," + name;
  for (const std::string& name : branch.names) text += fmt::format(",{}", velocity_key(name));
  for (std::size_t k = 1; k <= count; ++k) text += fmt::format(",multiplier_re[{0}],multiplier_im[{0}]", k);
  text += "\n";
  for (const BranchPoint& point : branch.points) {
    const Solution& solution = point.solution;
    text += fmt::format("{},{},{},{},{},{},{},{}", point.branch, point.parameter, solution.duration(),
                        cell(solution.energy), solution.action, cell(solution.morse_index),
                        cell(solution.nullity), name(point.kind));
    const Start start(solution.trajectory);
    for (const double x : start.q) fmt::format_to(std::back_inserter(text), ",{}", x);
    for (const double x : start.v) fmt::format_to(std::back_inserter(text), ",{}", x);
    for (std::size_t k = 0; k < count; ++k) {
      const std::complex<double>* value = solution.floquet ? &solution.floquet->multipliers[k] : nullptr;
      text += value ? fmt::format(",{},{}", value->real(), value->imag()) : ",,";
    }
    text += "\n";
  }
  out << text;
}

std::string summary(const FollowedBranch& branch) {
  std::string text = branch.title.empty() ? "" : printable(branch.title, 200) + "\n";
  using Align = Table::Align;
  const bool orbits = periodic(branch), several = branch.branches.size() > 1;
  Table table;
  if (several) table.head.push_back({"branch"});
  const bool own = branch.parameter == "duration" || branch.parameter == "energy";
  table.head.insert(table.head.end(), {{own ? "varied " + branch.parameter : branch.parameter},
                                       {"duration"},
                                       {"energy"},
                                       {"action"},
                                       {"index"}});
  if (orbits) table.head.push_back({"largest multiplier"});
  table.head.push_back({"kind", Align::left});
  for (const BranchPoint& point : branch.points) {
    const Solution& solution = point.solution;
    std::vector<std::string> row;
    if (several) row.push_back(fmt::format("{}", point.branch));
    row.insert(row.end(),
               {fmt::format("{:.10g}", point.parameter), fmt::format("{:.10g}", solution.duration()),
                solution.energy ? fmt::format("{:.10g}", *solution.energy) : "-",
                fmt::format("{:.10g}", solution.action),
                solution.morse_index ? fmt::format("{}", *solution.morse_index) : "-"});
    if (orbits) row.push_back(stability(solution));
    row.push_back(name(point.kind));
    table.rows.push_back(std::move(row));
  }
  text += plain_text(table) + "\n";
  for (std::size_t k = 0; k < branch.branches.size(); ++k) text += record_text(branch, k);
  return text;
}

}  // namespace extremal
