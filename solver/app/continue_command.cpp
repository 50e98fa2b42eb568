#include <fmt/format.h>

#include <utility>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/terminal.hpp"
#include "report/branch.hpp"
#include "report/plot.hpp"
#include "study/continued.hpp"
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

void write_outputs(const ContinueArguments& a, const FollowedBranch& branch) {
  std::vector<FileContent> files;
  if (!a.output.empty())
    files.push_back({a.output, text_of([&](std::ostream& out) { write_json(out, branch); })});
  const bool any = !branch.points.empty();
  if (any && !a.csv.empty())
    files.push_back({a.csv, text_of([&](std::ostream& out) { write_csv(out, branch); })});
  if (any && !a.plot.empty()) files.push_back({a.plot, plot_image(a.plot, branch)});
  Outputs::write(std::move(files));
}

}  // namespace

int follow(const ContinueArguments& a) {
  const Outputs outputs({{"--output", a.output}, {"--csv", a.csv}, {"--plot", a.plot}});
  const Study study = load(a.scene, a.sets);
  outputs.keep(study.files);
  const FollowedBranch branch = followed(study, a.quiet);
  write_outputs(a, branch);
  if (branch.points.empty()) {
    print_error(fmt::format("{}: {}", a.scene, branch.branches.front().message));
    return Exit::not_converged;
  }
  if (!outputs.on_standard_output() && !a.quiet) print(summary(branch));
  return Exit::done;
}

}  // namespace extremal::app
