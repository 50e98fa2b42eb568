#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "action/scheme.hpp"
#include "app/command.hpp"
#include "house/pages.hpp"
#include "scene/document.hpp"
#include "scene/schema.hpp"
#include "solve/external/curve_fit.hpp"
#include "solve/external/method.hpp"
#include "solve/solve.hpp"
#include "study/continued.hpp"
#include "system/formula_names.hpp"

/// problems/README.md names what scenes and results hold, and nothing else.

using namespace house;
using Json = nlohmann::json;

namespace {

const fs::path page = root() / "problems/README.md";

struct TableOfKeys {
  std::string_view table;
  std::string heading;
};
const std::vector<TableOfKeys> tables = {{"", "### Top of a scene"},
                                         {"system", "### system"},
                                         {"boundary", "### boundary"},
                                         {"waypoints", "### waypoints"},
                                         {"path", "### path"},
                                         {"guess", "### guess"},
                                         {"solve", "### solve"},
                                         {"search", "### search"},
                                         {"spectrum", "### spectrum"},
                                         {"units", "### units"},
                                         {"fit", "### fit"},
                                         {"continuation", "### continuation"},
                                         {"system file", "### System files"}};

bool is_value(std::string_view fallback) {
  return fallback == "true" || fallback == "false" || fallback.find_first_of("\"0123456789") == 0;
}

std::string row(const extremal::KeyRecord& record) {
  const std::string key = record.key == "*" ? "a coordinate" : fmt::format("`{}`", record.key);
  const std::string type = record.by_name ? fmt::format("a table, each entry {}", description(record.kind))
                                          : description(record.kind);
  const std::string fallback =
      is_value(record.fallback) ? fmt::format("`{}`", record.fallback) : std::string(record.fallback);
  return fmt::format("| {} | {} | {} | {} | `{}` |", key, type, fallback, record.meaning, record.example);
}

/// The table of a scene's table, as the page shall have it.
std::vector<std::string> rows(std::string_view table) {
  std::vector<std::string> result = {"| key | type | default | meaning | example |",
                                     "| --- | --- | --- | --- | --- |"};
  for (const extremal::KeyRecord& record : extremal::key_records())
    if (record.table == table) result.push_back(row(record));
  return result;
}

bool is_row(const std::string& line) { return line.starts_with("|"); }

/// The table below each heading of keys becomes that of the schema.
void rewrite_page() {
  std::string text;
  bool replacing = false;
  for (const std::string& line : lines(page)) {
    if (replacing && (is_row(line) || line.empty())) continue;
    replacing = false;
    text += line + "\n";
    for (const TableOfKeys& keys : tables) {
      if (line != keys.heading) continue;
      text += "\n";
      for (const std::string& each : rows(keys.table)) text += each + "\n";
      text += "\n";
      replacing = true;
    }
  }
  std::ofstream(page, std::ios::binary) << text;
}

TEST(Reference, KeysAreThoseOfTheSchema) {
  if (std::getenv("EXTREMAL_WRITE_REFERENCE")) rewrite_page();
  for (const TableOfKeys& keys : tables) {
    std::vector<std::string> found;
    for (const std::string& line : section(page, keys.heading))
      if (is_row(line)) found.push_back(line);
    EXPECT_EQ(found, rows(keys.table)) << keys.heading << ": make reference writes this table anew";
  }
}

TEST(Reference, SchemaExplainsEveryKeyThatIsRead) {
  for (const extremal::KeyRecord& record : extremal::key_records()) {
    const auto known = [&](const TableOfKeys& keys) { return keys.table == record.table; };
    EXPECT_TRUE(std::any_of(tables.begin(), tables.end(), known)) << record.table;
    EXPECT_FALSE(record.meaning.empty()) << record.table << "." << record.key;
    EXPECT_FALSE(record.fallback.empty()) << record.table << "." << record.key;
  }
}

std::shared_ptr<const extremal::Source> source(const std::string& text) {
  return std::make_shared<extremal::Source>(extremal::Source{"text", text});
}

TEST(Reference, ExamplesAreAccepted) {
  for (const extremal::KeyRecord& record : extremal::key_records()) {
    const bool top = record.table.empty() || record.table == "system file";
    const extremal::KeyRecord* const table = top ? nullptr : extremal::find_key("", record.table);
    const bool list = table && table->kind == extremal::Kind::tables;
    const std::string brackets = list ? "[[" : "[", closing = list ? "]]\n" : "]\n";
    const std::string text =
        (top ? "" : brackets + std::string(record.table) + closing) + std::string(record.example) + "\n";
    const extremal::Document document = extremal::parse_document(source(text));
    EXPECT_NO_THROW(extremal::check_keys(document, document.root, top ? record.table : "")) << text;
    const bool names_it = record.key == "*" || record.example.starts_with(record.key);
    EXPECT_TRUE(names_it) << text;
  }
}

TEST(Reference, DefaultsAreThoseOfTheProgram) {
  const auto fallback = [](std::string_view table, std::string_view key) {
    return std::string(extremal::find_key(table, key)->fallback);
  };
  const extremal::SolveOptions options;
  EXPECT_EQ(std::stod(fallback("solve", "tolerance")), options.tolerance);
  EXPECT_EQ(fallback("solve", "method"), fmt::format("\"{}\"", name(options.method)));
  EXPECT_EQ(fallback("continuation", "points"), fmt::format("{}", extremal::Continued{}.points));
  EXPECT_EQ(fallback("continuation", "switch"), fmt::format("{}", extremal::Continued{}.switching));
  EXPECT_EQ(fallback("boundary", "periodic"), fmt::format("{}", extremal::BoundaryTable{}.periodic));
}

TEST(Reference, FunctionsOfFormulasAreNamed) {
  std::set<std::string> named;
  for (const std::string& names : named_rows(page, "## Formulas")) {
    std::istringstream words(names);
    for (std::string word; words >> word;) named.insert(word);
  }
  for (const auto& function : extremal::formula::functions())
    EXPECT_TRUE(named.contains(std::string(function.name))) << function.name;
}

TEST(Reference, SchemesAreThoseOfTheProgram) {
  const std::vector<std::string> lines = section(root() / "solver/README.md", "## Schemes");
  for (const extremal::Scheme& scheme : extremal::schemes()) {
    const bool family = scheme.name.find('(') != std::string::npos;
    const std::string name = std::regex_replace(scheme.name, std::regex(R"(\(\d+\))"), "(s)");
    const std::string start =
        family ? fmt::format("| `{}` | s, ", name) : fmt::format("| `{}` | {}, ", name, scheme.degree);
    const std::string order = family ? "| 2s |" : fmt::format("| {} ", scheme.order);
    const auto row = std::find_if(lines.begin(), lines.end(),
                                  [&](const std::string& line) { return line.starts_with(start); });
    ASSERT_NE(row, lines.end()) << "no row " << start;
    EXPECT_NE(row->find(order), std::string::npos) << *row;
    EXPECT_TRUE(row->ends_with(fmt::format("| {} |", scheme.source))) << *row;
  }
}

/// One key a line.
const std::string complete =
    "system.coordinates = [\"x\"]\n"
    "system.lagrangian = \"x'^2/2 - x^4/4\"\n"
    "boundary.periodic = true\n"
    "boundary.duration = 5.0\n"
    "guess.x = \"sin(2*pi*t/T)\"\n"
    "search.solutions = 2\n"
    "continuation.parameter = \"duration\"\n"
    "continuation.to = 5.5\n";

/// The scene without a key, or without a table where `table` is "". A table that would lose its last key
/// stays.
std::string without(const std::string& table, const std::string& key) {
  const std::string start = table.empty() ? key + "." : table + "." + key;
  std::istringstream in(complete);
  std::string text;
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with(start)) text += line + "\n";
  const bool empty = !table.empty() && text.find(table + ".") == std::string::npos;
  return text + (empty ? table + " = {}\n" : "");
}

