#include "hard_peer.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "../precision/command.hpp"

namespace bench {
namespace {

const std::string folder = EXTREMAL_SOURCE_DIR "/";

/// "SCENE|KEY=VALUE|…", as the script reads it.
std::string argument(const HardProblem& problem) {
  std::string text = folder + problem.scene;
  for (const std::string& set : problem.sets) text += "|" + set;
  for (const std::string& set : problem.peer) text += "|" + set;
  return text;
}

}  // namespace

std::vector<std::optional<PeerRun>> run_peer(const std::string& python,
                                             const std::vector<HardProblem>& problems, std::string& absence) {
  std::vector<std::optional<PeerRun>> runs(problems.size());
  std::string command = fmt::format("OPENBLAS_NUM_THREADS=1 {} {}", quoted(python),
                                    quoted(folder + "bench/robustness/hard_peer.py"));
  for (const HardProblem& problem : problems)
    if (problem.for_peer) command.append(1, ' ').append(quoted(argument(problem)));
  int exit = -1;
  const std::string text = output_of(command + " 2>&1", exit);
  const nlohmann::json results = nlohmann::json::parse(text, nullptr, false);
  if (exit != 0 || results.is_discarded()) {
    absence = exit == 0 ? "its output is not JSON" : text.substr(0, text.find('\n'));
    return runs;
  }
  auto result = results.begin();
  for (std::size_t k = 0; k < problems.size(); ++k) {
    if (!problems[k].for_peer) continue;
    runs[k] = {
        .failure = (*result)["failure"], .seconds = (*result)["seconds"], .action = (*result)["action"]};
    ++result;
  }
  return runs;
}

}  // namespace bench
