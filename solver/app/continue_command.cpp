#include <fmt/format.h>

#include <utility>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/terminal.hpp"
#include "report/branch.hpp"
#include "report/plot.hpp"
#include "study/continued.hpp"
#include "study/quantity.hpp"
#include "study/study.hpp"

namespace extremal::app {
namespace {

std::string progress_text(const BranchPoint& point) {
  return fmt::format("{:.10g}, duration {:.6g}, action {:.6g}", point.parameter, point.solution.duration(),
                     point.solution.action);
}

FollowedBranch followed(const Study& study, bool quiet) {
  const ProgressLine progress(!quiet);
  return extremal::follow(study, progress.callback<BranchPoint>(progress_text));
}

void write_outputs(const ContinueArguments& a, const Study& study, const FollowedBranch& branch,
                   const Annotation& annotation) {
  std::vector<FileContent> files;
  if (!a.output.empty())
    files.push_back({.path = a.output, .write = [&](std::ostream& out) {
                       write_json(out, branch, {a.samples, annotation});
                     }});
  const bool any = !branch.points.empty();
  if (any && !a.csv.empty())
    files.push_back({.path = a.csv, .write = [&](std::ostream& out) { write_csv(out, branch); }});
  if (any && !a.plot.empty())
    files.push_back(
        {a.plot, plot_image(a.plot, BranchPicture{branch, quantity(study, branch, a.quantity), annotation})});
  Outputs::write(std::move(files));
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
  const Outputs outputs({{"--output", a.output}, {"--csv", a.csv}, {"--plot", a.plot}});
  const Study study = load(a.scene, a.sets);
  outputs.keep(study.files);
  if (a.samples > 0 && a.output.empty()) throw OptionError("--samples are those of --output; give it a file");
  const bool annotated = !a.plot.empty() || a.samples > 0;
  const Annotation annotation = annotated ? extremal::annotation(study) : Annotation{};
  if (!a.quantity.empty()) check_shown(a, study);
  const FollowedBranch branch = followed(study, a.quiet);
  write_outputs(a, study, branch, annotation);
  if (branch.points.empty()) {
    print_error(fmt::format("{}: {}", a.scene, branch.branches.front().message));
    return Exit::not_converged;
  }
  if (!outputs.on_standard_output() && !a.quiet) print(summary(branch));
  return Exit::done;
}

}  // namespace extremal::app
