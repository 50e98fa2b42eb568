#include "peers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace bench {
namespace {

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \r") - begin + 1);
}

/// What stands between separators, trimmed.
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

/// "0.026 / 0.044 / 0.055" in milliseconds; "-" or "fails" is no time at all.
PeerTimes read_times(const std::string& cell, const std::string& where) {
  PeerTimes times;
  const std::vector<std::string> parts = split(cell, '/');
  if (parts.size() == 1 && (cell == "-" || cell == "fails")) return times;
  if (parts.size() != times.size())
    throw std::runtime_error(
        fmt::format("{}: '{}' has {} times; need {}", where, cell, parts.size(), times.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    char* end = nullptr;
    const double milliseconds = std::strtod(parts[i].c_str(), &end);
    if (*end != 0 || !(milliseconds > 0))
      throw std::runtime_error(fmt::format("{}: '{}' is not a time", where, parts[i]));
    times[i] = 1e-3 * milliseconds;
  }
  return times;
}

}  // namespace

Peers read_peers(const std::string& path) {
  std::ifstream file(path);
  Peers peers;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (!peers.times.empty() && line.empty()) break;  // the end of the first table
    if (!line.starts_with("| ") || line.starts_with("| ---")) continue;
    std::vector<std::string> cells = split(line, '|');  // with an empty one before and after
    const std::vector<std::string> inner(cells.begin() + 2, cells.end() - 1);
    if (peers.names.empty()) {
      for (const std::string& name : inner) peers.names.push_back(split(name, ',').front());
      continue;
    }
    const std::string where = fmt::format("{}:{}", path, number);
    if (inner.size() != peers.names.size())
      throw std::runtime_error(
          fmt::format("{}: {} columns; need {}", where, inner.size(), peers.names.size()));
    for (const std::string& cell : inner) peers.times[cells[1]].push_back(read_times(cell, where));
  }
  if (peers.times.empty()) throw std::runtime_error(fmt::format("{}: there is no table of times", path));
  return peers;
}

std::optional<double> peer_time(const Peers& peers, const std::string& scene, std::size_t column,
                                double error) {
  const auto row = peers.times.find(scene);
  const auto at = std::find(peer_errors.begin(), peer_errors.end(), error);
  if (row == peers.times.end() || at == peer_errors.end()) return {};
  return row->second[column][at - peer_errors.begin()];
}

}  // namespace bench
