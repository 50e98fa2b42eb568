#include "hard_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "check.hpp"
#include "hard_peer.hpp"
#include "hard_problems.hpp"
#include "lambert.hpp"
#include "study/study.hpp"

namespace bench {
namespace {

/// Of the exact action, beyond which a result is another extremal.
constexpr double action_error = 1e-8;
constexpr double peer_error = 1e-6;
/// Runs that are shorter are repeated so often.
constexpr double short_run = 0.05;
constexpr int repeats = 5;

struct Measured {
  std::string found, error, wrong;
  double seconds = 0;
  std::optional<double> action;  ///< least of what was found
  bool complete = false;
};

/// Three digits, without an exponent.
std::string milliseconds(double seconds) {
  const double ms = 1e3 * seconds;
  return ms < 9.995   ? fmt::format("{:.2f}", ms)
         : ms < 99.95 ? fmt::format("{:.1f}", ms)
                      : fmt::format("{:.0f}", ms);
}

std::string small(double error) { return error < 1e-16 ? "< 1e-16" : fmt::format("{:.0e}", error); }

double relative(double value, double exact) {
  return std::abs(value - exact) / std::max(std::abs(exact), 1e-300);
}

std::vector<extremal::Solution> solve(const HardProblem& problem, const extremal::Study& study) {
  const auto once = [&](int repeat) {
    if (study.solutions > 0) return extremal::run_all(study, repeat);
    return std::vector<extremal::Solution>{extremal::run(study, repeat)};
  };
  std::vector<extremal::Solution> solutions = once(1);
  double longest = 0;
  for (const extremal::Solution& s : solutions) longest = std::max(longest, s.seconds_solve);
  return problem.wanted == 1 && longest < short_run ? once(repeats) : solutions;
}

/// Against the exact action; else by integration from piece to piece.
void judge(const HardProblem& problem, const extremal::Study& study, const extremal::Solution& solution,
           double& worst, Measured& measured) {
  if (problem.action) {
    const double off = relative(solution.action, *problem.action);
    worst = std::max(worst, off);
    if (off > action_error) measured.wrong = fmt::format("an action of {:.12g}", solution.action);
    return;
  }
  measured.wrong = disproof(study.problem, solution, study.options.tolerance);
  worst = std::max(worst, solution.error_estimate / range_of(solution.trajectory));
}

Measured measure(const HardProblem& problem) {
  const extremal::Study study =
      extremal::load(std::string(EXTREMAL_SOURCE_DIR "/") + problem.scene, problem.sets);
  Measured measured;
  std::vector<double> energies;
  int found = 0;
  double worst = 0;
  for (const extremal::Solution& solution : solve(problem, study)) {
    measured.seconds = std::max(measured.seconds, solution.seconds_solve);
    if (!solution.converged()) {
      measured.found = name(solution.status);
      measured.complete = solution.status == problem.expected;
      continue;
    }
    judge(problem, study, solution, worst, measured);
    if (!measured.wrong.empty()) break;
    ++found;
    if (solution.energy) energies.push_back(*solution.energy);
    measured.action = std::min(measured.action.value_or(solution.action), solution.action);
  }
  if (!problem.energies.empty()) found = arcs_found(problem.energies, energies);
  if (found == 0) return measured;
  measured.found = problem.wanted == 1 ? "yes" : fmt::format("{} of {}", found, problem.wanted);
  measured.complete = found == problem.wanted && problem.expected == extremal::Status::converged;
  measured.error = small(worst) + (problem.action ? "" : " of q");
  return measured;
}

/// What solve_bvp's run was, with its time and error.
std::string peer_cells(const HardProblem& problem, const Measured& measured,
                       const std::optional<PeerRun>& run, const std::string& absence) {
  if (!problem.for_peer) return "– | |";
  if (!run) return fmt::format("{} | |", absence);
  if (!run->failure.empty()) {
    std::string reason = run->failure;
    for (const auto& [part, brief] :
         {std::pair("Jacobian", "singular Jacobian"), std::pair("mesh nodes", "too many nodes")})
      if (reason.find(part) != std::string::npos) reason = brief;
    return fmt::format("{} | {} |", reason, milliseconds(run->seconds));
  }
  const std::optional<double> exact = problem.action ? problem.action : measured.action;
  if (!exact) return fmt::format("converged | {} |", milliseconds(run->seconds));
  const double off = relative(run->action, *exact);
  const std::string found = off > peer_error     ? "another"
                            : problem.wanted > 1 ? fmt::format("1 of {}", problem.wanted)
                                                 : "yes";
  return fmt::format("{} | {} | {}", found, milliseconds(run->seconds), small(off));
}

bool chosen(const std::string& title, const std::vector<std::string>& parts) {
  return parts.empty() || std::any_of(parts.begin(), parts.end(), [&](const std::string& part) {
           return title.find(part) != std::string::npos;
         });
}

/// Whether all of a group was found.
bool run_group(const HardGroup& group, const std::string& python) {
  std::string absence;
  const std::vector<std::optional<PeerRun>> peer = run_peer(python, group.problems, absence);
  bool right = true;
  fmt::print("| **{}** | | | | | | |\n", group.title);
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < group.problems.size(); ++k) {
    const HardProblem& problem = group.problems[k];
    const Measured measured = measure(problem);
    right = right && measured.complete && measured.wrong.empty();
    if (!measured.wrong.empty()) notes.push_back(fmt::format("{}: {}", problem.title, measured.wrong));
    fmt::print("| {} | {} | {} | {} | {} |\n", problem.title,
               measured.wrong.empty() ? measured.found : "WRONG", milliseconds(measured.seconds),
               measured.error, peer_cells(problem, measured, peer[k], absence));
    std::fflush(stdout);
  }
  for (const std::string& note : notes) fmt::print("WRONG: {}\n", note);
  return right;
}

}  // namespace

bool run_hard(const std::string& python, const std::vector<std::string>& parts) {
  fmt::print(
      "| problem | found | ms | error | solve_bvp | ms | error |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
  bool right = true;
  for (HardGroup& group : hard_problems()) {
    std::erase_if(group.problems, [&](const HardProblem& p) { return !chosen(p.title, parts); });
    if (!group.problems.empty()) right = run_group(group, python) && right;
  }
  return right;
}

}  // namespace bench
