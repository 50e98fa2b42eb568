#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "report/page.hpp"
#include "report/page_data.hpp"
#include "report/solutions.hpp"

namespace extremal {

namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
  throw std::invalid_argument(fmt::format("{}: {}", name, reason));
}

/// The coordinates among the columns of samples: those whose velocity stands beside them.
std::vector<std::string> names_of(const PageData& samples) {
  std::vector<std::string> names;
  for (const auto& [key, column] : samples.items())
    if (samples.contains(velocity_key(key))) names.push_back(key);
  return names;
}

Samples samples_of(const PageData& samples, const std::vector<std::string>& names) {
  Samples read{.t = samples.at("t").get<Column>(), .q = {}, .v = {}, .p = {}};
  for (const std::string& name : names) {
    read.q.push_back(samples.at(name).get<Column>());
    read.v.push_back(samples.at(velocity_key(name)).get<Column>());
  }
  return read;
}

PageData take_samples(PageData& result, const std::string& name) {
  const auto found = result.find("samples");
  if (found == result.end())
    refuse(name,
           "the result has no samples, so there is no motion to show; solve its scene again with "
           "--samples 1000 --output " +
               name);
  PageData samples = std::move(*found);
  result.erase(found);
  return samples;
}

PageData saved_solution(PageData result, const std::string& name) {
  const std::string status = result.value("status", "");
  if (status != "converged")
    refuse(name, fmt::format("the status of the result is '{}': there is no motion to show", status));
  Picture picture{.title = result.value("title", ""), .names = {}, .samples = {}};
  const PageData outer = take_samples(result, name);
  picture.names = names_of(outer);
  picture.samples = samples_of(outer, picture.names);
  const auto several = result.find("solutions");
  if (several != result.end()) {
    picture.others.clear();
    for (std::size_t k = 0; k < several->size(); ++k) {
      const PageData own = take_samples((*several)[k], name);
      if (k > 0) picture.others.push_back(samples_of(own, picture.names));
      if (several->size() > 1) picture.actions.push_back((*several)[k].at("action").get<double>());
    }
  }
  check_picture(picture);
  return solution_data(std::move(result), picture);
}

/// Of the name "parameter" the file does not say more than its values tell.
std::string varied(const std::vector<BranchPoint>& points) {
  const auto all = [&](auto same) { return std::ranges::all_of(points, same); };
  if (all([](const BranchPoint& p) { return p.solution.energy == p.parameter; })) return "energy";
  if (all([](const BranchPoint& p) { return p.solution.duration() == p.parameter; })) return "duration";
  return "parameter";
}

PointKind kind_named(const std::string& text) {
  for (const PointKind kind : {PointKind::fold, PointKind::branch, PointKind::period_doubling})
    if (text == name(kind)) return kind;
  return PointKind::regular;
}

BranchPoint point_of(const PageData& data) {
  BranchPoint point{.parameter = data.at("parameter").get<double>(),
                    .kind = kind_named(data.at("kind").get<std::string>()),
                    .branch = data.value("branch", 0),
                    .solution = {}};
  Solution& solution = point.solution;
  solution.trajectory.times = {0, data.at("duration").get<double>()};
  solution.action = data.at("action").get<double>();
  if (!data.at("energy").is_null()) solution.energy = data["energy"].get<double>();
  if (!data.at("morse_index").is_null()) solution.morse_index = data["morse_index"].get<int>();
  if (!data.at("multipliers").is_null()) {
    Floquet floquet;
    floquet.paired = false;  // so that the values alone tell stability
    for (const PageData& value : data["multipliers"])
      floquet.multipliers.emplace_back(value.at(0).get<double>(), value.at(1).get<double>());
    solution.floquet = std::move(floquet);
  }
  return point;
}

PageData saved_branch(PageData result, const std::string& name) {
  FollowedBranch branch;
  for (const PageData& point : result.at("points")) branch.points.push_back(point_of(point));
  if (branch.points.empty()) refuse(name, "the branch has no points");
  branch.parameter = varied(branch.points);
  for (const PageData& record : result.at("branches")) {
    branch.branches.emplace_back();
    if (!record.at("origin").is_null()) branch.branches.back().origin = record["origin"].get<int>();
  }
  const bool upwards = branch.parameter != "energy";
  BranchQuantity quantity{upwards ? "energy" : "duration", {}};
  const bool known =
      std::ranges::all_of(branch.points, [](const BranchPoint& p) { return p.solution.energy.has_value(); });
  if (upwards && !known) quantity.name = "action";
  for (const BranchPoint& point : branch.points)
    quantity.values.push_back(quantity.name == "energy"     ? *point.solution.energy
                              : quantity.name == "duration" ? point.solution.duration()
                                                            : point.solution.action);
  return branch_data({branch, quantity}, std::move(result), false);
}

PageData saved_comparison(PageData result, const std::string& name) {
  Comparison comparison;
  for (const PageData& row : result.at("rows")) {
    ComparisonRow& read = comparison.rows.emplace_back();
    read.method = row.at("method").get<std::string>();
    read.tolerance = row.at("tolerance").get<double>();
    read.seconds = row.at("seconds").get<double>();
    if (!row.at("error").is_null()) read.error = row["error"].get<double>();
  }
  if (!comparison.any()) refuse(name, "no row of the comparison has an error");
  return comparison_data(comparison, std::move(result));
}

}  // namespace

std::string saved_page(const std::string& text, const std::string& name) {
  require_pages();
  PageData result = PageData::parse(text, nullptr, false);
  if (!result.is_object())
    refuse(name,
           "this is no result; a file is needed that --output has written, as in extremal solve SCENE "
           "--samples 1000 --output R.json");
  try {
    if (result.contains("points")) return filled_page(saved_branch(std::move(result), name));
    if (result.contains("rows")) return filled_page(saved_comparison(std::move(result), name));
    return filled_page(saved_solution(std::move(result), name));
  } catch (const PageData::exception& e) {
    refuse(name, fmt::format("this is no result that --output has written: {}", e.what()));
  }
}

}  // namespace extremal
