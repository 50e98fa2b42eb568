#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <string>
#include <vector>

#include "by_hand.hpp"
#include "chart.hpp"
#include "command.hpp"
#include "levels.hpp"
#include "machine.hpp"
#include "measure.hpp"
#include "peers.hpp"
#include "profile.hpp"
#include "record.hpp"
#include "scipy.hpp"
#include "tables.hpp"

// Speed against true error: each scene of bench/data at one tolerance a decade, beside other programs.

namespace bench {
namespace {

const std::string folder = EXTREMAL_SOURCE_DIR "/bench/";

struct BenchmarkScene {
  std::string name;
  bool slow = false;     ///< only every fourth decade
  bool boundary = true;  ///< a boundary problem whose time is compared
};
const std::vector<BenchmarkScene> all_scenes{
    {"pendulum-short"},  {"pendulum-long"},      {"kepler-arc"},        {"kepler-eccentric"},
    {"henon-heiles-10"}, {"henon-heiles-60"},    {"double-pendulum-1"}, {"double-pendulum-3"},
    {"halo-half"},       {"lyapunov-half"},      {"nrho-half"},         {"fpu-32", false, false},
    {"fpu-32-modes"},    {"fpu-256-modes", true}};

struct Options {
  std::vector<std::string> scenes;
  std::vector<double> tolerances;
  std::string json, plot, python = "/usr/bin/python3";
  double budget = 0.1;
  bool profile = false, alone = false, levels = false;
};

std::vector<double> decades(bool slow) {
  if (slow) return {1e-4, 1e-8, 1e-12};
  std::vector<double> tolerances;
  for (int k = 3; k <= 14; ++k) tolerances.push_back(std::pow(10.0, -k));
  return tolerances;
}

SceneRecord measure_scene(const BenchmarkScene& scene, const Options& options) {
  SceneRecord record;
  record.name = scene.name;
  record.boundary = scene.boundary;
  const std::string path = folder + "data/" + scene.name;
  try {
    const extremal::Study study = extremal::load(path + ".toml");
    const Reference reference = read_reference(path + ".csv", study.problem.names);
    for (double tolerance : options.tolerances.empty() ? decades(scene.slow) : options.tolerances)
      record.cells.push_back(measure(study, tolerance, reference, options.budget));
    if (options.alone) return record;
    measure_by_hand(study, reference, options.budget / 16, record);
    measure_shooting(study.problem, reference, options.budget / 4, record);
  } catch (const std::exception& e) {
    record.refusal = e.what();
  }
  return record;
}

std::vector<BenchmarkScene> chosen_scenes(const Options& options) {
  if (options.scenes.empty()) return all_scenes;
  std::vector<BenchmarkScene> chosen;
  for (const std::string& name : options.scenes) {
    const auto known = std::find_if(all_scenes.begin(), all_scenes.end(),
                                    [&](const BenchmarkScene& scene) { return scene.name == name; });
    chosen.push_back(known == all_scenes.end() ? BenchmarkScene{name, false, false} : *known);
  }
  return chosen;
}

void profile_scenes(const Options& options) {
  for (const BenchmarkScene& scene : chosen_scenes(options))
    for (double tolerance : options.tolerances.empty() ? std::vector{1e-8} : options.tolerances)
      print_profile(scene.name, folder + "data/" + scene.name + ".toml", tolerance);
}

void compare_programs(const Options& options) {
  const Machine machine = this_machine();
  fmt::print("{}, {} cores, one used; {}; kernels {}; load {:.1f}\n", machine.processor, machine.cores,
             machine.compiler, machine.simd, machine.load);
  const Peers peers = read_peers(folder + "data/README.md");
  std::vector<SceneRecord> records;
  for (const BenchmarkScene& scene : chosen_scenes(options)) records.push_back(measure_scene(scene, options));
  if (!options.alone) {
    const std::string missing =
        measure_scipy(options.python, folder + "precision/scipy_peer.py", folder + "data", records);
    if (!missing.empty()) fmt::print("scipy skipped: {}\n", missing);
  }
  for (const SceneRecord& record : records) print_scene(record);
  print_summary(records, peers);
  print_means(records, peers);
  print_honesty(records);
  if (!options.json.empty()) write_record(options.json, machine, records);
  if (!options.plot.empty()) draw_chart(options.plot, records, peers);
}

/// This program with the options that concern the measurements.
std::string command_of(const char* program, const Options& options) {
  std::string command =
      fmt::format("{} --budget {} --python {}", quoted(program), options.budget, quoted(options.python));
  for (const std::string& scene : options.scenes) command += " --scene " + quoted(scene);
  for (double tolerance : options.tolerances) command += fmt::format(" --tolerances {}", tolerance);
  if (options.alone) command += " --alone";
  return command;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  bench::Options options;
  CLI::App app("Speed against true error on the scenes of bench/data");
  app.add_option("--scene", options.scenes, "only this scene; may be repeated")->allow_extra_args(false);
  app.add_option("--tolerances", options.tolerances, "instead of 1e-3, 1e-4, … 1e-14")
      ->delimiter(',')
      ->check(CLI::Range(1e-16, 1.0));
  app.add_option("--budget", options.budget, "seconds of repetitions for one run")
      ->check(CLI::Range(1e-6, 60.0));
  app.add_option("--json", options.json, "file for everything measured");
  app.add_option("--plot", options.plot, "SVG file for a chart of time against error; needs gnuplot");
  app.add_option("--python", options.python, "interpreter that has scipy");
  app.add_flag("--alone", options.alone, "without shooting and scipy");
  app.add_flag("--levels", options.levels, "all of it at each SIMD level of this processor, side by side");
  app.add_flag("--profile", options.profile, "only where the time of a solve goes; tolerance 1e-8");
  CLI11_PARSE(app, argc, argv);
  try {
    if (options.profile)
      bench::profile_scenes(options);
    else if (options.levels)
      bench::compare_levels(bench::command_of(argv[0], options), options.json);
    else
      bench::compare_programs(options);
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
