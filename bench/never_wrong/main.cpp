#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "study/inspection.hpp"
#include "study/study.hpp"
#include "system/lagrangian.hpp"
#include "tally.hpp"
#include "workers.hpp"

// Random scenes over all systems, solved as the command line would and every result checked.

namespace bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  Campaign campaign;
  std::string save, log;
  std::vector<std::string> tally;
  bool print = false;
};

void tell(const Verdict& v) {
  for (const Fault& fault : v.faults)
    fmt::print("scene {} of seed {} ({}, {}): {}: {}\n", v.index, v.seed, v.scene.system, v.scene.kind,
               fault.kind, fault.detail);
  std::fflush(stdout);
}

/// Each with what is wrong on top, to be solved as it is.
void save(const std::string& folder, const Verdict& v) {
  std::string text;
  for (const Fault& fault : v.faults) text += fmt::format("# {}: {}\n", fault.kind, fault.detail);
  write_text(fs::path(folder) / fmt::format("{}-{}-{}.toml", v.scene.system, v.seed, v.index),
             text + v.scene.text);
}

void add_log(const std::string& path, Tally& tally) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(fmt::format("{} cannot be read", path));
  for (std::string line; std::getline(file, line);) tally.add(from_line(line));
}

/// Random states are off the manifold of constraints.
bool constrained(const fs::path& file) {
  return !extremal::describe(file.stem(), "bench_never_wrong").system.constraints.empty();
}

/// Random states have velocities, which do not determine the momenta where H_pp is singular, nor the motion
/// where the mass of a coordinate vanishes at the start.
bool without_motions(const fs::path& file) {
  const auto scene = fs::path(EXTREMAL_SOURCE_DIR) / "problems/scenes" / (file.stem().string() + ".toml");
  if (!fs::exists(scene)) return false;
  const extremal::Problem problem = extremal::load(scene.string()).problem;
  if (problem.phase) return true;
  const std::vector<double> one(problem.coordinates(), 1);
  extremal::Scratch scratch;
  const auto at = extremal::evaluate_at(*problem.lagrangian, one, one, 0, extremal::Order::hessian, scratch);
  const auto zero = [](double m) { return m == 0; };
  for (auto row = at.vv.begin(); row != at.vv.end(); row += problem.coordinates())
    if (std::all_of(row, row + problem.coordinates(), zero)) return true;
  return false;
}

/// A system of a file without a recipe would never be tried.
void check_catalogue() {
  for (const auto& file : fs::directory_iterator(EXTREMAL_SOURCE_DIR "/problems/systems")) {
    const std::string system = file.path().stem();
    const auto named = [&](const Recipe& recipe) { return recipe.system == system; };
    const bool tried = std::any_of(catalogue().begin(), catalogue().end(), named);
    if (!tried && !constrained(file.path()) && !without_motions(file.path()))
      throw std::runtime_error(fmt::format("the system {} has no recipe in the catalogue", system));
  }
}

int run(const Options& options) {
  check_catalogue();
  if (options.print) {
    const std::string scratch = fs::temp_directory_path() / "never-wrong-print.toml";
    fmt::print(
        "{}",
        random_scene(options.campaign.seed, options.campaign.first, options.campaign.only, scratch).text);
    fs::remove(scratch);
    return 0;
  }
  Tally tally;
  for (const std::string& path : options.tally) add_log(path, tally);
  if (options.tally.empty()) {
    if (!options.save.empty()) fs::create_directories(options.save);
    std::ofstream log;
    if (!options.log.empty()) log.open(options.log, std::ios::app);
    run_campaign(options.campaign, [&](const Verdict& verdict) {
      tally.add(verdict);
      if (log.is_open()) log << to_line(verdict) << std::endl;
      if (verdict.faults.empty()) return;
      tell(verdict);
      if (!options.save.empty()) save(options.save, verdict);
    });
  }
  tally.print();
  return tally.faultless() ? 0 : 1;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  bench::Options options;
  bench::Campaign& campaign = options.campaign;
  CLI::App app("Random scenes over all systems: no crash, no hang, no false convergence");
  app.add_option("--scenes", campaign.scenes, "how many");
  app.add_option("--seed", campaign.seed, "of all that is random");
  app.add_option("--first", campaign.first, "number of the first scene");
  app.add_option("--only", campaign.only, "only this system");
  app.add_option("--jobs", campaign.jobs, "processes")->check(CLI::Range(1, 1024));
  app.add_option("--limit", campaign.limit, "seconds of processor time for one scene")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--again", campaign.kept, "only solve and check these scenes, as they were saved");
  app.add_option("--save", options.save, "folder for the scenes that went wrong");
  app.add_option("--log", options.log, "file that every verdict is added to, a line of JSON each");
  app.add_option("--tally", options.tally, "only count what is in such files")->allow_extra_args(false);
  app.add_flag("--print", options.print, "only write the scene with the number --first");
  CLI11_PARSE(app, argc, argv);
  if (!campaign.kept.empty()) {
    campaign.first = 0;
    campaign.scenes = campaign.kept.size();
  }
  try {
    return bench::run(options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