/// Names of the fields, with dots between levels. The solutions of a search have those of a result.
void collect(const Json& json, const std::string& name, std::set<std::string>& fields) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items())
      collect(value, name.empty() ? key : name + "." + key, fields);
  } else if (json.is_array() && !json.empty() && json.front().is_object()) {
    if (name == "solutions") fields.insert(name);
    for (const Json& each : json) collect(each, name == "solutions" ? "" : name, fields);
  } else {
    fields.insert(name);
  }
}

std::set<std::string> names_in(const std::string& heading) {
  const std::vector<std::string> rows = named_rows(page, heading);
  const std::set<std::string> names(rows.begin(), rows.end());
  EXPECT_EQ(names.size(), rows.size()) << heading << " names a field twice";
  return names;
}

class Written : public extremal::test::Command {
 protected:
  /// Adds the fields that a command writes for a scene.
  void add_fields(const std::string& command, const std::string& scene, std::set<std::string>& fields,
                  std::vector<std::string> options = {}) {
    write("scene.toml", scene);
    options.insert(options.begin(), {command, "scene.toml", "--output", "out.json"});
    const auto outcome = extremal(options);
    ASSERT_EQ(outcome.exit, 0) << outcome.error;
    collect(Json::parse(read(folder / "out.json")), "", fields);
  }
};

