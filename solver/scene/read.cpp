#include "scene/read.hpp"

#include "scene/schema.hpp"

namespace extremal {
namespace {

Text text(const Document& document, const toml::node& node) {
  return {*node.value<std::string>(), document.at(node)};
}

std::optional<Text> text(const Document& document, const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  return node ? std::optional(text(document, *node)) : std::nullopt;
}

std::vector<Text> texts(const Document& document, const toml::table& table, std::string_view key) {
  std::vector<Text> list;
  if (const toml::array* array = table[key].as_array())
    for (const toml::node& node : *array) list.push_back(text(document, node));
  return list;
}

std::optional<Number> number(const Document& document, const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  return node ? std::optional(Number{*node->value<double>(), document.at(*node)}) : std::nullopt;
}

Quantity quantity(const Document& document, const toml::node& node) {
  if (node.is_string()) return {*node.value<std::string>(), document.at(node)};
  return {*node.value<double>(), document.at(node)};
}

std::optional<Quantity> quantity(const Document& document, const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  return node ? std::optional(quantity(document, *node)) : std::nullopt;
}

Assignment assignment(const Document& document, const Entry& entry) {
  Assignment a{std::string(entry.key->str()),
               document.at(entry.key->source()),
               {},
               entry.value->is_array(),
               document.at(*entry.value)};
  if (a.list)
    for (const toml::node& node : *entry.value->as_array()) a.values.push_back(quantity(document, node));
  else
    a.values.push_back(quantity(document, *entry.value));
  return a;
}

std::vector<Assignment> assignments(const Document& document, const toml::table* table) {
  std::vector<Assignment> list;
  if (table)
    for (const Entry& entry : document.entries(*table)) list.push_back(assignment(document, entry));
  return list;
}

}  // namespace

SystemTable read_system_table(const Document& document, const toml::table& table) {
  SystemTable system;
  system.at = document.at(table);
  system.use = text(document, table, "use");
  system.coordinates = texts(document, table, "coordinates");
  system.parameters = assignments(document, table["parameters"].as_table());
  if (const toml::table* definitions = table["definitions"].as_table())
    for (const auto& [key, value] : document.entries(*definitions))
      system.definitions.push_back(
          {std::string(key->str()), document.at(key->source()), text(document, *value)});
  system.lagrangian = text(document, table, "lagrangian");
  system.hamiltonian = text(document, table, "hamiltonian");
  system.force = assignments(document, table["force"].as_table());
  system.constraints = texts(document, table, "constraints");
  system.curvature = number(document, table, "curvature");
  return system;
}

BoundaryTable read_boundary_table(const Document& document, const toml::table& table) {
  BoundaryTable boundary;
  boundary.at = document.at(table);
  boundary.start = assignments(document, table["start"].as_table());
  boundary.end = assignments(document, table["end"].as_table());
  boundary.map = assignments(document, table["map"].as_table());
  boundary.periodic = table["periodic"].value_or(false);
  boundary.conditions = texts(document, table, "conditions");
  const auto duration = quantity(document, table, "duration");
  if (!duration)
    throw SceneError(boundary.at,
                     "[boundary] has no duration; give a number, a formula, \"free\" or "
                     "\"infinite\"");
  boundary.duration = *duration;
  boundary.free = duration->formula() && std::get<std::string>(duration->value) == "free";
  boundary.infinite = duration->formula() && std::get<std::string>(duration->value) == "infinite";
  boundary.energy = quantity(document, table, "energy");
  boundary.integrals = texts(document, table, "integrals");
  boundary.unknowns = assignments(document, table["unknowns"].as_table());
  boundary.where_list = texts(document, table, "where");
  if (const toml::node* where = table.get("where"); where && where->is_string())
    boundary.where_list.push_back(text(document, *where));
  if (boundary.where_list.size() == 1 && boundary.unknowns.empty()) {
    boundary.where = boundary.where_list.front();
    boundary.where_list.clear();
  }
  return boundary;
}

std::vector<WaypointTable> read_waypoint_tables(const Document& document, const toml::array& tables) {
  std::vector<WaypointTable> waypoints;
  for (const toml::node& node : tables) {
    const toml::table& table = *node.as_table();
    WaypointTable& waypoint = waypoints.emplace_back();
    waypoint.at = document.at(table);
    const auto time = quantity(document, table, "at");
    if (!time) throw SceneError(waypoint.at, "this waypoint has no 'at'; give its time, or at = \"free\"");
    waypoint.time = *time;
    waypoint.free = time->formula() && std::get<std::string>(time->value) == "free";
    for (const Entry& entry : document.entries(table))
      if (find_key("waypoints", entry.key->str())->key == "*")
        waypoint.values.push_back(assignment(document, entry));
    if (waypoint.values.empty())
      throw SceneError(waypoint.at, "this waypoint fixes no coordinate; name one, x = 0.2");
  }
  return waypoints;
}

GuessTable read_guess_table(const Document& document, const toml::table& table) {
  GuessTable guess;
  guess.at = document.at(table);
  for (const Entry& entry : document.entries(table))
    if (find_key("guess", entry.key->str())->key == "*")
      guess.formulas.push_back(assignment(document, entry));
  guess.file = text(document, table, "file");
  guess.orbit = number(document, table, "orbit");
  if (const toml::table* state = table["state"].as_table()) guess.state = assignments(document, state);
  guess.duration = quantity(document, table, "duration");
  return guess;
}

SolveTable read_solve_table(const Document& document, const toml::table& table) {
  SolveTable solve;
  solve.tolerance = number(document, table, "tolerance");
  solve.scheme = text(document, table, "scheme");
  solve.elements = number(document, table, "elements");
  solve.steps = text(document, table, "steps");
  solve.budget = number(document, table, "budget");
  solve.method = text(document, table, "method");
  return solve;
}

SearchTable read_search_table(const Document& document, const toml::table& table) {
  const auto solutions = number(document, table, "solutions");
  if (!solutions)
    throw SceneError(document.at(table), "[search] has no 'solutions'; give the largest number of extremals");
  return {*solutions};
}

PathTable read_path_table(const Document& document, const toml::table& table) {
  PathTable path{document.at(table), texts(document, table, "constraints")};
  if (path.constraints.empty())
    throw SceneError(path.at, "[path] has no 'constraints'; list inequalities, as in [\"x^2 + y^2 >= 1\"]");
  return path;
}

SpectrumTable read_spectrum_table(const Document& document, const toml::table& table) {
  return {number(document, table, "lines"), text(document, table, "against")};
}

UnitsTable read_units_table(const Document& document, const toml::table& table) {
  return {document.at(table),
          number(document, table, "length"),
          number(document, table, "time"),
          text(document, table, "frame"),
          text(document, table, "centre"),
          text(document, table, "epoch")};
}

FitTable read_fit_table(const Document& document, const toml::table& table) {
  FitTable fit;
  fit.at = document.at(table);
  const auto data = text(document, table, "data");
  if (!data)
    throw SceneError(fit.at,
                     "[fit] has no 'data'; name a CSV file with a column t and columns of observations");
  fit.data = *data;
  if (const toml::table* observe = table["observe"].as_table())
    for (const auto& [key, value] : document.entries(*observe))
      fit.observe.push_back({std::string(key->str()), document.at(key->source()), text(document, *value)});
  fit.parameters = texts(document, table, "parameters");
  fit.loss = text(document, table, "loss");
  return fit;
}

ContinuationTable read_continuation_table(const Document& document, const toml::table& table) {
  const auto parameter = text(document, table, "parameter");
  const auto to = number(document, table, "to");
  const Location at = document.at(table);
  if (!parameter)
    throw SceneError(at,
                     "[continuation] has no parameter; give \"duration\", \"energy\" or the name of a "
                     "parameter of the system");
  if (!to) throw SceneError(at, "[continuation] has no 'to'; give the last value of the parameter");
  return {at, *parameter, *to, number(document, table, "points"), table["switch"].value_or(false)};
}

}  // namespace extremal
