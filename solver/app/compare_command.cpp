#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "report/comparison.hpp"
#include "report/plot.hpp"
#include "study/compare.hpp"

namespace extremal::app {
namespace {

/// One line that is written over, on a terminal.
void show_row(const ComparisonRow& row) {
  fmt::print(stderr, "\r\x1b[K{} at tolerance {:.0e}", row.method, row.tolerance);
  std::fflush(stderr);
}

}  // namespace

int compare(const CompareArguments& a) {
  const bool table = !on_standard_output(a.output, "") && !a.quiet;
  const Study study = load(a.scene, a.sets, Purpose::solution);
  CompareOptions options;
  const bool terminal = !a.quiet && ::isatty(STDERR_FILENO);
  if (terminal) options.progress = show_row;
  const Comparison found = extremal::compare(study, options);
  if (terminal) fmt::print(stderr, "\r\x1b[K");
  if (!a.output.empty()) write_output(a.output, [&](std::ostream& out) { write_json(out, found); });
  if (!a.plot.empty() && found.any()) write_plot(a.plot, found);
  if (table) fmt::print("{}", summary(found));
  if (found.any()) return Exit::done;
  fmt::print(stderr, "error: {}: {}\n", a.scene, found.message);
  return Exit::not_converged;
}

}  // namespace extremal::app
