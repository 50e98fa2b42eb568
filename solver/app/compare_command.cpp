#include <fmt/format.h>

#include <utility>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/terminal.hpp"
#include "report/comparison.hpp"
#include "report/plot.hpp"
#include "study/compare.hpp"

namespace extremal::app {
namespace {

std::string progress_text(const ComparisonRow& row) {
  return fmt::format("{} at tolerance {:.0e}", row.method, row.tolerance);
}

Comparison compared(const Study& study, bool quiet) {
  const ProgressLine progress(!quiet);
  CompareOptions options;
  options.progress = progress.callback<ComparisonRow>(progress_text);
  return extremal::compare(study, options);
}

}  // namespace

int compare(const SceneArguments& a) {
  const Outputs outputs({{"--output", a.output}, {"--plot", a.plot}});
  const Study study = load(a.scene, a.sets, Purpose::comparison);
  outputs.keep(study.files);
  const Comparison found = compared(study, a.quiet);
  std::vector<FileContent> files;
  if (!a.output.empty())
    files.push_back({.path = a.output, .write = [&](std::ostream& out) { write_json(out, found); }});
  if (!a.plot.empty() && found.any()) files.push_back({a.plot, plot_image(a.plot, found)});
  Outputs::write(std::move(files));
  if (!outputs.on_standard_output() && !a.quiet) print(summary(found));
  if (found.any()) return Exit::done;
  print_error(fmt::format("{}: {}", a.scene, found.message));
  return Exit::not_converged;
}

}  // namespace extremal::app