TEST_F(Written, RequiredKeysAreRequired) {
  write("scene.toml", complete);
  ASSERT_EQ(extremal({"check", "scene.toml"}).exit, 0);
  for (const extremal::KeyRecord& record : extremal::key_records()) {
    if (!record.fallback.starts_with("required") || record.table == "system file") continue;
    if (record.table == "fit") {  // nothing else that this scene asks for goes with it
      write("scene.toml", without("", "search") + "fit.parameters = []\n");
      EXPECT_EQ(extremal({"check", "scene.toml"}).exit, 2) << record.key;
      continue;
    }
    write("scene.toml", without(std::string(record.table), std::string(record.key)));
    EXPECT_EQ(extremal({"check", "scene.toml"}).exit, 2) << record.table << "." << record.key;
  }
}

TEST_F(Written, FieldsOfAResultAreThoseOfThePage) {
  if (!extremal::can_fit()) GTEST_SKIP() << "this build has no Ceres, which fits need";
  std::set<std::string> fields;
  const std::string orbit = without("", "search");
  add_fields("solve", orbit, fields);
  add_fields("solve", complete, fields, {"--samples", "2"});
  add_fields("solve", orbit, fields, {"--set", "solve.scheme=lobatto(4)"});
  const std::string lines = orbit + "[spectrum]\n";
  add_fields("spectrum", lines, fields);
  fs::rename(folder / "out.json", folder / "other.json");
  add_fields("solve", lines + "against = \"other.json\"\n", fields);
  add_fields("solve", "system.use = \"driven-oscillator\"\nboundary = { start = { x = 0 }, duration = 2 }\n",
             fields);
  write("above.toml",
        "about = { summary = \"S\", formula = \"L\", axes = [\"x: m\"], centres = [\"C: 0\"] }\n"
        "system = { coordinates = [\"x\"], lagrangian = \"x'^2/2 - x^2/2\" }\n");
  add_fields("solve",
             "system.use = \"above\"\nboundary = { start = { x = 0 }, end = { x = 1 }, duration = 2 }\n",
             fields, {"--samples", "2"});
  add_fields("solve",
             "system = { coordinates = [\"x\"], lagrangian = \"x'^2/2\", force = { x = \"-x'\" } }\n"
             "boundary = { start = { x = 0 }, end = { x = 1 }, duration = 2 }\n",
             fields);
  std::set<std::string> constrained;
  add_fields("solve",
             "system = { coordinates = [\"x\", \"y\"], lagrangian = \"(x'^2 + y'^2)/2\", "
             "constraints = [\"x^2 + y^2 = 1\"] }\n"
             "boundary = { start = { x = 1, y = 0 }, end = { x = 0, y = 1 }, duration = 2 }\n",
             constrained, {"--samples", "2"});
  if (extremal::available(extremal::Method::ipopt))
    add_fields("solve",
               "system = { coordinates = [\"x\", \"y\"], lagrangian = \"(x'^2 + y'^2)/2\" }\n"
               "boundary = { start = { x = -1, y = 0.1 }, end = { x = 1, y = 0.1 }, duration = 1 }\n"
               "path = { constraints = [\"x^2 + y^2 >= (0.2 + t/9)^2\"] }\n",
               constrained, {"--samples", "2"});
  for (const std::string& field : constrained)  // those of y are those of x
    if (!field.ends_with(".y") && !field.ends_with("_y") && !field.ends_with(".y'")) fields.insert(field);
  add_fields("solve",
             "system = { coordinates = [\"x\"], parameters = { k = 1 }, lagrangian = \"x'^2/2 - k*x^2/2\" }\n"
             "boundary = { start = { x = 0 }, end = { x = 1 }, duration = 2, integrals = [\"x = 0.8\"], "
             "unknowns = { k = 1 }, where = [\"k = 0.5\"] }\n"
             "waypoints = [{ at = 1, x = 0.4 }]\n",
             fields);
  if (extremal::available(extremal::Method::ipopt))
    add_fields("solve",
               "system = { coordinates = [\"x\"], lagrangian = \"x'^2/2 + 8*x\" }\n"
               "boundary = { start = { x = 0 }, end = { x = 0 }, duration = 2 }\n"
               "path = { constraints = [\"x >= -1\"] }\n",
               fields, {"--samples", "2"});
  write("data.csv", "t,x,sigma x\n0,1,0.1\n1,0.5,0.1\n1.5,0.1,0.1\n2,-0.4,0.1\n");
  add_fields(
      "solve",
      "system = { coordinates = [\"x\"], parameters = { k = 1.0 }, lagrangian = \"x'^2/2 - k*x^2/2\" }\n"
      "boundary = { start = { x = 1 }, duration = 2 }\n"
      "fit = { data = \"data.csv\", parameters = [\"k\"] }\n",
      fields);
  // Fields by names of the problem stand for those of others.
  for (const auto& [from, to] :
       {std::pair{"open_ends.x(T)", "open_ends.x(0)"}, {"parameters.k", "parameters.k"}})
    if (fields.erase(from)) fields.insert(to);
  add_fields("solve",
             "system = { coordinates = [\"x\"], lagrangian = \"x'^2/2 + cos(x)\" }\n"
             "boundary = { start = { x = \"-pi\" }, end = { x = \"pi\" }, duration = \"infinite\" }\n",
             fields);
  EXPECT_EQ(fields, names_in("## Fields of a result"));
}

