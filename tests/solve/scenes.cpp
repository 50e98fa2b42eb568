#include "solve/scenes.hpp"

#include <fstream>
#include <sstream>

namespace extremal::laws {

Study study_of(const std::string& scene) { return load(text_source("scene.toml", scene)); }

Table read_table(const std::string& path, int n) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  Table table;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    Values row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    if (static_cast<int>(row.size()) != 2 * n + 1)
      throw std::runtime_error(fmt::format("{}: {} columns; need {}", path, row.size(), 2 * n + 1));
    table.t.push_back(row[0]);
    table.states.push_back(
        {Values(row.begin() + 1, row.begin() + 1 + n), Values(row.begin() + 1 + n, row.end())});
  }
  if (table.t.empty()) throw std::runtime_error(path + ": no rows");
  return table;
}

nlohmann::json published(const std::string& file, const std::string& id) {
  std::ifstream in(std::string(EXTREMAL_SOURCE_DIR) + "/tests/data/reference/" + file);
  const nlohmann::json cases = nlohmann::json::parse(in).at("cases");
  for (const auto& c : cases)
    if (c.at("id") == id) return c;
  throw std::runtime_error(id + " is not in " + file);
}

Values decimals(const nlohmann::json& list) {
  Values result;
  for (const auto& x : list) result.push_back(std::stod(x.get<std::string>()));
  return result;
}
double decimal(const nlohmann::json& text) { return std::stod(text.get<std::string>()); }

}  // namespace extremal::laws
