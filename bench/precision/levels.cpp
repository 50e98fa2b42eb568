#include "levels.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "command.hpp"
#include "geometric_mean.hpp"
#include "machine/simd.hpp"
#include "record.hpp"
#include "records.hpp"
#include "tables.hpp"

namespace bench {
namespace {

using Json = nlohmann::ordered_json;

/// Of this processor, the lowest first.
std::vector<std::string> levels() {
  const std::string best = extremal::name(extremal::simd_level());
  std::vector<std::string> result;
  for (const auto level : {extremal::SimdLevel::base, extremal::SimdLevel::v3, extremal::SimdLevel::v4}) {
    result.push_back(extremal::name(level));
    if (result.back() == best) return result;
  }
  return {best};
}

Json measure_level(const std::string& command, const std::string& level) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("bench-precision-{}-{}.json", getpid(), level);
  int exit = -1;
  output_of(fmt::format("EXTREMAL_SIMD={} {} --json {}", level, command, quoted(file.string())), exit);
  const Json record = Json::parse(std::ifstream(file), nullptr, false);
  std::filesystem::remove(file);
  if (exit != 0 || record.is_discarded())
    throw std::runtime_error("the measurements at level " + level + " failed");
  return record;
}

std::optional<double> seconds(const Json& scene, const char* of, double error) {
  const auto times = scene.find(of);
  if (times == scene.end() || !times->contains(error_key(error))) return {};
  return times->at(error_key(error)).get<double>();
}

void print_error(const std::vector<Json>& records, double error, std::vector<GeometricMean>& means) {
  fmt::print("\nTime at error {:.0e}, microseconds, and the best rival of the same run\n{:<18}", error, "");
  for (const Json& record : records)
    fmt::print(" |{:>9}{:>9}{:>8}", record["simd"].get<std::string>(), "rival", "ratio");
  fmt::print("\n");
  for (std::size_t s = 0; s < records.front()["scenes"].size(); ++s) {
    fmt::print("{:<18}", records.front()["scenes"][s]["scene"].get<std::string>());
    for (std::size_t k = 0; k < records.size(); ++k) {
      const Json& scene = records[k]["scenes"][s];
      const auto ours = seconds(scene, "seconds_at_error", error);
      const auto rival = seconds(scene, "rival_seconds_at_error", error);
      fmt::print(" |{:>9}{:>9}{:>8}", microseconds(ours), microseconds(rival), ratio(rival, ours));
      if (scene.value("boundary", false)) means[k].add(rival, ours);
    }
    fmt::print("\n");
  }
}

}  // namespace

void compare_levels(const std::string& command, const std::string& json) {
  std::vector<Json> records;
  for (const std::string& level : levels()) records.push_back(measure_level(command, level));
  for (const Json& record : records)
    fmt::print("{}, {} cores, one used; {}; kernels {}; load {:.1f}\n",
               record["processor"].get<std::string>(), record["cores"].get<int>(),
               record["compiler"].get<std::string>(), record["simd"].get<std::string>(),
               record["load"].get<double>());
  std::vector<GeometricMean> means(records.size());
  for (const double error : mean_errors) print_error(records, error, means);
  fmt::print(
      "\nGeometric means of the best rival's time over ours, boundary problems at errors 1e-08 and 1e-11\n");
  for (std::size_t k = 0; k < records.size(); ++k)
    fmt::print("  {:<6}{}\n", records[k]["simd"].get<std::string>(), means[k].text());
  if (!json.empty()) write_text(json, Json{{"levels", records}}.dump(1) + "\n");
}

}  // namespace bench
