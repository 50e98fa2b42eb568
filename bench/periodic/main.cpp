#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "distance.hpp"
#include "study/study.hpp"

// Periodic orbits from guesses that are disturbed: time against the distance of the reference from the orbit.

namespace bench {
namespace {

struct Options {
  std::vector<std::string> scenes{"halo", "lyapunov", "nrho", "figure-eight-near", "figure-eight"};
  std::vector<double> tolerances{1e-4, 1e-8, 1e-11, 1e-12};
  int repeat = 200;
};

void report(const std::string& name, double tolerance, int repeat) {
  const std::string base = std::string(EXTREMAL_SOURCE_DIR) + "/bench/data/" + name;
  const extremal::Study study =
      extremal::load(base + ".toml", {fmt::format("solve.tolerance={}", tolerance)});
  const extremal::Solution s = extremal::run(study, repeat);
  if (!s.converged()) {
    fmt::print("{:18} {:8.0e}  {}\n", name, tolerance, s.message);
    return;
  }
  const double largest = s.floquet ? std::abs(s.floquet->multipliers.front()) : NAN;
  fmt::print("{:18} {:8.0e} {:8} {:6} {:10.1f} {:11.1f}  {:8.1e}  {:8.1e} {:5} {:7} {:12.6g}\n", name,
             tolerance, s.trajectory.elements(), s.trajectory.degree, 1e6 * s.seconds_solve,
             1e6 * s.seconds_analyse, distance_from_orbit(base + ".csv", study, s), s.error_estimate,
             s.morse_index.value_or(-1), s.nullity.value_or(-1), largest);
}

int run(const Options& options) {
  fmt::print("{:18} {:>8} {:>8} {:>6} {:>10} {:>11}  {:>8}  {:>8} {:>5} {:>7} {:>12}\n", "orbit", "tolerance",
             "elements", "degree", "solve µs", "analyse µs", "distance", "estimate", "index", "nullity",
             "multiplier");
  for (const std::string& scene : options.scenes)
    for (const double tolerance : options.tolerances) report(scene, tolerance, options.repeat);
  fmt::print(
      "\nMedians. distance: of the reference's initial state from the orbit, in phase space, but for "
      "symmetries.\n"
      "What tuned peers need stands in bench/data/README.md.\n");
  return 0;
}

}  // namespace
}  // namespace bench

int main(int count, char** arguments) {
  bench::Options options;
  CLI::App app("Time against error of periodic orbits of bench/data");
  app.add_option("--scene", options.scenes, "only these scenes");
  app.add_option("--tolerances", options.tolerances, "instead of 1e-4, 1e-8, 1e-11, 1e-12");
  app.add_option("--repeat", options.repeat, "solves for each median")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, count, arguments);
  return bench::run(options);
}