TEST_F(Written, FieldsOfABranchAreThoseOfThePage) {
  std::set<std::string> fields;
  add_fields("continue", complete, fields);
  write("above.toml",
        "about = { summary = \"S\", formula = \"L\", axes = [\"x: m\"], centres = [\"C: 0\"] }\n"
        "system = { coordinates = [\"x\"], lagrangian = \"x'^2/2 - x^2/2\" }\n");
  add_fields("continue",
             "system.use = \"above\"\nboundary = { start = { x = 0 }, end = { x = 1 }, duration = 2 }\n"
             "continuation = { parameter = \"duration\", to = 2.5, points = 3 }\n",
             fields, {"--samples", "2"});
  add_fields("continue",
             "system = { coordinates = [\"x\"], parameters = { a = 1, k = 1 }, "
             "lagrangian = \"x'^2/2 - k^2*x^2/2\" }\n"
             "boundary = { start = { x = \"a\" }, duration = 1, unknowns = { k = 1 }, "
             "where = [\"x(T) = 1.7\"] }\n"
             "continuation = { parameter = \"a\", to = 0.9, points = 2 }\n",
             fields);
  EXPECT_EQ(fields, names_in("## Fields of a branch"));
}

TEST_F(Written, FieldsOfAComparisonAreThoseOfThePage) {
  std::set<std::string> fields;
  add_fields("compare", without("", "search"), fields);
  EXPECT_EQ(fields, names_in("## Fields of a comparison"));
}

TEST_F(Written, ScenesOfThePageAreAccepted) {
  int scenes = 0, systems = 0;
  for (const Block& block : blocks(page)) {
    if (block.language != "toml") continue;
    if (block.text.find("[boundary]") != std::string::npos) {
      ++scenes;
      write("scene.toml", block.text);
      const auto outcome = extremal({"check", "scene.toml"});
      EXPECT_EQ(outcome.exit, 0) << block.text << outcome.error;
    } else {
      ++systems;
      write("shown.toml", block.text);
      write("scene.toml", "system.use = \"shown\"\nboundary.duration = 1\n");
      const auto outcome = extremal({"check", "scene.toml"});
      EXPECT_EQ(outcome.exit, 0) << block.text << outcome.error;
    }
  }
  EXPECT_GT(scenes, 0);
  EXPECT_GT(systems, 0);
}

}  // namespace
