#include "report/outline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "report/text.hpp"
#include "scene/schema.hpp"

namespace extremal {
namespace {

constexpr std::size_t comment_width = 100;  ///< characters of a line of comment

/// A text as lines of comment.
std::string comment(const std::string& text) {
  std::istringstream words(text);
  std::string result, line = "#";
  for (std::string word; words >> word;) {
    word = visible(word, false);
    if (line.size() + 1 + word.size() > comment_width && line != "#") {
      result += line + "\n";
      line = "#";
    }
    line += " " + word;
  }
  return result + line + "\n";
}

std::string toml_text(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' || c == '\\' ? fmt::format("\\{}", c) : std::string(1, c);
  return result + "\"";
}

/// "x = 0.0, q = "0"": every coordinate at one value, an array by a formula.
std::string all_at(const SystemTable& system, const char* value) {
  std::vector<std::string> entries;
  for (const Text& coordinate : system.coordinates) {
    const auto bracket = coordinate.value.find('[');
    entries.push_back(bracket == std::string::npos
                          ? fmt::format("{} = {}", coordinate.value, value)
                          : fmt::format("{} = \"{}\"", coordinate.value.substr(0, bracket), value));
  }
  return fmt::format("{}", fmt::join(entries, ", "));
}

/// The scene of the library to begin with: of the system's name, else the shortest; none that needs a file
/// beside it. Empty where there is none.
std::string model(const SystemDescription& system) {
  std::string shortest;
  for (const std::string& path : system.scenes) {
    const std::string text = read_source(path)->text;
    if (text.find("\nfile") != std::string::npos) continue;
    if (std::filesystem::path(path).stem() == system.name) return text;
    if (shortest.empty() || text.size() < shortest.size()) shortest = text;
  }
  return shortest;
}

/// A scene of a system for which the library has none.
std::string plain_scene(const SystemDescription& system) {
  return fmt::format(
      "title = {}\n\n[system]\nuse = {}\n\n[boundary]\nstart = {{ {} }}\nend = {{ {} }}\nduration = 1.0\n",
      toml_text("A motion of " + system.name), toml_text(system.name), all_at(system.system, "0.0"),
      all_at(system.system, "1.0"));
}

std::string written(const Assignment& assignment) {
  std::vector<std::string> values;
  for (const Quantity& q : assignment.values)
    values.push_back(q.formula() ? std::get<std::string>(q.value)
                                 : fmt::format("{}", std::get<double>(q.value)));
  const std::string list = fmt::format("{}", fmt::join(values, ", "));
  return assignment.list ? fmt::format("{} = [{}]", assignment.name, list)
                         : fmt::format("{} = {}", assignment.name, list);
}

/// What the system is, and what a scene may change of it.
std::string about(const SystemDescription& system) {
  std::string text;
  for (const AboutEntry& note : system.about)
    if (note.name != "axes" && note.name != "centres" && !note.texts.empty())
      text += comment(fmt::format("{}: {}", note.name, fmt::join(note.texts, "; ")));
  std::vector<std::string> coordinates, parameters;
  for (const Text& c : system.system.coordinates) coordinates.push_back(c.value);
  for (const Assignment& p : system.system.parameters) parameters.push_back(written(p));
  text += comment(fmt::format("coordinates: {}", fmt::join(coordinates, ", ")));
  if (!parameters.empty()) text += comment(fmt::format("parameters: {}", fmt::join(parameters, ", ")));
  return text;
}

/// The tables and keys that stand at the beginning of lines, each with what it means above it.
class Commented {
 public:
  std::string text(const std::string& scene) {
    std::istringstream in(scene);
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("[")) {
        table_ = line.substr(1, line.find(']') - 1);
        if (table_.find('.') == std::string::npos) explain("", table_);
      } else {
        const std::string key = line.substr(0, line.find_first_of(" =.\t#"));
        if (!key.empty() && line.find('=') != std::string::npos) explain(table_, key);
      }
      result_ += line + "\n";
    }
    return result_;
  }
  /// The tables and keys that the scene does not have, as comments: what they mean, and an example.
  std::string others() const {
    std::string result;
    for (const KeyRecord& table : key_records()) {
      if (table.table != "" || table.kind != Kind::table) continue;
      std::string keys;
      for (const KeyRecord& key : key_records())
        if (key.table == table.key && key.key != "*" && !seen_.count({table.key, key.key}))
          keys += comment(std::string(key.meaning)) + fmt::format("#   {}\n", key.example);
      const bool present = seen_.count({"", table.key});
      if (!keys.empty())
        result +=
            present ? fmt::format("\n# Further keys of [{}]:\n{}", table.key, keys)
                    : "\n" + comment(std::string(table.meaning)) + fmt::format("# [{}]\n{}", table.key, keys);
    }
    return result;
  }

 private:
  void explain(const std::string& table, const std::string& key) {
    const KeyRecord* record = find_key(table, key);
    if (record && seen_.insert({record->table, record->key}).second)
      result_ += comment(std::string(record->meaning));
  }

  std::string table_, result_;
  std::set<std::pair<std::string_view, std::string_view>> seen_;
};

}  // namespace

std::string commented_scene(const SystemDescription& system) {
  const std::string scene = model(system);
  Commented commented;
  const std::string text = commented.text(scene.empty() ? plain_scene(system) : scene);
  return about(system) + "\n" + text + "\n# What else a scene may have:\n" + commented.others();
}

}  // namespace extremal
