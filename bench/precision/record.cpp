#include "record.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace bench {
namespace {

using Json = nlohmann::ordered_json;

Json object(const Run& run) {
  Json result{{"tolerance", run.tolerance}, {"seconds", run.seconds}};
  if (run.segments > 0) result["segments"] = run.segments;
  if (run.loose > 0) result["loose"] = run.loose;
  if (run.converged())
    result["error"] = run.error;
  else
    result["failure"] = run.failure;
  return result;
}

Json object(const Cell& cell) {
  Json result = object(static_cast<const Run&>(cell));
  result["repeats"] = cell.repeats;
  result["iterations"] = cell.iterations;
  if (!cell.converged()) return result;
  result["error_estimate"] = cell.estimate;
  result["velocity_error"] = cell.velocity_error;
  result["allowed"] = cell.allowed;
  result["elements"] = cell.elements;
  result["degree"] = cell.degree;
  result["unknowns"] = cell.unknowns;
  return result;
}

template <class Runs>
Json list(const Runs& runs) {
  Json result = Json::array();
  for (const auto& run : runs) result.push_back(object(run));
  return result;
}

Json object(const Rival& rival) {
  if (!rival.absence.empty()) return {{"absence", rival.absence}};
  return {{"runs", list(rival.runs)}};
}

Json object(const SceneRecord& scene) {
  Json result{{"scene", scene.name}};
  if (!scene.refusal.empty()) {
    result["refusal"] = scene.refusal;
    return result;
  }
  result["runs"] = list(scene.cells);
  result["boundary"] = scene.boundary;
  for (double error : compared_errors) {
    const std::string key = error_key(error);
    if (const auto seconds = time_at_error(scene.cells, error)) result["seconds_at_error"][key] = *seconds;
    if (const auto seconds = best_rival(scene, error)) result["rival_seconds_at_error"][key] = *seconds;
  }
  result["single_shooting_by_hand"] = object(scene.single_by_hand);
  result["multiple_shooting_by_hand"] = object(scene.multiple_by_hand);
  result["single_shooting"] = object(scene.single);
  result["multiple_shooting"] = object(scene.multiple);
  result["scipy"] = object(scene.scipy);
  return result;
}

}  // namespace

std::string error_key(double error) { return fmt::format("{:.0e}", error); }

void write_record(const std::string& path, const Machine& machine, const std::vector<SceneRecord>& scenes) {
  Json root{{"processor", machine.processor},
            {"cores", machine.cores},
            {"load", machine.load},
            {"compiler", machine.compiler},
            {"simd", machine.simd}};
  root["scenes"] = Json::array();
  for (const SceneRecord& scene : scenes) root["scenes"].push_back(object(scene));
  write_text(path, root.dump(1) + "\n");
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", path));
}

}  // namespace bench
