#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "auto_rival.hpp"
#include "distance.hpp"
#include "family.hpp"
#include "study/study.hpp"

// Periodic orbits from guesses that are disturbed: time against the distance of the reference from the orbit.

namespace bench {
namespace {

struct Options {
  std::vector<std::string> scenes{"halo", "lyapunov", "nrho", "figure-eight-near", "figure-eight"};
  std::vector<double> tolerances{1e-4, 1e-8, 1e-11, 1e-12};
  int repeat = 200;
  double family_to = -1.5;
  AutoInstallation installation;
  bool alone = false;
};

void print_heading() {
  fmt::print(
      "{:18} {:>8} {:>8} {:>6} {:>10} {:>11}  {:>8}  {:>8} {:>5} {:>7} {:>12}   {:>9} {:>9} {:>6}  {}\n",
      "orbit", "tolerance", "elements", "degree", "solve µs", "analyse µs", "distance", "estimate", "index",
      "nullity", "multiplier", "AUTO µs", "distance", "ratio", "setting");
}

/// Seconds of the solve; NaN where it fails.
double print_ours(const std::string& name, const extremal::Study& study, const std::string& csv, int repeat) {
  const extremal::Solution s = extremal::run(study, repeat);
  fmt::print("{:18} {:8.0e} ", name, study.options.tolerance);
  if (!s.converged()) {
    fmt::print(" {}", s.message);
    return NAN;
  }
  const double largest = s.floquet ? std::abs(s.floquet->multipliers.front()) : NAN;
  fmt::print("{:8} {:6} {:10.1f} {:11.1f}  {:8.1e}  {:8.1e} {:5} {:7} {:12.6g}", s.trajectory.elements(),
             s.degree, 1e6 * s.seconds_solve, 1e6 * s.seconds_analyse,
             distance_from_orbit(csv, study, orbit_of(s)), s.error_estimate, s.morse_index.value_or(-1),
             s.nullity.value_or(-1), largest);
  return s.seconds_solve;
}

void print_auto(const std::optional<AutoResult>& result, double ours) {
  if (!result) {
    fmt::print("   {:>9}", "fails");
    return;
  }
  const AutoSetting& setting = result->setting;
  fmt::print("   {:9.1f} {:9.1e} {:6.1f}  NTST {}, NCOL {}, EPSL {:.0e}, NWTN {}, {} solve{}",
             1e6 * result->seconds, result->distance, result->seconds / ours, setting.intervals,
             setting.degree, setting.tolerance, setting.factored, result->solves,
             result->solves > 1 ? "s" : "");
}

void report(const std::string& name, const Options& options) {
  const std::string base = std::string(EXTREMAL_SOURCE_DIR) + "/bench/data/" + name, csv = base + ".csv";
  extremal::Study study = extremal::load(base + ".toml");
  AutoRival rival{.absence = "not wanted", .results = {}};
  if (!options.alone) rival = measure_auto(options.installation, name, study, csv, options.tolerances);
  for (std::size_t i = 0; i < options.tolerances.size(); ++i) {
    study.options.tolerance = options.tolerances[i];
    const double ours = print_ours(name, study, csv, options.repeat);
    if (rival.absence.empty())
      print_auto(rival.results[i], ours);
    else if (i == 0 && !options.alone)
      fmt::print("   AUTO left out: {}", rival.absence);
    fmt::print("\n");
  }
}

/// With forces there is no action.
std::string checked(const char* law, const std::optional<double>& worst) {
  return worst ? fmt::format("; {} to {:.0e}", law, *worst) : "";
}

void report_family(const std::string& name, extremal::Study study, const extremal::ProblemFamily& family,
                   const Options& options) {
  for (const double tolerance : options.tolerances) {
    study.options.tolerance = tolerance;
    const FamilyCost cost = measure_family(family, study.options, std::max(options.repeat / 10, 1));
    fmt::print(
        "{:18} {:8.0e} {:8.1f} µs a point with index and multipliers, {} points; {:.0f} µs to locate a "
        "bifurcation, {} of them{}{}; {}\n",
        name, tolerance, 1e6 * cost.seconds, cost.points, 1e6 * cost.locating, cost.met,
        checked("dS = -E dT + dS/dp dp", cost.worst_action_slope), checked("dS/dq = p", cost.worst_momentum),
        cost.end);
  }
}

/// From the halo orbit on, as far as the energy that is asked for; and families in a parameter, of a
/// Lagrangian alone and with forces.
void report_families(const Options& options) {
  const std::string source = EXTREMAL_SOURCE_DIR;
  const extremal::Study halo = extremal::load(source + "/bench/data/halo.toml");
  report_family("halo family", halo, by_energy(halo.problem, options.family_to), options);
  for (const char* name : {"choreography-family", "duffing-response"}) {
    const extremal::Study study = extremal::load(source + "/problems/scenes/" + name + ".toml");
    report_family(name, study, study.continuation->family, options);
  }
}

int run(const Options& options) {
  print_heading();
  for (const std::string& scene : options.scenes) report(scene, options);
  report_families(options);
  fmt::print(
      "\nMedians. distance: of the reference's initial state from the orbit, in phase space, but for "
      "symmetries.\n"
      "AUTO: the setting that is fastest of those whose distance is at most the tolerance; ratio: its time "
      "over ours.\n"
      "What other peers need stands in bench/data/README.md.\n");
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
  app.add_option("--auto", options.installation.folder, "where AUTO-07p is installed");
  app.add_option("--fortran", options.installation.compiler, "compiler that AUTO-07p is linked with");
  app.add_option("--family-to", options.family_to, "energy that the family of halo orbits is followed to");
  app.add_flag("--alone", options.alone, "without AUTO-07p");
  CLI11_PARSE(app, count, arguments);
  return bench::run(options);
}
