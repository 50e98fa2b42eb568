#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// \file The source tree as tests of it read it.

namespace house {

namespace fs = std::filesystem;

inline fs::path root() { return EXTREMAL_SOURCE_DIR; }

inline std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::vector<std::string> lines(const fs::path& path) {
  std::istringstream in(read(path));
  std::vector<std::string> result;
  for (std::string line; std::getline(in, line);) result.push_back(line);
  return result;
}

/// C++ files below a folder of the tree, sorted.
inline std::vector<fs::path> sources(const std::string& folder) {
  std::vector<fs::path> result;
  for (const auto& entry : fs::recursive_directory_iterator(root() / folder)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".hpp" || extension == ".cpp") result.push_back(entry.path());
  }
  std::sort(result.begin(), result.end());
  return result;
}

inline bool is_kernel(const fs::path& path) { return path.string().ends_with(".simd.cpp"); }

/// An #include: what stands between its brackets or quotes.
struct Include {
  int line;
  bool quoted;
  std::string file;
};

inline std::vector<Include> includes(const fs::path& path) {
  static const std::regex pattern(R"(^\s*#\s*include\s*(["<])([^">]*)[">])");
  std::vector<Include> result;
  int number = 0;
  for (const std::string& line : lines(path)) {
    ++number;
    std::smatch match;
    if (std::regex_search(line, match, pattern)) result.push_back({number, match[1] == "\"", match[2]});
  }
  return result;
}

/// solver/layers.txt: folders, "solve", and their rooms, "solve/mesh", in their order, and what each may
/// include besides itself.
struct Layers {
  std::vector<std::string> order;
  std::map<std::string, std::set<std::string>> allowed;

  /// Whether a file that stands in `from` may include one that stands in `to`.
  bool allow(const std::string& from, const std::string& to) const {
    if (from == to) return true;
    const std::string folder = folder_of(from), other = folder_of(to);
    if (folder != other) return allowed.at(folder).contains(other);
    return from == folder || allowed.at(from).contains(to);
  }
  static std::string folder_of(const std::string& place) { return place.substr(0, place.find('/')); }
};

inline Layers layers() {
  Layers result;
  std::string folder;
  for (const std::string& line : lines(root() / "solver/layers.txt")) {
    const auto colon = line.find(':');
    if (line.starts_with("#") || colon == std::string::npos) continue;
    const auto start = line.find_first_not_of(' ');
    const std::string name = line.substr(start, colon - start);
    if (start == 0) folder = name;
    const std::string prefix = start == 0 ? "" : folder + "/";
    result.order.push_back(prefix + name);
    std::istringstream rest(line.substr(colon + 1));
    std::set<std::string>& allowed = result.allowed[prefix + name];
    for (std::string other; rest >> other;) allowed.insert(prefix + other);
  }
  return result;
}

}  // namespace house
