#include "scipy.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace bench {
namespace {

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// What a command writes to its standard output; `exit` is its exit status.
std::string output_of(const std::string& command, int& exit) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return text;
  char block[4096];
  for (std::size_t count; (count = std::fread(block, 1, sizeof block, pipe)) > 0;) text.append(block, count);
  exit = pclose(pipe);
  return text;
}

}  // namespace

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
