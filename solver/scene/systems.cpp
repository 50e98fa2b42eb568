#include "scene/systems.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>

#include "scene/read.hpp"

namespace extremal {
namespace fs = std::filesystem;
namespace {

/// The folders of EXTREMAL_PROBLEMS, and `inner` in each of them, in the installation and in the source.
std::vector<fs::path> folders(const char* inner) {
  std::vector<fs::path> list;
  if (const char* problems = std::getenv("EXTREMAL_PROBLEMS")) {
    std::string_view rest = problems;
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      if (end > 0) {
        list.emplace_back(rest.substr(0, end));
        list.push_back(list.back() / inner);
      }
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  list.push_back(fs::path(EXTREMAL_INSTALLED_PROBLEMS) / inner);
  list.push_back(fs::path(EXTREMAL_SOURCE_PROBLEMS) / inner);
  return list;
}

/// Where system files are looked up after the folder of the scene.
std::vector<fs::path> system_folders() { return folders("systems"); }

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

struct FoundSystem {
  fs::path path;
  Document document;
};

/// The system file of a name, with or without ".toml", in a folder or else where system files are. A scene of
/// that name is passed over.
std::optional<FoundSystem> find_system(const std::string& name, const fs::path& folder) {
  std::vector<fs::path> places = system_folders();
  places.insert(places.begin(), folder);
  const bool suffixed = fs::path(name).extension() == ".toml";
  for (const fs::path& place : places) {
    const fs::path file = place / (name + (suffixed ? "" : ".toml"));
    std::error_code error;
    if (name.empty() || !fs::exists(file, error)) continue;
    Document document = parse_document(read_source(file.string()));
    if (!is_scene(document)) return FoundSystem{file, std::move(document)};
  }
  return std::nullopt;
}

/// Texts of one entry of [about], each with its place.
std::vector<Text> texts_of(const Document& document, std::string_view key) {
  std::vector<Text> texts;
  const auto add = [&](const toml::node& node) {
    if (const auto text = node.value<std::string>()) texts.push_back({*text, document.at(node)});
  };
  const toml::node* entry = document.root["about"][key].node();
  if (!entry) return texts;
  if (const toml::array* list = entry->as_array())
    for (const toml::node& text : *list) add(text);
  else
    add(*entry);
  return texts;
}

SystemTable table_of(const FoundSystem& system) {
  const Document& document = system.document;
  check_keys(document, document.root, "system file");
  check_relations(document);
  const toml::table* table = document.root["system"].as_table();
  if (!table) throw SceneError(document.at(document.root), "a system file needs the table [system]");
  if (const toml::node* nested = table->get("use"))
    throw SceneError(document.at(*nested), "a system file cannot use another");
  SystemTable read = read_system_table(document, *table);
  read.axes = texts_of(document, "axes");
  read.centres = texts_of(document, "centres");
  return read;
}

std::vector<std::string> system_names() {
  std::vector<std::string> names;
  for (const SystemFile& file : system_files()) names.push_back(file.name);
  return names;
}

/// [about], a string as a list of one.
std::vector<AboutEntry> notes_of(const Document& document) {
  std::vector<AboutEntry> notes;
  const toml::table* about = document.root["about"].as_table();
  if (!about) return notes;
  for (const auto& [key, value] : document.entries(*about)) {
    notes.push_back({std::string(key->str()), {}});
    if (const auto text = value->value<std::string>()) notes.back().texts.push_back(*text);
    if (const toml::array* list = value->as_array())
      for (const toml::node& text : *list) notes.back().texts.push_back(text.value_or(std::string()));
  }
  return notes;
}

/// The scenes in these folders, or those of them that use a system; the first of a name counts.
std::map<std::string, SceneFile> scenes_in(const std::vector<fs::path>& places,
                                           const std::optional<std::string>& system = {}) {
  std::map<std::string, SceneFile> found;
  for (const fs::path& folder : places)
    for (const fs::path& file : toml_files(folder)) {
      const std::string name = file.stem().string();
      if (found.count(name)) continue;
      try {
        const Document document = parse_document(read_source(file.string()));
        const fs::path use = document.root["system"]["use"].value_or(std::string());
        if (is_scene(document) && (!system || use.stem() == *system))
          found[name] = {name, file.lexically_normal().string(), use.stem().string()};
      } catch (const SceneError&) {  // this file is no scene
      }
    }
  return found;
}

/// The scenes that use a system, in the working folder and in those of scenes.
std::vector<std::string> scenes_of(const std::string& system) {
  std::vector<fs::path> places = folders("scenes");
  places.insert(places.begin(), fs::path("."));
  std::vector<std::string> paths;
  for (const auto& [name, scene] : scenes_in(places, system)) paths.push_back(scene.path);
  return paths;
}

}  // namespace

std::vector<SystemFile> system_files() {
  std::map<std::string, SystemFile> found;
  for (const fs::path& folder : system_folders())
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
  const auto found = find_system(use.value, fs::path(scene_path).parent_path());
  if (found) return table_of(*found);
  const std::vector<std::string> known = system_names();
  throw UnknownName(
      position(use, 0),
      fmt::format("no system file '{}' beside the scene or among: {}", use.value, fmt::join(known, ", ")),
      use.value, known);
}

std::vector<SceneFile> scene_files() {
  std::vector<SceneFile> list;
  for (auto& [name, scene] : scenes_in(folders("scenes"))) list.push_back(std::move(scene));
  return list;
}

SystemDescription describe_system(const std::string& name, const std::string& command) {
  const auto found = find_system(name, "");
  if (!found) {
    const auto argument = std::make_shared<Source>(Source{command, "", false});
    throw UnknownName({argument, 0, 0},
                      fmt::format("there is no system '{}' among those that 'extremal list' names", name),
                      name, system_names());
  }
  const std::string stem = found->path.stem().string();
  return {stem, found->path.string(), notes_of(found->document), table_of(*found), scenes_of(stem)};
}

std::string find_scene(const std::string& name) {
  const bool suffixed = fs::path(name).extension() == ".toml";
  for (const fs::path& folder : folders("scenes")) {
    const fs::path file = folder / (name + (suffixed ? "" : ".toml"));
    if (std::error_code error; !name.empty() && fs::is_regular_file(file, error)) return file.string();
  }
  return {};
}

}  // namespace extremal
