#include "scipy.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "command.hpp"

namespace bench {
std::string measure_scipy(const std::string& python, const std::string& script, const std::string& data,
                          std::vector<SceneRecord>& scenes) {
  std::string command =
      fmt::format("OPENBLAS_NUM_THREADS=1 {} {} {}", quoted(python), quoted(script), quoted(data));
  for (const SceneRecord& scene : scenes) command += fmt::format(" {}", quoted(scene.name));
  int exit = -1;
  const std::string text = output_of(command + " 2>&1", exit);
  if (exit != 0) return text.substr(0, text.find('\n'));
  const nlohmann::json results = nlohmann::json::parse(text, nullptr, false);
  if (results.is_discarded()) return "its output is not JSON";
  for (SceneRecord& scene : scenes) {
    const auto runs = results.find(scene.name);
    if (runs == results.end()) {
      scene.scipy.absence = "no equations written for it";
      continue;
    }
    for (const auto& run : *runs)
      scene.scipy.runs.push_back({.tolerance = run["tolerance"],
                                  .failure = run["failure"],
                                  .seconds = run["seconds"],
                                  .error = run["error"]});
  }
  return {};
}

}  // namespace bench
