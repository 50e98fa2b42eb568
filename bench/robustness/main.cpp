#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "check.hpp"
#include "hard_table.hpp"
#include "lambert.hpp"
#include "rows.hpp"
#include "solve/solve.hpp"

// From poor guesses: how often an extremal is found, by what, and in what time; each verified.

namespace bench {
namespace {

struct Options {
  extremal::Method method = extremal::Method::newton;
  std::vector<std::string> rows;  ///< parts of what they are called; empty: all
  double tolerance = 1e-9;
  int most = 0;
  bool failures = false, hard = false;
  std::string python = "/usr/bin/python3";
};

struct Tally {
  int cases = 0, found = 0;
  std::vector<std::string> wrong;
  std::vector<double> seconds;
  std::map<std::string, int> strategies;
};

std::string describe(const extremal::Problem& problem) {
  std::string text;
  const int n = problem.coordinates();
  for (int e = 0; e < 2 * n; ++e)
    text += fmt::format("{}{:.17g}", e == 0 ? "(" : e == n ? ") to (" : ", ", problem.ends.offset[e]);
  return text + fmt::format(") in {:.17g}", problem.duration.value);
}

void count(const Case& test, const Options& options, extremal::Solver& solver, Tally& tally) {
  extremal::SolveOptions settings;
  settings.tolerance = options.tolerance;
  settings.method = options.method;
  const extremal::Solution solution = solver.solve(test.problem, settings);
  ++tally.cases;
  tally.seconds.push_back(solution.seconds_solve);
  if (!solution.converged()) {
    ++tally.strategies["failed"];
    if (options.failures)
      fmt::print("  {}: {} ({})\n", describe(test.problem), solution.message, solution.iterations);
    return;
  }
  const std::string wrong = disproof(test.problem, solution, options.tolerance);
  if (!wrong.empty()) {
    tally.wrong.push_back(fmt::format("{}: {}", describe(test.problem), wrong));
    return;
  }
  if (test.intended && !test.intended(solution.trajectory)) {
    ++tally.strategies["another extremal"];
    if (options.failures)
      fmt::print("  {}: another by {} ({})\n", describe(test.problem), solution.strategy,
                 solution.iterations);
    return;
  }
  ++tally.found;
  ++tally.strategies[solution.strategy];
}

Tally measure(const Row& row, const Options& options) {
  std::vector<Case> cases = row.cases();
  if (options.most > 0 && options.most < static_cast<int>(cases.size())) cases.resize(options.most);
  extremal::Solver solver;
  Tally tally;
  for (const Case& test : cases) count(test, options, solver, tally);
  std::sort(tally.seconds.begin(), tally.seconds.end());
  return tally;
}

void print(const Row& row, const Tally& tally) {
  const double sum = std::accumulate(tally.seconds.begin(), tally.seconds.end(), 0.0);
  fmt::print("{:<34}{:<20}{:>3} of {:<4}{:>6.1f}{:>9}{:>7.0f}{:>10.3f}{:>9.2f}{:>9.1f}  ", row.title,
             row.from, tally.found, tally.cases, 100.0 * tally.found / tally.cases,
             row.baseline < 0 ? "-" : fmt::format("{:.0f}", row.baseline), row.wanted,
             1e3 * tally.seconds[tally.seconds.size() / 2], 1e3 * sum / tally.cases,
             1e3 * tally.seconds.back());
  for (const auto& [strategy, count] : tally.strategies) fmt::print("{} {}; ", count, strategy);
  fmt::print("\n");
  for (const std::string& wrong : tally.wrong) fmt::print("  WRONG: {}\n", wrong);
  std::fflush(stdout);
}

bool chosen(const std::string& name, const Options& options) {
  return options.rows.empty() ||
         std::any_of(options.rows.begin(), options.rows.end(),
                     [&](const std::string& part) { return name.find(part) != std::string::npos; });
}

/// Several extremals of each problem, of which it is known how many there are.
bool run_several(const Options& options) {
  constexpr int problems = 60, most = 30;
  constexpr const char* title = "Lambert's problem, arcs with up to two revolutions";
  if (!chosen(title, options)) return true;
  extremal::Solver solver;
  extremal::SolveOptions settings;
  settings.tolerance = options.tolerance;
  settings.method = options.method;
  int wanted = 0, found = 0, wrong = 0;
  double seconds = 0;
  for (const LambertProblem& test : lambert_problems(options.most > 0 ? options.most : problems)) {
    std::vector<double> energies;
    double last = 0;
    for (const extremal::Solution& s : solver.solve_all(test.problem, settings, most)) {
      if (!s.converged()) continue;
      wrong += !disproof(test.problem, s, options.tolerance).empty();
      energies.push_back(s.energy.value());
      last = std::max(last, s.seconds_solve);
    }
    const int here = arcs_found(test.energies, energies), all = static_cast<int>(test.energies.size());
    if (options.failures && here < all) fmt::print("  {}: {} of {}\n", describe(test.problem), here, all);
    wanted += all;
    found += here;
    seconds += last;
  }
  fmt::print("{}: {} of {} found, {} WRONG, {:.2f} s until the last of each problem, in all\n", title, found,
             wanted, wrong, seconds);
  return wrong == 0;
}

/// Whether every solution withstood.
bool run(const Options& options) {
  fmt::print("{:<34}{:<20}{:<11}{:>6}{:>9}{:>7}{:>10}{:>9}{:>9}  found by\n", "problem", "from", "found", "%",
             "baseline", "wanted", "median ms", "mean ms", "most ms");
  bool right = true;
  for (const Row& row : all_rows()) {
    if (!chosen(row.title + " " + row.from, options)) continue;
    const Tally tally = measure(row, options);
    print(row, tally);
    right = right && tally.wrong.empty();
  }
  return run_several(options) && right;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  bench::Options options;
  CLI::App app("How often an extremal is found from poor guesses");
  app.add_option("--row", options.rows, "only rows whose name holds this; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--tolerance", options.tolerance, "of each solve")->check(CLI::Range(1e-13, 1e-2));
  app.add_option("--cases", options.most, "at most so many of each row")->check(CLI::Range(1, 1000000));
  const std::map<std::string, extremal::Method> methods{{"newton", extremal::Method::newton},
                                                        {"ceres", extremal::Method::ceres},
                                                        {"ipopt", extremal::Method::ipopt}};
  app.add_option("--method", options.method, "what leads from the guess: newton, ceres, ipopt")
      ->transform(CLI::CheckedTransformer(methods));
  app.add_flag("--failures", options.failures, "list what was not found");
  app.add_flag("--hard", options.hard, "the table of hard problems, beside scipy's solve_bvp, instead");
  app.add_option("--python", options.python, "an interpreter with scipy and sympy");
  CLI11_PARSE(app, argc, argv);
  if (options.hard) return bench::run_hard(options.python, options.rows) ? 0 : 1;
  return bench::run(options) ? 0 : 1;
}
