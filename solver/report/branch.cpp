#include "report/branch.hpp"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>

#include "report/figure.hpp"
#include "report/file.hpp"
#include "report/result.hpp"
#include "report/text.hpp"

namespace extremal {

namespace {

using Json = nlohmann::ordered_json;

/// A branch that went as far as it was to go has converged, however it was to end.
const char* status(BranchEnd end) {
  switch (end) {
    case BranchEnd::collision:
      return name(Status::collision);
    case BranchEnd::limit:
      return name(Status::no_solution_near);
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

Json object(const BranchPoint& point, const std::vector<std::string>& names) {
  const Solution& solution = point.solution;
  const Start start(solution.trajectory);
  Json state = Json::object();
  for (std::size_t a = 0; a < names.size(); ++a) state[names[a]] = start.q[a];
  for (std::size_t a = 0; a < names.size(); ++a) state[velocity_key(names[a])] = start.v[a];
  return {{"parameter", point.parameter},
          {"duration", solution.duration()},
          {"energy", known(solution.energy)},
          {"action", solution.action},
          {"morse_index", known(solution.morse_index)},
          {"multipliers", nullptr},
          {"kind", name(point.kind)},
          {"start", std::move(state)}};
}

template <class Value>
std::string cell(const std::optional<Value>& value) {
  return value ? fmt::format("{}", *value) : "";
}

}  // namespace

void write_json(std::ostream& out, const FollowedBranch& branch) {
  Json points = Json::array();
  for (const BranchPoint& point : branch.points) points.push_back(object(point, branch.names));
  out << Json{{"status", status(branch.end)},
              {"message", printable(branch.message, 2000)},
              {"points", std::move(points)}}
             .dump(2)
      << "\n";
}

void write_json(const std::string& path, const FollowedBranch& branch) {
  write_file(path, [&](std::ostream& out) { write_json(out, branch); });
}

void write_csv(std::ostream& out, const FollowedBranch& branch) {
  std::string text = "parameter,duration,energy,action,morse_index,kind";
  for (const std::string& name : branch.names) text += "," + name;
  for (const std::string& name : branch.names) text += "," + velocity_key(name);
  text += "\n";
  for (const BranchPoint& point : branch.points) {
    const Solution& solution = point.solution;
    text += fmt::format("{},{},{},{},{},{}", point.parameter, solution.duration(), cell(solution.energy),
                        solution.action, cell(solution.morse_index), name(point.kind));
    const Start start(solution.trajectory);
    for (const double x : start.q) fmt::format_to(std::back_inserter(text), ",{}", x);
    for (const double x : start.v) fmt::format_to(std::back_inserter(text), ",{}", x);
    text += "\n";
  }
  out << text;
}

void write_csv(const std::string& path, const FollowedBranch& branch) {
  write_file(path, [&](std::ostream& out) { write_csv(out, branch); });
}

std::string summary(const FollowedBranch& branch) {
  std::string text = branch.title.empty() ? "" : printable(branch.title, 200) + "\n";
  using Align = Table::Align;
  Table table{{{branch.parameter}, {"duration"}, {"energy"}, {"action"}, {"index"}, {"kind", Align::left}},
              {}};
  if (branch.parameter == "duration" || branch.parameter == "energy")
    table.head[0].text = "varied " + branch.parameter;
  for (const BranchPoint& point : branch.points) {
    const Solution& solution = point.solution;
    table.rows.push_back(
        {fmt::format("{:.10g}", point.parameter), fmt::format("{:.10g}", solution.duration()),
         solution.energy ? fmt::format("{:.10g}", *solution.energy) : "-",
         fmt::format("{:.10g}", solution.action),
         solution.morse_index ? fmt::format("{}", *solution.morse_index) : "-", name(point.kind)});
  }
  text += plain_text(table) + "\n";
  text += fmt::format("{:<16}{}\n", "end", printable(branch.message, 2000));
  const char* const law =
      branch.parameter == "duration" || branch.parameter == "energy" ? "dS = -E dT" : "dS = -E dT + dS/dp dp";
  return text + fmt::format("{:<16}{} along the branch, violated by {:.1e} of S at most\n", "check", law,
                            branch.worst_action_slope);
}

}  // namespace extremal
