#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "report/branch.hpp"
#include "report/plot.hpp"
#include "study/continued.hpp"
#include "study/quantity.hpp"
#include "study/study.hpp"

namespace extremal::app {
namespace {

/// One line that is written over, on a terminal.
void show_point(const BranchPoint& point) {
  fmt::print(stderr, "\r\x1b[K{:.10g}, duration {:.6g}, action {:.6g}", point.parameter,
             point.solution.duration(), point.solution.action);
  std::fflush(stderr);
}

/// The formula of --quantity, before anything is computed.
void check_shown(const ContinueArguments& a, const Study& study) {
  if (a.plot.empty()) throw OptionError("--quantity says what --plot shows; give a file to --plot");
  try {
    check_quantity(study, a.quantity);
  } catch (const FormulaError& e) {
    throw OptionError(fmt::format("--quantity: '{}': column {}: {}", a.quantity, e.offset + 1, e.what()));
  }
}

}  // namespace

int follow(const ContinueArguments& a) {
  const bool table = !on_standard_output(a.output, a.csv) && !a.quiet;
  const Study study = load(a.scene, a.sets);
  const Annotation annotation = a.plot.empty() ? Annotation{} : extremal::annotation(study);
  if (!a.quantity.empty()) check_shown(a, study);
  const bool terminal = !a.quiet && ::isatty(STDERR_FILENO);
  std::function<void(const BranchPoint&)> progress;
  if (terminal) progress = show_point;
  const FollowedBranch branch = extremal::follow(study, progress);
  if (terminal) fmt::print(stderr, "\r\x1b[K");
  if (!a.output.empty()) write_output(a.output, [&](std::ostream& out) { write_json(out, branch); });
  if (branch.points.empty()) {
    fmt::print(stderr, "error: {}: {}\n", a.scene, branch.branches.front().message);
    return Exit::not_converged;
  }
  if (!a.csv.empty()) write_output(a.csv, [&](std::ostream& out) { write_csv(out, branch); });
  if (!a.plot.empty())
    write_plot(a.plot, BranchPicture{branch, quantity(study, branch, a.quantity), annotation});
  if (table) fmt::print("{}", summary(branch));
  return Exit::done;
}

}  // namespace extremal::app
