#include "scene/systems.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "scene/read.hpp"

namespace extremal {
namespace fs = std::filesystem;
namespace {

/// Where system files are looked up after the folder of the scene.
std::vector<fs::path> folders() {
  std::vector<fs::path> list;
  if (const char* problems = std::getenv("EXTREMAL_PROBLEMS")) {
    std::string_view rest = problems;
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      if (end > 0) {
        list.emplace_back(rest.substr(0, end));
        list.push_back(list.back() / "systems");
      }
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  list.emplace_back(EXTREMAL_INSTALLED_SYSTEMS);
  list.emplace_back(EXTREMAL_SOURCE_SYSTEMS);
  return list;
}

bool is_scene(const Document& document) { return document.root.contains("boundary"); }

std::string first_line(const Document& document) {
  const toml::table* about = document.root["about"].as_table();
  if (!about || about->empty()) return "";
  const toml::node* note = document.entries(*about).front().value;
  if (const toml::array* list = note->as_array()) note = list->get(0);
  const std::string text = note ? note->value_or(std::string()) : "";
  const auto begin = text.find_first_not_of(" \t\r\n");
  return begin == std::string::npos ? "" : text.substr(begin, text.find('\n', begin) - begin);
}

std::vector<fs::path> toml_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".toml") files.push_back(it->path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<SystemFile> system_files() {
  std::map<std::string, SystemFile> found;
  for (const fs::path& folder : folders())
    for (const fs::path& file : toml_files(folder)) {
      const std::string name = file.stem().string();
      if (found.count(name)) continue;
      try {
        const Document document = parse_document(read_source(file.string()));
        if (!is_scene(document)) found[name] = {name, file.string(), first_line(document)};
      } catch (const SceneError&) {  // no system to offer; `use` of it tells why
      }
    }
  std::vector<SystemFile> list;
  for (auto& [name, file] : found) list.push_back(std::move(file));
  return list;
}

SystemTable read_system(const Text& use, const std::string& scene_path) {
  std::vector<fs::path> places = folders();
  places.insert(places.begin(), fs::path(scene_path).parent_path());
  const bool suffixed = fs::path(use.value).extension() == ".toml";
  for (const fs::path& place : places) {
    const fs::path file = place / (use.value + (suffixed ? "" : ".toml"));
    std::error_code error;
    if (use.value.empty() || !fs::exists(file, error)) continue;
    const Document document = parse_document(read_source(file.string()));
    if (is_scene(document)) continue;
    check_keys(document, document.root, "system file");
    const toml::table* table = document.root["system"].as_table();
    if (!table) throw SceneError(document.at(document.root), "a system file needs the table [system]");
    if (const toml::node* nested = table->get("use"))
      throw SceneError(document.at(*nested), "a system file cannot use another");
    return read_system_table(document, *table);
  }
  std::vector<std::string> known;
  for (const SystemFile& file : system_files()) known.push_back(file.name);
  throw UnknownName(
      position(use, 0),
      fmt::format("no system file '{}' beside the scene or among: {}", use.value, fmt::join(known, ", ")),
      use.value, known);
}

}  // namespace extremal
