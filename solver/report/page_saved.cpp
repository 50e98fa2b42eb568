#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "report/page.hpp"
#include "report/page_data.hpp"
#include "report/sampling.hpp"
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

/// Null, which stands where a rate is infinite, becomes NaN.
Column column_of(const PageData& values) {
  Column column;
  for (const PageData& value : values)
    column.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  return column;
}

Samples samples_of(const PageData& samples, const std::vector<std::string>& names) {
  Samples read{.t = column_of(samples.at("t")), .q = {}, .v = {}, .p = {}};
  for (const std::string& name : names) {
    read.q.push_back(column_of(samples.at(name)));
    read.v.push_back(column_of(samples.at(velocity_key(name))));
  }
  const auto forces = [&](const char* key, std::vector<Column>& columns) {
    if (const auto found = samples.find(key); found != samples.end())
      for (const PageData& values : *found) columns.push_back(column_of(values));
  };
  forces("constraint_forces", read.constraint_forces);
  forces("path_forces", read.path_forces);
  bound_ends(read);
  return read;
}

/// What else a result has for its pages, which is taken out of it.
void take_surroundings(PageData& result, Picture& picture, const std::string& name) {
  if (const auto found = result.find("about"); found != result.end()) {
    const PageData about = std::move(*found);
    result.erase(found);
    const PageData units = about.value("units", PageData::object());
    for (const auto& [axis, unit] : units.items()) picture.annotation.units[axis] = unit.get<std::string>();
    for (const PageData& centre : about.value("centres", PageData::array())) {
      Centre read{centre.at("name").get<std::string>(), column_of(centre.at("at"))};
      if (read.at.size() != families(picture.names).size())
        refuse(name, fmt::format("the centre '{}' has {} numbers; each coordinate and each array has one",
                                 read.name, read.at.size()));
      picture.annotation.centres.push_back(std::move(read));
    }
  }
  if (const auto found = result.find("boundaries"); found != result.end()) {
    const PageData boundaries = std::move(*found);
    result.erase(found);
    const bool lone = picture.names.size() == 1;
    for (const PageData& curve : boundaries) {
      PlaneCurve read{column_of(curve.at(lone ? "t" : picture.names.at(0))),
                      column_of(curve.at(picture.names.at(lone ? 0 : 1)))};
      if (curve.contains("at")) read.t = curve["at"].get<double>();
      picture.obstacles.push_back(std::move(read));
    }
  }
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

/// The lines of a result that has a spectrum.
std::optional<Figure> spectrum_figure(const PageData& result, const Picture& picture) {
  const auto found = result.find("spectrum");
  if (found == result.end()) return std::nullopt;
  Result read{.title = picture.title, .names = picture.names};
  read.spectrum.emplace();
  for (const std::string& name : picture.names) {
    Spectrum& spectrum = read.spectrum->motion.coordinates.emplace_back();
    for (const PageData& line : found->at(name))
      spectrum.lines.push_back({.frequency = line.at("frequency").get<double>(),
                                .amplitude = line.at("amplitude").get<double>(),
                                .phase = line.at("phase").get<double>()});
  }
  return spectrum_layout(read);
}

/// Observations and residuals of a result that has a fit.
std::optional<Figure> fit_figure(const PageData& result, const Picture& picture) {
  if (!result.contains("residuals") || !result.contains("observed")) return std::nullopt;
  Result read{.title = picture.title, .names = picture.names};
  read.solution.trajectory.times = {0, result.at("duration").get<double>()};
  Fitted& fit = read.fit.emplace();
  const auto take = [&](const char* field, std::vector<std::string>& names) {
    for (const auto& [name, value] : result.at(field).items()) {
      names.push_back(name);
      fit.values.push_back(value.get<double>());
    }
  };
  take("parameters", fit.parameters);
  take("open_ends", fit.open_ends);
  fit.covariance = result.at("covariance").get<std::vector<std::vector<double>>>();
  const auto narrow = [&](const auto& row) { return row.size() < fit.parameters.size(); };
  if (narrow(fit.covariance) || std::ranges::any_of(fit.covariance, narrow)) return std::nullopt;
  const PageData& residuals = result.at("residuals");
  fit.t = residuals.at("t").get<std::vector<double>>();
  if (fit.t.empty()) return std::nullopt;
  const auto column = [&](const PageData& table, const std::string& name) {
    std::vector<std::optional<double>> values(fit.t.size());
    if (table.is_object())
      for (std::size_t k = 0; k < values.size(); ++k)
        if (const PageData& x = table.at(name).at(k); !x.is_null()) values[k] = x.get<double>();
    return values;
  };
  const PageData sigma = result.value("sigma", PageData(nullptr));
  for (const auto& [name, value] : residuals.items())
    if (name != "t")
      fit.columns.push_back(
          {name, column(result["observed"], name), column(residuals, name), column(sigma, name)});
  return fit_layout(read, picture.samples, picture.annotation);
}

PageData saved_solution(PageData result, const std::string& name) {
  const std::string status = result.value("status", "");
  if (status != "converged")
    refuse(name, fmt::format("the status of the result is '{}': there is no motion to show", status));
  Picture picture{.title = result.value("title", ""), .names = {}, .samples = {}};
  const PageData outer = take_samples(result, name);
  picture.names = names_of(outer);
  picture.samples = samples_of(outer, picture.names);
  take_surroundings(result, picture, name);
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
  const std::optional<Figure> figures[] = {spectrum_figure(result, picture), fit_figure(result, picture)};
  PageData data = solution_data(std::move(result), picture);
  for (const std::optional<Figure>& figure : figures)
    if (figure) data["figures"].push_back(page_figure(*figure));
  return data;
}

/// Where a file does not name it: what its values tell.
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

/// The orbits of a branch, taken out of its points; none where not all have samples.
std::vector<Samples> take_orbits(PageData& result, const std::string& name, std::vector<std::string>& names) {
  std::vector<Samples> orbits;
  for (PageData& point : result.at("points")) {
    if (!point.contains("samples")) return {};
    const PageData own = take_samples(point, name);
    if (orbits.empty()) names = names_of(own);
    orbits.push_back(samples_of(own, names));
  }
  return orbits;
}

PageData saved_branch(PageData result, const std::string& name) {
  FollowedBranch branch;
  for (const PageData& point : result.at("points")) branch.points.push_back(point_of(point));
  if (branch.points.empty()) refuse(name, "the branch has no points");
  branch.title = result.value("title", "");
  branch.parameter = result.value("varied", varied(branch.points));
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
  std::vector<Samples> orbits = take_orbits(result, name, branch.names);
  Picture drawn{.title = branch.title, .names = branch.names, .samples = {}};
  take_surroundings(result, drawn, name);
  return branch_data({branch, quantity, drawn.annotation}, std::move(result), std::move(orbits));
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
